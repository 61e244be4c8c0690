// What the server answers to a request, without a socket.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "view/access.hpp"
#include "view/recording.hpp"

namespace sweepcast::view {

struct Request {
  std::string_view method;
  Credentials from;
  std::string_view subprotocols;  ///< Sec-WebSocket-Protocol
};

struct Answer {
  unsigned status = 200;
  std::vector<std::pair<std::string_view, std::string>> heads;
  std::string_view body;
  std::shared_ptr<const void> keeper;  ///< of what `body` refers to; null where that is for ever
};

/// Answers a request for the page, /healthz or /original/INDEX; `recording` may be null. Every
/// answer has the heads that keep a browser from doing what the page does not need.
[[nodiscard]] Answer answer(const Request& request, const AccessRules& rules, Recording* recording);

/// A connection that is to become a WebSocket.
struct Upgrade {
  bool is_page = true;           ///< else it speaks Foxglove's protocol
  std::string_view subprotocol;  ///< that was chosen
};

/// Which WebSocket the request asks for; otherwise the answer that refuses it.
[[nodiscard]] tl::expected<Upgrade, Answer> choose_upgrade(const Request& request,
                                                           const AccessRules& rules);

/// An answer of one line of text.
[[nodiscard]] Answer plain_answer(unsigned status, std::string text);

}  // namespace sweepcast::view
