#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "link/listening.hpp"
#include "link/peer.hpp"
#include "link/srt_socket.hpp"
#include "rate/qoe.hpp"
#include "sweepcast/link.hpp"

namespace sweepcast {
namespace {

using namespace link;

constexpr int kBacklog = 16;
constexpr int kTick_ms = 5;
constexpr Microseconds kAuthentication = 2'000'000;  // a peer that takes longer is sent away
constexpr std::size_t kConnectionsPerRobot = 3;      // the old one may not yet have been missed
constexpr std::size_t kPacketsAtATime = 256;         // of one peer, before the next has its turn

/// A connection.
struct Connection {
  SrtSocket socket;
  std::unique_ptr<Peer> peer;
  bool broken = false;
};

/// A robot that has connected.
struct Robot {
  bool connected = false;  ///< and authenticated
  std::optional<SenderReport> report;
  LevelWish wish;
};

}  // namespace

struct Receiver::State {
  explicit State(ReceiverOptions receiver_options) : options(std::move(receiver_options)) {}

  SrtLibrary library;
  ReceiverOptions options;
  SrtSocket listener;
  std::uint16_t port = 0;
  int epoll = -1;
  MemoryBudget memory;
  std::map<SRTSOCKET, Connection> connections;  // the receiving thread's own
  std::atomic<bool> stop = false;
  std::vector<std::byte> buffer = std::vector<std::byte>(kMostPacketBytes + 1);

  mutable std::mutex mutex;                 // guards what follows
  std::map<std::string, std::size_t> open;  ///< connections of each robot
  std::uint64_t let_in = 0;                 ///< by the listen callback
  std::map<std::string, Robot, std::less<>> robots;
  ReceiverStatus status;

  std::thread thread;

  ~State();
  [[nodiscard]] Status listen();
  void run();
  void accept_all();
  void receive_from(Connection& connection);
  void tend(Microseconds now);
  void deliver(Peer& peer);
  [[nodiscard]] LevelWish wish_for(const Peer& peer) const;
  void close_broken();
  [[nodiscard]] const LinkKey* find_key(std::string_view robot) const;
  [[nodiscard]] bool let_in_peer(SRTSOCKET socket, std::string_view robot);

