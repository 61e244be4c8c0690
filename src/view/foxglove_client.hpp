// A client that speaks Foxglove's WebSocket protocol: Foxglove, Lichtblick, and their like.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <utility>

#include "sweepcast/decoder.hpp"
#include "view/client.hpp"
#include "view/player.hpp"
#include "view/recording.hpp"

namespace sweepcast::view {

inline constexpr std::string_view kFoxgloveProtocols[] = {"foxglove.sdk.v1",
                                                          "foxglove.websocket.v1"};

/// Makes foxglove.PointCloud of sweeps, once for all clients that are sent the same.
class FoxgloveClouds {
 public:
  /// Errors: those of `Decoder::decode`.
  [[nodiscard]] Result<SharedBytes> message_of(const SharedSweep& sweep, const Show& show);

 private:
  Decoder decoder_;
  PointCloud cloud_;
  std::deque<std::pair<SharedSweep, SharedBytes>> kept_;  ///< the newest last
};

class FoxgloveClient : public Client {
 public:
  static constexpr std::size_t kMostSubscriptions = 256;

  /// All three outlive it; `recording` is null where sweeps are live. Recordings play over and
  /// over.
  FoxgloveClient(const Show& show, Recording* recording, FoxgloveClouds& clouds,
                 Clock::time_point now);

  [[nodiscard]] Status take(std::string_view message, bool is_text, Clock::time_point now) override;
  [[nodiscard]] std::optional<Message> next(Clock::time_point now) override;
  [[nodiscard]] std::optional<Clock::time_point> due(Clock::time_point now) override;
  void offer(const SharedSweep& sweep) override;
  void streams_changed() override {}  // `next` compares
  void notify(NoticeLevel level, const std::string& text) override;

 private:
  [[nodiscard]] std::optional<Message> next_text();
  [[nodiscard]] std::optional<Message> next_message();
  [[nodiscard]] SharedSweep next_sweep(Clock::time_point now);

  const Show& show_;
  Recording* recording_;
  FoxgloveClouds& clouds_;
  std::optional<Player> player_;
  std::optional<std::uint32_t> shown_;
  bool info_due_ = true;
  std::size_t advertised_ = 0;                            ///< of the show's streams
  std::map<std::uint32_t, std::uint32_t> subscriptions_;  ///< their ids; channels
  WaitingSweeps waiting_;
  SharedBytes cloud_;                      ///< that is being sent
  std::deque<std::uint32_t> subscribers_;  ///< that have not been sent it
  std::deque<std::string> texts_;
};

}  // namespace sweepcast::view
