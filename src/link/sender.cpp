#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "link/feedback.hpp"
#include "link/outbox.hpp"
#include "link/packet.hpp"
#include "link/rate_control.hpp"
#include "link/sender_report.hpp"
#include "link/sensor_streams.hpp"
#include "link/srt_socket.hpp"
#include "sweepcast/link.hpp"

namespace sweepcast {
namespace {

using namespace link;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr Microseconds kReportTimeout = 1'500'000;  // then the receiver counts as gone
constexpr Microseconds kBurst = 12'000;             // what pacing may catch up with
constexpr std::size_t kWireHead = 44;               // SRT, UDP and IPv4 heads of a packet
constexpr double kUnderWay_s = 0.15;  // of packets at the link's rate, and a round trip
constexpr double kLeastUnderWay = 8;  // packets
constexpr int kReceiveTimeout_ms = 50;
constexpr microseconds kShortestSleep{10'000};  // several packets a wake-up: waking costs more
constexpr milliseconds kRetry{100};
constexpr milliseconds kBufferFull{2};
constexpr milliseconds kExpiryCheck{20};

/// A connection whose keys are agreed upon.
struct Session {
  SRTSOCKET socket;
  PacketSealer sealer;
};

}  // namespace

struct Sender::State {
  State(SenderOptions sender_options, std::unique_ptr<Strategy> strategy)
      : options(std::move(sender_options)),
        control(std::move(strategy), options.codec, 1.0 / options.rate_hz),
        outbox(control.order()) {}

  SrtLibrary library;
  SenderOptions options;
  SocketAddress address;

  mutable std::mutex mutex;  // guards all that follows
  std::condition_variable wake;
  bool stop = false;
  RateControl control;
  Outbox outbox;
  SensorStreams streams;
  std::optional<Session> session;
  LinkObserver observer;
  SenderStatus status;
  std::optional<std::size_t> level;           ///< of the newest sweep
  std::optional<std::size_t> override_level;  ///< that the receiver asks for, where it may
  std::uint32_t reports_sent = 0;             ///< of this session
  Microseconds report_due = 0;
  std::uint64_t retransmitted_before = 0;  ///< by connections that have ended
  std::vector<std::byte> plain;

  std::thread pacer, connector;

