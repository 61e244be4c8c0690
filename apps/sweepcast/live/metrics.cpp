#include "sweepcast/live/metrics.hpp"

#include <prometheus/collectable.h>
#include <prometheus/exposer.h>
#include <prometheus/metric_family.h>

#include <exception>

namespace sweepcast::app {
namespace {

/// Asks for the figures when somebody asks us.
class Figures : public prometheus::Collectable {
 public:
  explicit Figures(std::function<std::vector<Metric>()> read) : read_(std::move(read)) {}

  [[nodiscard]] std::vector<prometheus::MetricFamily> Collect() const override {
    std::vector<prometheus::MetricFamily> families;
    for (const Metric& metric : read_()) {
      constexpr std::string_view kTotal = "_total";
      const bool is_counter =
          metric.name.size() > kTotal.size() &&
          metric.name.compare(metric.name.size() - kTotal.size(), kTotal.size(), kTotal) == 0;
      prometheus::ClientMetric value;
      value.gauge.value = metric.value;
      value.counter.value = metric.value;
      if (!metric.robot.empty()) value.label.push_back({"robot", metric.robot});
      if (!families.empty() && families.back().name == metric.name) {
        families.back().metric.push_back(std::move(value));
        continue;
      }
      families.push_back(
          {metric.name,
           metric.help,
           is_counter ? prometheus::MetricType::Counter : prometheus::MetricType::Gauge,
           {std::move(value)}});
    }
    return families;
  }

 private:
  std::function<std::vector<Metric>()> read_;
};

}  // namespace

struct MetricsServer::State {
  std::shared_ptr<Figures> figures;
  std::unique_ptr<prometheus::Exposer> exposer;
};

MetricsServer::MetricsServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
MetricsServer::MetricsServer(MetricsServer&&) noexcept = default;
MetricsServer& MetricsServer::operator=(MetricsServer&&) noexcept = default;
MetricsServer::~MetricsServer() = default;

Result<MetricsServer> MetricsServer::start(const std::string& address,
                                           std::function<std::vector<Metric>()> read) {
  constexpr std::size_t kThreads = 1;
  auto state = std::make_unique<State>();
  state->figures = std::make_shared<Figures>(std::move(read));
  try {
    state->exposer = std::make_unique<prometheus::Exposer>(address, kThreads);
    state->exposer->RegisterCollectable(state->figures);
  } catch (const std::exception&) {  // whose text speaks of the library alone
    return fail(ErrorCode::io, "metrics at " + address +
                                   ": cannot be served there; give a free port, with an address "
                                   "of this machine before it where others are to read them");
  }
  return MetricsServer(std::move(state));
}

}  // namespace sweepcast::app
