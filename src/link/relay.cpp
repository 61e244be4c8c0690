#include "link/relay.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <optional>
#include <queue>
#include <thread>
#include <vector>

#include "io/file.hpp"
#include "link/listening.hpp"

namespace sweepcast {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kMostClients = 64;
constexpr std::size_t kLargestPacket = 65'536;
constexpr std::size_t kMostWaiting = 200'000;  // packets, whatever the queue's limit says
constexpr std::int64_t kIpHead = 28;           // IPv4 and UDP: traces count them
constexpr std::int64_t kLongestSleep_us = 20'000;

Result<sockaddr_in> address_of(const std::string& text, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  if (inet_pton(AF_INET, text.c_str(), &address.sin_addr) == 1) return address;
  return fail(ErrorCode::invalid_argument, text + ": is no IPv4 address, as 127.0.0.1 is");
}

bool same(const sockaddr_in& a, const sockaddr_in& b) {
  return a.sin_addr.s_addr == b.sin_addr.s_addr && a.sin_port == b.sin_port;
}

const sockaddr* raw(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

/// As many bytes as one likes: 150 MB a second.
Trace fast_trace() {
  Trace trace;
  trace.name = "fast";
  trace.opportunities_us.assign(100, 1000);
  trace.period_us = 1000;
  return trace;
}

/// Somebody who sends to us, and the socket by which the server knows them.
struct Client {
  sockaddr_in address{};
  FileHandle socket;
  std::int64_t heard_us = 0;
  std::uint64_t number = 0;  ///< told apart from those before in its place
};

/// A packet on its way.
struct Waiting {
  std::int64_t arrives_us = 0;
  std::uint64_t order = 0;
  std::uint64_t client = 0;
  bool is_up = false;
  std::vector<char> bytes;

  bool operator<(const Waiting& other) const {  // the earliest is the queue's top
    return std::pair(arrives_us, order) > std::pair(other.arrives_us, other.order);
  }
};

}  // namespace

struct Relay::State {
  explicit State(RelayOptions relay_options)
      : options(std::move(relay_options)), up(options.trace, options.link), down(fast, back()) {}

  RelayOptions options;
  Trace fast = fast_trace();
  LinkModel up, down;
  sockaddr_in to{};
  FileHandle listener;
  std::uint16_t port = 0;
  std::vector<Client> clients;
  std::priority_queue<Waiting> waiting;
  std::uint64_t order = 0;
  steady_clock::time_point began = steady_clock::now();
  std::vector<char> buffer = std::vector<char>(kLargestPacket);
  std::atomic<bool> stop = false;
  mutable std::mutex mutex;  // guards the counts
  RelayCounts counts;
  std::thread thread;

