// One client as the server sees it, without its socket: messages in, messages out.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "sweepcast/status.hpp"
#include "view/protocol.hpp"
#include "view/sweep.hpp"

namespace sweepcast::view {

/// A message to a client: text, or bytes of which the latter part is shared.
struct Message {
  bool is_text = true;
  Bytes head;
  SharedBytes body;  ///< may be null
};

[[nodiscard]] Message text_message(std::string_view text);

/// What a client knows and waits for. It holds little, whatever the other side does: a sweep of
/// each stream at most, and the newest of each kind of text.
class Client {
 public:
  virtual ~Client() = default;

  /// Takes a message. Error: the connection is to be closed, with the error's message as reason.
  [[nodiscard]] virtual Status take(std::string_view message, bool is_text,
                                    Clock::time_point now) = 0;
  /// The message to send next; none where there is nothing yet.
  [[nodiscard]] virtual std::optional<Message> next(Clock::time_point now) = 0;
  /// When `next` may have something though nothing happens until then.
  [[nodiscard]] virtual std::optional<Clock::time_point> due(Clock::time_point now) = 0;

  /// A live sweep. It takes the place of one of its stream that still waits.
  virtual void offer(const SharedSweep& sweep) = 0;
  virtual void streams_changed() = 0;
  virtual void tell_status(const std::string& /*status*/) {}
  virtual void notify(NoticeLevel level, const std::string& text) = 0;
};

/// The newest sweep of each stream that waits for a client, in the order in which they came.
class WaitingSweeps {
 public:
  void add(const SharedSweep& sweep);
  [[nodiscard]] bool empty() const { return sweeps_.empty(); }
  /// The one that waits longest.
  [[nodiscard]] SharedSweep take();

 private:
  std::vector<SharedSweep> sweeps_;
};

}  // namespace sweepcast::view
