// Who may ask the server for anything: tokens, and the names under which it is reached.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/status.hpp"

namespace sweepcast::view {

/// The heads of a request, as far as access depends on them; absent ones are empty.
struct Credentials {
  std::string_view target;         ///< path and query
  std::string_view host;           ///< Host
  std::string_view origin;         ///< Origin: which page asks; browsers alone tell
  std::string_view authorization;  ///< Authorization
  std::string_view cookie;         ///< Cookie
};

/// What the server asks of a request.
struct AccessRules {
  std::string token;                 ///< empty: none is needed
  bool is_loopback = true;           ///< the server can be reached from this machine alone
  std::uint16_t port = 0;            ///< names the cookie: cookies are shared by all ports
  std::vector<std::string> origins;  ///< further pages that may connect
};

enum class Access : std::uint8_t {
  granted,
  no_token,      ///< none, or a wrong one
  wrong_host,    ///< another name than this machine's: a page that had its name point here
  foreign_page,  ///< a page of another server asks
};

/// Whether two texts are the same, in a time that does not tell where they differ.
[[nodiscard]] bool equal_in_constant_time(std::string_view given, std::string_view right);

/// The value of `?key=value` in a target; empty where there is none. Nothing is unescaped.
[[nodiscard]] std::string_view query_value(std::string_view target, std::string_view key);

/// Whether the target itself carries the token: a page that is opened so gets the cookie.
[[nodiscard]] bool has_token_in_query(const Credentials& request, const AccessRules& rules);

/// The head that makes a browser keep the token, out of reach of scripts and of other sites.
[[nodiscard]] std::string token_cookie(const AccessRules& rules);

/// `for_viewers`: the request is one that Foxglove and Lichtblick make, whose pages come from
/// elsewhere: this machine, a file, or Foxglove's own server.
[[nodiscard]] Access check_access(const Credentials& request, const AccessRules& rules,
                                  bool for_viewers);

/// Refuses a token that could not stand in an address: letters, digits, "-", "_", "." and "~" may.
[[nodiscard]] Status check_token(std::string_view token);

}  // namespace sweepcast::view