  [[nodiscard]] LinkOptions back() const {
    LinkOptions link = options.link;
    link.queue_limit = 0;
    ++link.seed;
    return link;
  }
  [[nodiscard]] std::int64_t now_us() const {
    return std::chrono::duration_cast<std::chrono::microseconds>(steady_clock::now() - began)
        .count();
  }
  [[nodiscard]] Status open();
  void run();
  void take_from_clients();
  void take_from_server(Client& client);
  void deliver_due();
  [[nodiscard]] Client* client_of(const sockaddr_in& address);
  void enqueue(Client& client, bool is_up, std::size_t size);
};

Status Relay::State::open() {
  const auto listen_at = address_of(options.listen_address, options.listen_port);
  if (!listen_at) return tl::unexpected(listen_at.error());
  const auto server = address_of(options.to_address, options.to_port);
  if (!server) return tl::unexpected(server.error());
  to = *server;
  listener = FileHandle(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_in bound{};
  socklen_t size = sizeof(bound);
  if (listener.get() < 0 || ::bind(listener.get(), raw(*listen_at), sizeof(*listen_at)) != 0 ||
      ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
    const int reason = errno;
    return fail(ErrorCode::io, options.listen_address + ":" + std::to_string(options.listen_port) +
                                   ": cannot listen there (" + std::strerror(reason) + "); " +
                                   link::listening_remedy(reason));
  }
  port = ntohs(bound.sin_port);
  return {};
}

void Relay::State::run() {
  std::vector<pollfd> sockets;
  while (!stop) {
    std::int64_t sleep_us = kLongestSleep_us;
    if (!waiting.empty()) {
      sleep_us = std::clamp<std::int64_t>(waiting.top().arrives_us - now_us(), 0, sleep_us);
    }
    sockets.assign(1, {listener.get(), POLLIN, 0});
    for (const Client& client : clients) sockets.push_back({client.socket.get(), POLLIN, 0});
    const timespec timeout{0, sleep_us * 1000};
    const int ready = ::ppoll(sockets.data(), sockets.size(), &timeout, nullptr);
    if (ready > 0) {
      for (std::size_t i = 1; i < sockets.size(); ++i) {
        if (sockets[i].revents != 0) take_from_server(clients[i - 1]);
      }
      if (sockets[0].revents != 0) take_from_clients();
    }
    deliver_due();
  }
}

void Relay::State::take_from_clients() {
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    const ssize_t count = ::recvfrom(listener.get(), buffer.data(), buffer.size(), 0,
                                     reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) return;
    if (Client* client = client_of(from); client != nullptr) {
      enqueue(*client, true, static_cast<std::size_t>(count));
    }
  }
}

void Relay::State::take_from_server(Client& client) {
  for (;;) {
    const ssize_t count = ::recv(client.socket.get(), buffer.data(), buffer.size(), 0);
    if (count < 0) return;  // nothing more, or the server's port is closed
    enqueue(client, false, static_cast<std::size_t>(count));
  }
}

/// The client of this address; a new one takes the place of the one that was silent for longest.
Client* Relay::State::client_of(const sockaddr_in& address) {
  for (Client& client : clients) {
    if (same(client.address, address)) return &client;
  }
  FileHandle socket(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (socket.get() < 0 || ::connect(socket.get(), raw(to), sizeof(to)) != 0) return nullptr;
  if (clients.size() < kMostClients) clients.emplace_back();
  const auto oldest =
      std::min_element(clients.begin(), clients.end(),
                       [](const Client& a, const Client& b) { return a.heard_us < b.heard_us; });
  Client& client = clients.back().number == 0 ? clients.back() : *oldest;
  client = {address, std::move(socket), now_us(), ++order};
  return &client;
}

/// Asks the model what becomes of the packet in the buffer.
void Relay::State::enqueue(Client& client, bool is_up, std::size_t size) {
  const std::int64_t now = now_us();
  client.heard_us = now;
  std::optional<PacketFate> fate;
  if (waiting.size() < kMostWaiting) {
    fate = (is_up ? up : down).send(now, static_cast<std::int64_t>(size) + kIpHead);
  }
  if (is_up) {
    const std::scoped_lock lock(mutex);
    ++counts.packets_in;
    counts.bytes_in += size;
    if (!fate) ++counts.queue_lost;
    if (fate && !fate->arrives_us) ++counts.lost;
  }
  if (!fate || !fate->arrives_us) return;
  waiting.push({*fate->arrives_us,
                ++order,
                client.number,
                is_up,
                {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size)}});
}

void Relay::State::deliver_due() {
  const std::int64_t now = now_us();
  for (; !waiting.empty() && waiting.top().arrives_us <= now; waiting.pop()) {
    const Waiting& packet = waiting.top();
    const auto client = std::find_if(clients.begin(), clients.end(),
                                     [&](const Client& c) { return c.number == packet.client; });
    if (client == clients.end()) continue;
    const std::size_t size = packet.bytes.size();
    if (packet.is_up) {
      (void)::send(client->socket.get(), packet.bytes.data(), size, 0);
    } else {
      (void)::sendto(listener.get(), packet.bytes.data(), size, 0, raw(client->address),
                     sizeof(client->address));
    }
    const std::scoped_lock lock(mutex);
    counts.packets_out += packet.is_up ? 1 : 0;
    counts.bytes_out += packet.is_up ? size : 0;
    counts.packets_back += packet.is_up ? 0 : 1;
  }
}

Relay::Relay(std::unique_ptr<State> state) : state_(std::move(state)) {}
Relay::Relay(Relay&&) noexcept = default;
Relay& Relay::operator=(Relay&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

Relay::~Relay() {
  if (!state_) return;
  state_->stop = true;
  state_->thread.join();
}

Result<Relay> Relay::start(RelayOptions options) {
  if (Status sound = check(options.link); !sound) return tl::unexpected(sound.error());
  if (options.trace.opportunities_us.empty() || options.trace.period_us <= 0) {
    return fail(ErrorCode::invalid_argument, "the relay's trace is empty; read or make one");
  }
  auto state = std::make_unique<State>(std::move(options));
  if (Status opened = state->open(); !opened) return tl::unexpected(opened.error());
  state->thread = std::thread([s = state.get()] { s->run(); });
  return Relay(std::move(state));
}

std::uint16_t Relay::port() const noexcept {
  return state_->port;
}

RelayCounts Relay::counts() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->counts;
}

}  // namespace sweepcast
