#include "view/server.hpp"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "view/hub.hpp"
#include "view/sessions.hpp"

namespace sweepcast::view {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using tcp = asio::ip::tcp;

constexpr std::chrono::seconds kTick{1};
/// Bytes that may wait in the system to be sent: what waits there is old when it arrives.
constexpr int kMostUnsent = 1 << 17;
constexpr double kMostAge_s = 1e6;

}  // namespace

struct Server::State {
  explicit State(Hub all) : hub(std::move(all)) {}

  // The server's thread's own. The connections that wait in `context` refer to `hub`, so that one
  // goes last.
  Hub hub;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer timer{context};
  tcp::endpoint endpoint;

  std::mutex mutex;  // guards what follows
  Figures figures;
  std::map<std::pair<std::string, std::string>, Arrival> arrivals;  ///< by robot and sensor
  std::map<std::string, std::optional<std::size_t>> wishes;         ///< levels, by robot
  bool is_told = false;  ///< the thread knows that there are some

  std::thread thread;

  ~State();
  [[nodiscard]] Status listen(const asio::ip::address& address, std::uint16_t port);
  void run();
  void accept();
  void tick();
  void take_arrivals();
  [[nodiscard]] bool ask_level(const std::string& robot, std::optional<std::size_t> level);
};

Status Server::State::listen(const asio::ip::address& address, std::uint16_t port) {
  const tcp::endpoint wanted(address, port);
  error_code error;
  acceptor.open(wanted.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(wanted, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (!error) endpoint = acceptor.local_endpoint(error);
  if (!error) return {};
  return fail(ErrorCode::io, address.to_string() + ":" + std::to_string(port) +
                                 ": cannot listen there (" + error.message() +
                                 "); choose another port, or end the program that has it");
}

/// What a connection's handler throws, as where memory runs out, ends that connection alone.
void Server::State::run() {
  for (;;) {
    try {
      context.run();
      return;
    } catch (const std::exception&) {
      continue;
    }
  }
}

void Server::State::accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    accept();
    if (error) return;
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kMostUnsent,
                 sizeof(kMostUnsent));
    if (auto place = hub.take_place()) serve_http(std::move(socket), hub, std::move(place));
  });
}

void Server::State::tick() {
  timer.expires_after(kTick);
  timer.async_wait([this](error_code error) {
    if (error) return;
    tick();
    const auto now = Clock::now();
    if (hub.show().is_live) {
      std::unique_lock lock(mutex);
      auto robots = figures.robots(now);
      lock.unlock();
      hub.tell_status(std::move(robots), now);
    }
    hub.tick(now);
  });
}

void Server::State::take_arrivals() {
  std::unique_lock lock(mutex);
  is_told = false;
  auto newest = std::exchange(arrivals, {});
  lock.unlock();
  for (auto& [key, arrival] : newest) hub.take(std::move(arrival), Clock::now());
}

bool Server::State::ask_level(const std::string& robot, std::optional<std::size_t> level) {
  const std::scoped_lock lock(mutex);
  if (!figures.obeys(robot)) return false;
  wishes[robot] = level;
  return true;
}

Server::State::~State() {
  context.stop();
  if (thread.joinable()) thread.join();
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

Result<Server> Server::start(ServerOptions options, std::unique_ptr<Recording> recording) {
  error_code error;
  const std::string numeric = options.address == "localhost" ? "127.0.0.1" : options.address;
  const auto address = asio::ip::make_address(numeric, error);
  if (error) {
    return fail(ErrorCode::invalid_argument,
                options.address +
                    ": is no address of this machine; give a numeric one, as "
                    "127.0.0.1, or 0.0.0.0 for every interface");
  }
  if (!address.is_loopback() && options.token.empty()) {
    return fail(ErrorCode::invalid_argument,
                options.address +
                    ": others can reach this address, so a token has to keep them "
                    "out; give one, as long as a password");
  }
  if (Status sound = check_token(options.token); !sound) return tl::unexpected(sound.error());
  Show show;
  show.title = options.title;
  show.rate_hz = options.rate_hz;
  show.is_live = recording == nullptr;
  if (recording) {
    show.frames = recording->size();
    show.streams = recording->streams();
    for (std::uint32_t i = 0; i < recording->size() && !show.has_original; ++i) {
      show.has_original = recording->has_original(i);
    }
  }
  AccessRules rules{options.token, address.is_loopback(), 0, std::move(options.origins)};
  auto state =
      std::make_unique<State>(Hub(std::move(show), std::move(recording), std::move(rules)));
  if (Status listening = state->listen(address, options.port); !listening) {
    return tl::unexpected(listening.error());
  }
  state->hub.rules().port = state->endpoint.port();
  state->hub.set_ask_level([s = state.get()](const std::string& robot, auto level) {
    return s->ask_level(robot, level);
  });
  state->accept();
  state->tick();
  state->thread = std::thread([s = state.get()] { s->run(); });
  return Server(std::move(state));
}

std::string Server::url() const {
  const auto address = state_->endpoint.address();
  const std::string host = address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
  return "http://" + host + ":" + std::to_string(port());
}

std::uint16_t Server::port() const noexcept {
  return state_->endpoint.port();
}

void Server::publish(const LiveSweep& sweep) {
  const auto now = Clock::now();
  const std::chrono::duration<double> age(std::clamp(sweep.age_s, 0.0, kMostAge_s));
  FrameHeader header;
  if (!parse_frame_header(sweep.frame, header)) return;
  Arrival arrival{std::string(sweep.robot),
                  std::string(sweep.sensor),
                  std::string(sweep.name),
                  {sweep.frame.begin(), sweep.frame.end()},
                  now - std::chrono::duration_cast<Clock::duration>(age)};
  const std::scoped_lock lock(state_->mutex);
  auto& arrivals = state_->arrivals;
  state_->figures.add(sweep.robot, sweep.sensor, header.sequence, sweep.frame.size(), sweep.age_s,
                      now);
  auto key = std::pair(arrival.robot, arrival.sensor);
  if (arrivals.size() == kMostStreams && !arrivals.contains(key)) return;
  arrivals.insert_or_assign(std::move(key), std::move(arrival));
  if (std::exchange(state_->is_told, true)) return;
  asio::post(state_->context, [state = state_.get()] { state->take_arrivals(); });
}

void Server::tell(std::span<const RobotStatus> robots) {
  const std::scoped_lock lock(state_->mutex);
  state_->figures.tell(robots);
}

std::vector<LevelWish> Server::take_wishes() {
  const std::scoped_lock lock(state_->mutex);
  std::vector<LevelWish> wishes;
  for (const auto& [robot, level] : std::exchange(state_->wishes, {})) {
    wishes.push_back({robot, level});
  }
  return wishes;
}

}  // namespace sweepcast::view
