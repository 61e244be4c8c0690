#include "view/routes.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <optional>

#include "core/bytes.hpp"
#include "view/assets.hpp"
#include "view/foxglove_client.hpp"
#include "view/protocol.hpp"

namespace sweepcast::view {
namespace {

constexpr std::string_view kContentPolicy =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; "
    "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "object-src 'none'";

/// What there is to see where the page was not built.
constexpr std::string_view kPlainPage =
    "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>Sweepcast</title>\n"
    "<h1>Sweepcast</h1>\n<p>This server is ready, but the program was built without its page. To "
    "have it, run in Sweepcast's source folder:</p>\n<pre>cd viewer &amp;&amp; npm ci &amp;&amp; "
    "npm run build</pre>\n<p>then build Sweepcast again. Foxglove and Lichtblick can connect to "
    "this address as it is (ws://...).</p>\n</html>\n";

/// Bytes that the answer keeps.
Answer kept_answer(unsigned status, std::string_view type, std::string bytes) {
  Answer made;
  made.status = status;
  made.heads.emplace_back("Content-Type", type);
  const auto kept = std::make_shared<const std::string>(std::move(bytes));
  made.body = *kept;
  made.keeper = kept;
  return made;
}

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

/// A whole number and nothing else.
std::optional<std::uint32_t> number_of(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Answer page_file(std::string_view path) {
  const auto assets = embedded_assets();
  const std::string_view wanted = path == "/" ? "/index.html" : path;
  const auto found = std::find_if(assets.begin(), assets.end(),
                                  [&](const Asset& asset) { return asset.path == wanted; });
  Answer made;
  if (found != assets.end()) {
    made.heads.emplace_back("Content-Type", found->type);
    made.body = found->bytes;
    return made;
  }
  if (path != "/") return plain_answer(404, "there is nothing here");
  made.heads.emplace_back("Content-Type", "text/html; charset=utf-8");
  made.body = kPlainPage;
  return made;
}

/// x, y, z and, where there is one, intensity of each finite point: float32, little-endian.
Answer original_of(std::string_view path, std::string_view stream, Recording* recording) {
  const auto index = number_of(path);
  if (recording == nullptr || !index || *index >= recording->size() ||
      !recording->has_original(*index) ||
      (!stream.empty() && number_of(stream) != recording->stream_of(*index))) {
    return plain_answer(404, "there is no original of this sweep; see --original");
  }
  PointCloud cloud;
  if (Status read = recording->original(*index, cloud); !read) {
    return plain_answer(500, read.error().message);
  }
  Bytes bytes;
  bytes.reserve(cloud.size() * (cloud.has_intensity() ? 4 : 3) * sizeof(float));
  ByteWriter out(bytes);
  const auto put = [&](float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    out.put(bits);
  };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.is_finite(i)) continue;
    put(cloud.x[i]);
    put(cloud.y[i]);
    put(cloud.z[i]);
    if (cloud.has_intensity()) put(cloud.intensity[i]);
  }
  Answer made;
  made.heads.emplace_back("Content-Type", "application/octet-stream");
  made.heads.emplace_back("X-Fields", cloud.has_intensity() ? "x y z intensity" : "x y z");
  const auto kept = std::make_shared<const Bytes>(std::move(bytes));
  made.body = {reinterpret_cast<const char*>(kept->data()), kept->size()};
  made.keeper = kept;
  return made;
}

Answer refusal(Access access) {
  if (access == Access::wrong_host) {
    return plain_answer(403, "this server is for its own machine: open http://127.0.0.1:PORT");
  }
  if (access == Access::foreign_page) {
    return plain_answer(403, "a page of another server may not ask; allow it with --origin");
  }
  Answer made = plain_answer(401, "a token is needed: open the page with ?token=TOKEN");
  made.heads.emplace_back("WWW-Authenticate", "Bearer");
  return made;
}

Answer route(const Request& request, const AccessRules& rules, Recording* recording) {
  constexpr std::string_view kOriginal = "/original/";
  const std::string_view path = path_of(request.from.target);
  if (request.method != "GET" && request.method != "HEAD") {
    Answer made = plain_answer(405, "this server is there to be looked at");
    made.heads.emplace_back("Allow", "GET, HEAD");
    return made;
  }
  if (path == "/healthz") return plain_answer(200, "ok");
  const Access access = check_access(request.from, rules, false);
  if (access != Access::granted) return refusal(access);
  if (path.starts_with(kOriginal)) {
    return original_of(path.substr(kOriginal.size()), query_value(request.from.target, "stream"),
                       recording);
  }
  Answer made = page_file(path);
  if (has_token_in_query(request.from, rules)) {
    made.heads.emplace_back("Set-Cookie", token_cookie(rules));
  }
  return made;
}

/// Whether a list that commas separate has the word.
bool lists(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    std::string_view item = list.substr(0, end);
    while (item.starts_with(' ')) item.remove_prefix(1);
    while (item.ends_with(' ')) item.remove_suffix(1);
    if (item == word) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

void add_safe_heads(Answer& made) {
  made.heads.emplace_back("Content-Security-Policy", kContentPolicy);
  made.heads.emplace_back("X-Content-Type-Options", "nosniff");
  made.heads.emplace_back("Referrer-Policy", "no-referrer");
  made.heads.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
  made.heads.emplace_back("Cache-Control", "no-store");
}

}  // namespace

Answer plain_answer(unsigned status, std::string text) {
  return kept_answer(status, "text/plain; charset=utf-8", std::move(text) + "\n");
}

Answer answer(const Request& request, const AccessRules& rules, Recording* recording) {
  Answer made = route(request, rules, recording);
  add_safe_heads(made);
  return made;
}

tl::expected<Upgrade, Answer> choose_upgrade(const Request& request, const AccessRules& rules) {
  const auto refuse = [](Answer made) {
    add_safe_heads(made);
    return tl::unexpected(std::move(made));
  };
  const std::string_view path = path_of(request.from.target);
  Upgrade upgrade;
  upgrade.is_page = path == "/live";
  if (upgrade.is_page) {
    if (lists(request.subprotocols, kPageProtocol)) upgrade.subprotocol = kPageProtocol;
  } else if (path == "/") {
    const auto known =
        std::find_if(std::begin(kFoxgloveProtocols), std::end(kFoxgloveProtocols),
                     [&](std::string_view name) { return lists(request.subprotocols, name); });
    if (known != std::end(kFoxgloveProtocols)) upgrade.subprotocol = *known;
  } else {
    return refuse(plain_answer(404, "there is no WebSocket here; /live and / have one"));
  }
  const Access access = check_access(request.from, rules, !upgrade.is_page);
  if (access != Access::granted) return refuse(refusal(access));
  if (!upgrade.subprotocol.empty()) return upgrade;
  return refuse(plain_answer(400,
                             "a WebSocket here speaks sweepcast.view.v1 at /live, or "
                             "foxglove.sdk.v1 or foxglove.websocket.v1 at /"));
}

}  // namespace sweepcast::view
