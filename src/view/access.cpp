#include "view/access.hpp"

#include <algorithm>
#include <cctype>

namespace sweepcast::view {
namespace {

constexpr std::string_view kBearer = "Bearer ";

std::string cookie_name(const AccessRules& rules) {
  return "sweepcast_" + std::to_string(rules.port);
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// The value of a cookie; empty where there is none.
std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    const std::string_view cookie = trim(cookies.substr(0, end));
    if (cookie.size() > name.size() && cookie.starts_with(name) && cookie[name.size()] == '=') {
      return cookie.substr(name.size() + 1);
    }
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
  }
  return {};
}

bool has_token_in_head(const Credentials& request, const AccessRules& rules) {
  return request.authorization.starts_with(kBearer) &&
         equal_in_constant_time(request.authorization.substr(kBearer.size()), rules.token);
}

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Whether "name:port" is a name of this machine that no DNS server decides.
bool is_loopback_host(std::string_view host) {
  const std::size_t bracket = host.rfind(']');
  const std::size_t colon = host.rfind(':');
  const bool has_port =
      colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
  const std::string name = in_lower_case(has_port ? host.substr(0, colon) : host);
  if (name == "localhost" || name == "[::1]") return true;
  return name.starts_with("127.") && name.find_first_not_of("0123456789.") == std::string::npos;
}

bool is_own_page(const Credentials& request) {
  const std::string host = in_lower_case(request.host);
  const std::string origin = in_lower_case(request.origin);
  return origin == "http://" + host || origin == "https://" + host;
}

/// Pages of the viewers: run on this machine, in their own window, or from Foxglove's server.
bool is_viewer_page(std::string_view origin) {
  constexpr std::string_view kHttp = "http://";
  if (origin == "file://" || origin == "https://app.foxglove.dev") return true;
  return origin.starts_with(kHttp) && is_loopback_host(origin.substr(kHttp.size()));
}

}  // namespace

bool equal_in_constant_time(std::string_view given, std::string_view right) {
  if (right.empty()) return false;
  unsigned difference = given.size() == right.size() ? 0U : 1U;
  for (std::size_t i = 0; i < given.size(); ++i) {
    difference |=
        static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(right[i % right.size()]);
  }
  return difference == 0;
}

std::string_view query_value(std::string_view target, std::string_view key) {
  const std::size_t mark = target.find('?');
  if (mark == std::string_view::npos) return {};
  std::string_view query = target.substr(mark + 1);
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view item = query.substr(0, end);
    if (item.size() > key.size() && item.starts_with(key) && item[key.size()] == '=') {
      return item.substr(key.size() + 1);
    }
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return {};
}

bool has_token_in_query(const Credentials& request, const AccessRules& rules) {
  return equal_in_constant_time(query_value(request.target, "token"), rules.token);
}

std::string token_cookie(const AccessRules& rules) {
  return cookie_name(rules) + "=" + rules.token + "; Path=/; HttpOnly; SameSite=Strict";
}

Access check_access(const Credentials& request, const AccessRules& rules, bool for_viewers) {
  if (rules.is_loopback && !is_loopback_host(request.host)) return Access::wrong_host;
  const bool shows_token = has_token_in_head(request, rules) || has_token_in_query(request, rules);
  if (!rules.token.empty() && !shows_token) {
    const std::string_view kept = cookie_value(request.cookie, cookie_name(rules));
    if (!equal_in_constant_time(kept, rules.token)) return Access::no_token;
  }
  if (request.origin.empty() || shows_token || is_own_page(request)) return Access::granted;
  if (for_viewers && is_viewer_page(request.origin)) return Access::granted;
  const auto& further = rules.origins;
  const bool is_allowed =
      std::find(further.begin(), further.end(), request.origin) != further.end();
  return is_allowed ? Access::granted : Access::foreign_page;
}

Status check_token(std::string_view token) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("-_.~").find(c) != std::string_view::npos;
  };
  constexpr std::size_t kMostToken = 256;
  if (token.size() <= kMostToken && std::all_of(token.begin(), token.end(), is_plain)) return {};
  return fail(ErrorCode::invalid_argument,
              "a token has at most 256 letters, digits, \"-\", \"_\", \".\" and \"~\"; choose one "
              "of those");
}

}  // namespace sweepcast::view
