#include "sweepcast/live/metrics.hpp"

namespace sweepcast::app {

struct MetricsServer::State {};

MetricsServer::MetricsServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
MetricsServer::MetricsServer(MetricsServer&&) noexcept = default;
MetricsServer& MetricsServer::operator=(MetricsServer&&) noexcept = default;
MetricsServer::~MetricsServer() = default;

Result<MetricsServer> MetricsServer::start(const std::string& /*address*/,
                                           std::function<std::vector<Metric>()> /*read*/) {
  return fail(ErrorCode::unsupported,
              "this build has no metrics; apt-get install prometheus-cpp-dev and build again");
}

}  // namespace sweepcast::app
