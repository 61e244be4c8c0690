#include "view/hub.hpp"

#include <algorithm>

namespace sweepcast::view {

Hub::Hub(Show show, std::unique_ptr<Recording> recording, AccessRules rules)
    : show_(std::move(show)),
      recording_(std::move(recording)),
      rules_(std::move(rules)),
      began_(Clock::now()) {}

std::unique_ptr<Client> Hub::make_client(const Upgrade& upgrade, Clock::time_point now) {
  if (upgrade.is_page) {
    return std::make_unique<PageClient>(show_, recording_.get(), now, ask_level_);
  }
  return std::make_unique<FoxgloveClient>(show_, recording_.get(), clouds_, now);
}

std::string Hub::name_of(std::size_t stream) const {
  return show_.streams[stream].robot + "/" + show_.streams[stream].sensor;
}

/// Who comes late sees the last sweeps, and hears which streams have stopped.
void Hub::attend(Attendee& attendee) {
  attendees_.insert(&attendee);
  for (std::size_t i = 0; i < live_.size(); ++i) {
    if (live_[i].newest) attendee.client().offer(live_[i].newest);
    if (live_[i].is_silent) {
      attendee.client().notify(NoticeLevel::warning, name_of(i) + ": no sweep arrives");
    }
  }
}

void Hub::notify_all(NoticeLevel level, const std::string& text) {
  for (Attendee* attendee : attendees_) attendee->client().notify(level, text);
}

Hub::LiveStream* Hub::stream_of(const Arrival& arrival, std::uint8_t& id) {
  const auto found =
      std::find_if(show_.streams.begin(), show_.streams.end(), [&](const Stream& stream) {
        return stream.robot == arrival.robot && stream.sensor == arrival.sensor;
      });
  const auto index = static_cast<std::size_t>(found - show_.streams.begin());
  if (index == kMostStreams) return nullptr;
  id = static_cast<std::uint8_t>(index);
  if (found == show_.streams.end()) {
    show_.streams.push_back({id, arrival.robot, arrival.sensor});
    live_.emplace_back();
    for (Attendee* attendee : attendees_) attendee->client().streams_changed();
  }
  return &live_[index];
}

void Hub::take(Arrival arrival, Clock::time_point now) {
  FrameHeader header;
  if (!parse_frame_header(arrival.frame, header)) return;
  auto sweep = std::make_shared<Sweep>();
  LiveStream* stream = stream_of(arrival, sweep->stream);
  if (stream == nullptr) return;
  if (const auto layers = count_layers(arrival.frame, header)) sweep->layers = *layers;
  sweep->index = stream->count++;
  sweep->name = std::move(arrival.name);
  sweep->captured = arrival.captured;
  sweep->frame = std::make_shared<const Bytes>(std::move(arrival.frame));
  if (stream->is_silent) {
    notify_all(NoticeLevel::info, name_of(sweep->stream) + ": sweeps arrive again");
  }
  *stream = {sweep, now, stream->count, false};
  for (Attendee* attendee : attendees_) {
    attendee->client().offer(sweep);
    attendee->wake();
  }
}

void Hub::tell_status(std::vector<RobotFigures> robots, Clock::time_point now) {
  const std::string status =
      write_status(std::chrono::duration<double>(now - began_).count(), robots);
  for (Attendee* attendee : attendees_) attendee->client().tell_status(status);
  for (std::size_t i = 0; i < live_.size(); ++i) {
    if (live_[i].is_silent || now - live_[i].at <= kSilence) continue;
    live_[i].is_silent = true;
    notify_all(NoticeLevel::warning,
               name_of(i) + ": no sweep for 2 s; the robot has stopped, or its link is down");
  }
}

void Hub::tick(Clock::time_point now) {
  for (Attendee* attendee : attendees_) {
    attendee->tick(now);
    attendee->wake();
  }
}

std::shared_ptr<void> Hub::take_place() {
  if (connections_ == kMostConnections) return nullptr;
  ++connections_;
  return {this, [](Hub* hub) { --hub->connections_; }};
}

}  // namespace sweepcast::view
