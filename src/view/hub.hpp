// What all clients of a server share: what is on, and who watches. Used in the server's thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "view/access.hpp"
#include "view/client.hpp"
#include "view/figures.hpp"
#include "view/foxglove_client.hpp"
#include "view/page_client.hpp"
#include "view/recording.hpp"
#include "view/routes.hpp"

namespace sweepcast::view {

/// A live sweep on its way into the server's thread.
struct Arrival {
  std::string robot, sensor, name;
  Bytes frame;
  Clock::time_point captured;
};

/// A connection that shows sweeps.
class Attendee {
 public:
  virtual ~Attendee() = default;
  [[nodiscard]] virtual Client& client() = 0;
  /// The client may have something to say now.
  virtual void wake() = 0;
  /// Once a second.
  virtual void tick(Clock::time_point now) = 0;
};

class Hub {
 public:
  /// Connections, HTTP's too: further ones are closed as they come.
  static constexpr std::size_t kMostConnections = 64;

  Hub(Show show, std::unique_ptr<Recording> recording, AccessRules rules);

  [[nodiscard]] AccessRules& rules() { return rules_; }
  /// How page clients ask for levels; see `PageClient`.
  void set_ask_level(PageClient::AskLevel ask_level) { ask_level_ = std::move(ask_level); }
  [[nodiscard]] Recording* recording() { return recording_.get(); }
  [[nodiscard]] const Show& show() const { return show_; }

  [[nodiscard]] std::unique_ptr<Client> make_client(const Upgrade& upgrade, Clock::time_point now);
  void attend(Attendee& attendee);
  void leave(Attendee& attendee) { attendees_.erase(&attendee); }

  /// Takes a live sweep to everybody.
  void take(Arrival arrival, Clock::time_point now);
  /// Once a second, where sweeps are live.
  void tell_status(std::vector<RobotFigures> robots, Clock::time_point now);
  void tick(Clock::time_point now);

  /// One connection's place; null where there is none left. It is given back at its end.
  [[nodiscard]] std::shared_ptr<void> take_place();

 private:
  struct LiveStream {
    SharedSweep newest;
    Clock::time_point at;
    std::uint32_t count = 0;
    bool is_silent = false;
  };
  [[nodiscard]] LiveStream* stream_of(const Arrival& arrival, std::uint8_t& id);
  void notify_all(NoticeLevel level, const std::string& text);
  [[nodiscard]] std::string name_of(std::size_t stream) const;

  Show show_;
  std::unique_ptr<Recording> recording_;
  AccessRules rules_;
  PageClient::AskLevel ask_level_;
  FoxgloveClouds clouds_;
  std::vector<LiveStream> live_;  ///< as many as the show's streams, where they are live
  std::set<Attendee*> attendees_;
  Clock::time_point began_;
  std::size_t connections_ = 0;
};

}  // namespace sweepcast::view