  void run_connector();
  void run_pacer();
  [[nodiscard]] std::string converse(const SrtSocket& socket);
  [[nodiscard]] bool begin_session(SRTSOCKET socket, const Challenge& ours,
                                   std::span<const std::byte> packet,
                                   std::optional<PacketOpener>& opener);
  void take_report(PacketOpener& opener, std::span<const std::byte> packet, Microseconds now);
  void obey(const Report& report);
  [[nodiscard]] SenderReport make_report();
  void send_report(Microseconds now);
  [[nodiscard]] LinkBudget choose(Microseconds now);
  [[nodiscard]] Microseconds send_next(Microseconds now, Microseconds due);
};

/// Connects, and connects again, until the end.
void Sender::State::run_connector() {
  for (;;) {
    std::string error;
    auto socket = make_srt_socket();
    if (!socket) {
      error = socket.error().message;
    } else if (!set_option(socket->get(), SRTO_STREAMID, options.key.robot) ||
               !set_option(socket->get(), SRTO_PASSPHRASE, passphrase(options.key)) ||
               srt_connect(socket->get(), address.get(), address.size) < 0) {
      const int reason = srt_getrejectreason(socket->get());
      const bool is_refused = reason == SRT_REJ_BADSECRET || reason == SRT_REJX_UNAUTHORIZED;
      error = is_refused ? "the receiver refuses this robot: give both sides the same key, and the "
                           "receiver room for one more peer"
                         : "no receiver answers there; start one, or check the address";
    } else {
      error = converse(*socket);
    }
    std::unique_lock lock(mutex);
    status.error = error;
    if (wake.wait_for(lock, kRetry, [&] { return stop; })) return;
  }
}

/// One connection's life. Returns why it ended.
std::string Sender::State::converse(const SrtSocket& socket) {
  const SRTSOCKET s = socket.get();
  const Challenge ours = draw_challenge();
  if (!set_option(s, SRTO_RCVTIMEO, kReceiveTimeout_ms) ||
      srt_send_packet(s, write_hello(ours)) != SrtOutcome::done) {
    return "the connection ended as it began";
  }
  std::optional<PacketOpener> opener;
  std::vector<std::byte> buffer(kMostPacketBytes);
  Microseconds heard = now_us();
  std::string error;
  while (error.empty()) {
    std::span<const std::byte> packet;
    const SrtOutcome outcome = srt_receive_packet(s, buffer, packet);
    const Microseconds now = now_us();
    const std::scoped_lock lock(mutex);
    if (stop) break;
    if (outcome == SrtOutcome::broken) error = "the connection was lost";
    if (outcome == SrtOutcome::done) {
      const std::uint64_t reports = status.reports;
      if (!opener && begin_session(s, ours, packet, opener)) {
        heard = now;
      } else if (opener) {
        take_report(*opener, packet, now);
      }
      if (status.reports != reports) heard = now;
    }
    if (now - heard > kReportTimeout) error = "the receiver is silent";
  }
  const std::scoped_lock lock(mutex);
  session.reset();
  override_level.reset();
  outbox.clear();
  status.connected = false;
  retransmitted_before = status.packets_retransmitted;
  return error;
}

bool Sender::State::begin_session(SRTSOCKET socket, const Challenge& ours,
                                  std::span<const std::byte> packet,
                                  std::optional<PacketOpener>& opener) {
  const auto theirs = read_hello(packet);
  if (!theirs) {
    ++status.packets_refused;
    return false;
  }
  const SessionKeys keys = derive_session(options.key, ours, *theirs);
  opener.emplace(keys.to_sender, std::initializer_list<PacketType>{PacketType::feedback});
  session.emplace(Session{socket, PacketSealer(keys.to_receiver)});
  observer = {};
  control.begin(now_us());
  reports_sent = 0;
  report_due = 0;
  streams.begin_connection();
  status.connected = true;
  status.error.clear();
  ++status.connections;
  wake.notify_all();
  return true;
}

void Sender::State::take_report(PacketOpener& opener, std::span<const std::byte> packet,
                                Microseconds now) {
  std::span<const std::byte> content;
  const auto report =
      opener.open(packet, content) == PacketFault::none ? read_report(content) : std::nullopt;
  if (!report) {
    ++status.packets_refused;
    return;
  }
  ++status.reports;
  if (!observer.add(*report, now)) return;
  obey(*report);
  if (now >= report_due) send_report(now);
  control.add(observer.take_sample());
  streams.confirm(report->streams);
  SRT_TRACEBSTATS stats;
  if (srt_bstats(session->socket, &stats, 0) == 0) {
    status.packets_retransmitted =
        retransmitted_before + static_cast<std::uint64_t>(std::max(0, stats.pktRetransTotal));
  }
}

void Sender::State::obey(const Report& report) {
  if (!options.allow_override || !report.wish || report.wish->level == override_level) return;
  override_level = report.wish->level;
  report_due = 0;  // whoever asked is to know soon
}

SenderReport Sender::State::make_report() {
  SenderReport report;
  const SendQueue& queue = outbox.queue();
  report.level = level;
  report.queued_frames = queue.frames();
  report.queued_bytes = queue.bytes();
  report.sweeps = status.sweeps;
  report.sent = queue.counts().sent;
  report.cut = queue.counts().cut;
  report.dropped = queue.counts().dropped;
  report.qoe = outbox.qoe();
  report.can_override = options.allow_override;
  report.override_level = override_level;
  return report;
}

/// One that is lost between connections is no loss: the next one tells all.
void Sender::State::send_report(Microseconds now) {
  write_sender_report(++reports_sent, make_report(), plain);
  (void)srt_send_packet(session->socket, session->sealer.seal(PacketType::report, plain));
  report_due = now + kSenderReportInterval_us;
}

LinkBudget Sender::State::choose(Microseconds now) {
  RateControl::Situation situation;
  situation.queued_frames = outbox.queue().frames();
  situation.queued_bytes = outbox.queue().bytes();
  situation.connected = session.has_value();
  situation.sensors = std::max<std::size_t>(1, streams.size());
  if (session) {
    situation.bytes_under_way = packets_under_way(session->socket) * kMostPacketBytes;
  }
  const Choice choice = control.decide(observer.state(now), situation);
  const auto level_to_send = override_level ? override_level : choice.level;
  status.budget = {level_to_send, level_to_send ? 0 : choice.bytes};
  return status.budget;
}

/// Sends packets one by one, at the budget's pace.
void Sender::State::run_pacer() {
  std::unique_lock lock(mutex);
  Microseconds due = now_us();
  while (!stop) {
    if (outbox.queue().frames() == 0) {
      wake.wait(lock, [&] { return stop || outbox.queue().frames() > 0; });
      continue;
    }
    const Microseconds now = now_us();
    if (now < due) {
      wake.wait_for(lock, std::max(microseconds(due - now), kShortestSleep));
    } else if (!session) {
      (void)outbox.peek(now);  // what waits ends at its deadline all the same
      wake.wait_for(lock, kExpiryCheck);
    } else {
      due = send_next(now, due);
    }
  }
}

/// Sends the next fragment, if there still is one. Returns when another one may follow.
Microseconds Sender::State::send_next(Microseconds now, Microseconds due) {
  const auto fragment = outbox.peek(now);
  if (!fragment) return due;
  // What is under way cannot be taken back: as little as fills the link, so that after an outage
  // fresh sweeps need not wait for stale packets.
  const double trip = std::min(observer.state(now).least_round_trip_s, kUnderWay_s);
  const double fills =
      control.rate() * (kUnderWay_s + trip) / static_cast<double>(kMostPacketBytes);
  const auto under_way = static_cast<double>(packets_under_way(session->socket));
  if (under_way > std::max(kLeastUnderWay, fills)) {
    return now + microseconds(kBufferFull).count();
  }
  write_fragment(*fragment, plain);
  const auto packet = session->sealer.seal(PacketType::fragment, plain);
  const SrtOutcome outcome = srt_send_packet(session->socket, packet);
  if (outcome != SrtOutcome::done) return now + microseconds(kBufferFull).count();
  outbox.pop();
  ++status.packets;
  status.bytes += packet.size();
  const double time = static_cast<double>(packet.size() + kWireHead) * 1e6 / control.pace();
  return std::max(due, now - kBurst) + static_cast<Microseconds>(time);
}

Sender::Sender(std::unique_ptr<State> state) : state_(std::move(state)) {}
Sender::Sender(Sender&&) noexcept = default;
Sender& Sender::operator=(Sender&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

Sender::~Sender() {
  if (!state_) return;
  {
    const std::scoped_lock lock(state_->mutex);
    state_->stop = true;
  }
  state_->wake.notify_all();
  state_->pacer.join();
  state_->connector.join();
}

Result<Sender> Sender::start(SenderOptions options) {
  if (!is_link_name(options.key.robot)) {
    return fail(ErrorCode::invalid_argument, "the key names no robot; make one with make_link_key");
  }
  if (options.deadline < milliseconds(10) || options.deadline > milliseconds(10'000)) {
    return fail(ErrorCode::invalid_argument, "the deadline must lie between 10 ms and 10 s");
  }
  constexpr double kMostRate = 1000.0;
  if (!(options.rate_hz >= 0.1 && options.rate_hz <= kMostRate)) {
    return fail(ErrorCode::invalid_argument,
                "the rate must lie between 0.1 and 1000 sweeps a second");
  }
  auto strategy = make_strategy(options.strategy, options.codec);
  if (!strategy) return tl::unexpected(strategy.error());
  if (Status crypto = prepare_crypto(); !crypto) return tl::unexpected(crypto.error());
  auto address = resolve(options.host, options.port);
  if (!address) return tl::unexpected(address.error());
  auto state = std::make_unique<State>(std::move(options), std::move(*strategy));
  state->address = *address;
  if (auto probe = make_srt_socket(); !probe) return tl::unexpected(probe.error());
  state->pacer = std::thread([s = state.get()] { s->run_pacer(); });
  state->connector = std::thread([s = state.get()] { s->run_connector(); });
  return Sender(std::move(state));
}

Status Sender::send(const OutgoingSweep& sweep) {
  if (!is_link_name(sweep.sensor) || sweep.name.size() > kMostSourceName) {
    return fail(ErrorCode::invalid_argument,
                "the sensor's name is 1 to 64 letters, digits, dots, dashes and underscores, and "
                "the source's at most 64 bytes");
  }
  State& state = *state_;
  const std::scoped_lock lock(state.mutex);
  const auto number = state.streams.number_of(sweep.sensor);
  if (!number) return tl::unexpected(number.error());
  std::span<const std::byte> frame = sweep.frame;
  SweepLabel label;
  label.sensor = sweep.sensor;
  label.name = sweep.name;
  const auto captured =
      std::chrono::duration_cast<microseconds>(sweep.captured.time_since_epoch()).count();
  label.captured_us = static_cast<std::uint32_t>(captured);
  if (Status done = state.streams.prepare_frame(*number, frame, label.model); !done) {
    return done;
  }
  auto layers = cut_layers(frame, label, sweep.most_bytes);
  if (!layers) return tl::unexpected(layers.error());
  ++state.status.sweeps;
  const Microseconds deadline = captured + microseconds(state.options.deadline).count();
  if (sweep.level) state.control.learn(*sweep.level, sweep.frame.size());
  state.level = sweep.level;
  state.outbox.push(*number, std::move(*layers), deadline, now_us(), sweep.level);
  state.wake.notify_all();
  return {};
}

LinkBudget Sender::choose() {
  const std::scoped_lock lock(state_->mutex);
  return state_->choose(now_us());
}

SenderStatus Sender::status() const {
  const std::scoped_lock lock(state_->mutex);
  SenderStatus status = state_->status;
  const SendQueue& queue = state_->outbox.queue();
  const SendCounts& counts = queue.counts();
  status.sweeps_sent = counts.sent;
  status.sweeps_cut = counts.cut;
  status.sweeps_dropped = counts.dropped;
  if (state_->session) status.link = state_->observer.state(now_us());
  status.link.queued_bytes = queue.bytes();
  status.bytes_per_second = state_->control.pace();
  status.report = state_->make_report();
  return status;
}

void Sender::finish() {
  constexpr milliseconds kCheck{5};
  const auto end = steady_clock::now() + state_->options.deadline;
  bool has_reported = false;
  std::unique_lock lock(state_->mutex);
  while (steady_clock::now() < end) {
    const bool is_empty = state_->outbox.queue().frames() == 0;
    if (is_empty && state_->session && !has_reported) {
      state_->send_report(now_us());
      has_reported = true;
    }
    const bool has_arrived = !state_->session || packets_under_way(state_->session->socket) == 0;
    if (is_empty && has_arrived) return;
    state_->wake.wait_for(lock, kCheck);
  }
}

}  // namespace sweepcast