  /// SRT's own thread asks whether a connection may come about.
  static int on_connect(void* self, SRTSOCKET socket, int /*version*/, const sockaddr* /*from*/,
                        const char* stream_id) {
    const std::string_view robot = stream_id == nullptr ? "" : stream_id;
    return static_cast<State*>(self)->let_in_peer(socket, robot) ? 0 : -1;
  }
};

const LinkKey* Receiver::State::find_key(std::string_view robot) const {
  const auto found = std::find_if(options.keys.begin(), options.keys.end(),
                                  [&](const LinkKey& key) { return key.robot == robot; });
  return found == options.keys.end() ? nullptr : &*found;
}

/// Gives the connection its robot's own passphrase, under which the handshake then has to succeed.
bool Receiver::State::let_in_peer(SRTSOCKET socket, std::string_view robot) {
  const LinkKey* key = find_key(robot);
  const std::scoped_lock lock(mutex);
  std::size_t peers = 0;
  for (const auto& [name, count] : open) peers += count > 0 && name != robot ? 1 : 0;
  const auto own = open.find(std::string(robot));
  const bool sound = key != nullptr && peers < options.most_peers &&
                     (own == open.end() || own->second < kConnectionsPerRobot) &&
                     set_option(socket, SRTO_PASSPHRASE, passphrase(*key));
  if (sound) {
    ++let_in;
  } else {
    ++status.connections_refused;
    srt_setrejectreason(socket, SRT_REJX_UNAUTHORIZED);
  }
  return sound;
}

Status Receiver::State::listen() {
  auto socket = make_srt_socket();
  if (!socket) return tl::unexpected(socket.error());
  const auto address = resolve(options.address, options.port);
  if (!address) return tl::unexpected(address.error());
  listener = std::move(*socket);
  const SRTSOCKET s = listener.get();
  if (!set_option(s, SRTO_RCVSYN, false) || srt_listen_callback(s, on_connect, this) < 0 ||
      srt_bind(s, address->get(), address->size) < 0 || srt_listen(s, kBacklog) < 0) {
    int reason = 0;
    srt_getlasterror(&reason);
    return fail(ErrorCode::io, options.address + ":" + std::to_string(options.port) +
                                   ": cannot listen there (" + srt_getlasterror_str() + "); " +
                                   listening_remedy(reason));
  }
  SocketAddress bound;
  bound.size = sizeof(bound.storage);
  srt_getsockname(s, reinterpret_cast<sockaddr*>(&bound.storage), &bound.size);
  // Both families have the port at the same place.
  port = ntohs(reinterpret_cast<const sockaddr_in*>(&bound.storage)->sin_port);
  epoll = srt_epoll_create();
  const int events = int{SRT_EPOLL_IN} | int{SRT_EPOLL_ERR};
  if (epoll < 0 || srt_epoll_add_usock(epoll, s, &events) < 0) {
    return fail(ErrorCode::unsupported, "SRT gives no events; see its version");
  }
  return {};
}

void Receiver::State::run() {
  std::vector<SRT_EPOLL_EVENT> events(64);
  Microseconds tended = now_us();
  while (!stop) {
    const int count =
        srt_epoll_uwait(epoll, events.data(), static_cast<int>(events.size()), kTick_ms);
    for (int i = 0; i < std::min(count, static_cast<int>(events.size())); ++i) {
      const SRTSOCKET socket = events[static_cast<std::size_t>(i)].fd;
      if (socket == listener.get()) {
        accept_all();
      } else if (const auto found = connections.find(socket); found != connections.end()) {
        receive_from(found->second);
      }
    }
    const Microseconds now = now_us();
    if (now - tended >= Microseconds{kTick_ms} * 1000 || count > 0) {
      tend(now);
      tended = now;
    }
  }
}

void Receiver::State::accept_all() {
  for (;;) {
    SrtSocket socket(srt_accept(listener.get(), nullptr, nullptr));
    if (socket.get() == SRT_INVALID_SOCK) return;
    char id[513] = {};
    int size = sizeof(id) - 1;
    const bool named = srt_getsockflag(socket.get(), SRTO_STREAMID, id, &size) == 0;
    const LinkKey* key = named ? find_key(id) : nullptr;
    const int events = int{SRT_EPOLL_IN} | int{SRT_EPOLL_ERR};
    if (key == nullptr || !set_option(socket.get(), SRTO_RCVSYN, false) ||
        srt_epoll_add_usock(epoll, socket.get(), &events) < 0) {
      continue;
    }
    auto peer = std::make_unique<Peer>(*key, options.most_bytes_per_peer, memory, now_us());
    const SRTSOCKET number = socket.get();
    const bool greeted =
        srt_send_packet(number, write_hello(peer->challenge())) == SrtOutcome::done;
    connections[number] = {std::move(socket), std::move(peer), !greeted};
    const std::scoped_lock lock(mutex);
    ++open[key->robot];
    ++status.connections;
  }
}

void Receiver::State::receive_from(Connection& connection) {
  for (std::size_t i = 0; i < kPacketsAtATime; ++i) {
    std::span<const std::byte> packet;
    const SrtOutcome outcome = srt_receive_packet(connection.socket.get(), buffer, packet);
    if (outcome == SrtOutcome::broken) connection.broken = true;
    if (outcome != SrtOutcome::done) return;
    const bool was_authentic = connection.peer->is_authentic();
    connection.peer->take(packet, now_us());
    if (was_authentic || !connection.peer->is_authentic()) continue;
    for (auto& [number, other] : connections) {  // it takes the place of its robot's old ones
      if (&other == &connection || other.peer->robot() != connection.peer->robot()) continue;
      if (other.peer->is_authentic()) other.broken = true;
    }
  }
}

/// All that time brings about.
void Receiver::State::tend(Microseconds now) {
  for (auto& [number, connection] : connections) {
    Peer& peer = *connection.peer;
    receive_from(connection);  // SRT tells of no event where a packet fills a gap
    peer.expire(now);
    deliver(peer);
    if (const auto report = peer.report(now, wish_for(peer)); !report.empty()) {
      if (srt_send_packet(number, report) == SrtOutcome::broken) connection.broken = true;
    }
    if (!peer.is_authentic() && now - peer.began() > kAuthentication) connection.broken = true;
  }
  close_broken();
  const std::scoped_lock lock(mutex);
  status.buffered_bytes = memory.used;
  status.peers = 0;
  for (auto& [name, robot] : robots) robot.connected = false;
  for (auto& [number, connection] : connections) {
    Peer& peer = *connection.peer;
    if (!peer.is_authentic()) continue;
    ++status.peers;
    Robot& robot = robots[peer.robot()];
    robot.connected = true;
    if (auto told = peer.take_sender_report()) robot.report = *told;
  }
}

LevelWish Receiver::State::wish_for(const Peer& peer) const {
  const std::scoped_lock lock(mutex);
  const auto found = robots.find(peer.robot());
  return found == robots.end() ? LevelWish{} : found->second.wish;
}

void Receiver::State::deliver(Peer& peer) {
  const PeerCounts counts = peer.take_counts();
  SRT_TRACEBSTATS stats{};
  std::vector<ArrivedSweep> arrived = peer.take_arrived();
  if (!arrived.empty()) {
    for (const auto& [number, connection] : connections) {
      if (connection.peer.get() == &peer) (void)srt_bistats(number, &stats, 0, 1);
    }
    peer.set_round_trip(stats.msRTT * 1e-3);
  }
  double age = -1;
  for (const ArrivedSweep& sweep : arrived) {
    age = peer.age_of(sweep, now_us());
    if (!options.on_sweep) continue;
    options.on_sweep({peer.robot(), sweep.label.sensor, sweep.label.name, sweep.frame, sweep.layers,
                      sweep.layers_made, age});
  }
  const std::scoped_lock lock(mutex);
  status.sweeps_whole += counts.whole;
  status.sweeps_cut += counts.cut;
  status.sweeps_missed += counts.missed;
  status.packets += counts.packets;
  status.bytes += counts.bytes;
  status.packets_forged += counts.forged;
  status.packets_replayed += counts.replayed;
  status.packets_malformed += counts.malformed;
  status.packets_late += counts.late;
  status.packets_over_limit += counts.over_limit;
  if (age >= 0) status.newest_age_s = age;
}

void Receiver::State::close_broken() {
  for (auto at = connections.begin(); at != connections.end();) {
    if (!at->second.broken) {
      ++at;
      continue;
    }
    {
      const std::scoped_lock lock(mutex);
      const auto count = open.find(std::string(at->second.peer->robot()));
      if (--count->second == 0) open.erase(count);
    }
    at = connections.erase(at);
  }
}

Receiver::State::~State() {
  stop = true;
  if (thread.joinable()) thread.join();
  connections.clear();
  listener = {};
  if (epoll >= 0) srt_epoll_release(epoll);
}

Receiver::Receiver(std::unique_ptr<State> state) : state_(std::move(state)) {}
Receiver::Receiver(Receiver&&) noexcept = default;
Receiver& Receiver::operator=(Receiver&&) noexcept = default;
Receiver::~Receiver() = default;

Result<Receiver> Receiver::start(ReceiverOptions options) {
  if (options.keys.empty()) {
    return fail(ErrorCode::invalid_argument,
                "a receiver without a key accepts nobody; make keys with make_link_key");
  }
  if (Status crypto = prepare_crypto(); !crypto) return tl::unexpected(crypto.error());
  auto state = std::make_unique<State>(std::move(options));
  state->memory.limit = state->options.most_bytes;
  if (Status listening = state->listen(); !listening) return tl::unexpected(listening.error());
  state->thread = std::thread([s = state.get()] { s->run(); });
  return Receiver(std::move(state));
}

std::uint16_t Receiver::port() const noexcept {
  return state_->port;
}

ReceiverStatus Receiver::status() const {
  const std::scoped_lock lock(state_->mutex);
  ReceiverStatus status = state_->status;
  // Whom the callback let in and the handshake did not: the passphrase was wrong.
  status.connections_refused += state_->let_in - std::min(state_->let_in, status.connections);
  return status;
}

std::vector<RobotStatus> Receiver::robots() const {
  const std::scoped_lock lock(state_->mutex);
  std::vector<RobotStatus> all;
  for (const auto& [name, robot] : state_->robots) {
    all.push_back({name, robot.connected, robot.report});
  }
  return all;
}

Status Receiver::ask_level(std::string_view robot, std::optional<std::size_t> level) {
  if (level && *level >= kLevels) {
    return fail(ErrorCode::invalid_argument, "a level lies between 0 and 5");
  }
  const std::scoped_lock lock(state_->mutex);
  const auto found = state_->robots.find(robot);
  const bool obeys = found != state_->robots.end() && found->second.connected &&
                     found->second.report && found->second.report->can_override;
  if (!obeys) {
    return fail(ErrorCode::invalid_argument,
                std::string(robot) +
                    ": takes no level from here; connect it with its sender's override allowed");
  }
  found->second.wish.level = level;
  return {};
}

}  // namespace sweepcast
