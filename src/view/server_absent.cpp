// The viewer's server where Boost is absent.
#include "view/server.hpp"

namespace sweepcast::view {

struct Server::State {};

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

Result<Server> Server::start(ServerOptions /*options*/, std::unique_ptr<Recording> /*recording*/) {
  return fail(ErrorCode::unsupported,
              "this build has no viewer; apt-get install libboost-dev and build again");
}

std::string Server::url() const {
  return {};
}

std::uint16_t Server::port() const noexcept {
  return 0;
}

void Server::publish(const LiveSweep& /*sweep*/) {}

void Server::tell(std::span<const RobotStatus> /*robots*/) {}

std::vector<LevelWish> Server::take_wishes() {
  return {};
}

}  // namespace sweepcast::view
