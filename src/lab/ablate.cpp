#include "lab/ablate.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "codec/frame_layout.hpp"
#include "codec/rcpcc/codec.hpp"
#include "sensor/spherical_grid.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

/// Absolute errors of some cells.
struct ErrorSum {
  double metres = 0;
  std::size_t cells = 0;

  void add(std::int32_t before_mm, std::int32_t after_mm) {
    metres += std::abs(static_cast<double>(after_mm) - before_mm) * 1e-3;
    ++cells;
  }
  [[nodiscard]] double mean() const {
    return cells > 0 ? metres / static_cast<double>(cells)
                     : std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace

struct RangeErrorMeter::State {
  explicit State(const RcpccOptions& options)
      : projector(options, Crop{}), encoder(options, Crop{}) {}

  SphericalProjector projector;
  rcpcc::Encoder encoder;
  rcpcc::Decoder decoder;
  RangeImage before;
  PartList parts;
  FrameHeader header;
  std::vector<std::byte> frame;
  PointCloud decoded;

  ErrorSum fitted, unfit;
  std::size_t points = 0;
  std::size_t bytes = 0;
};

RangeErrorMeter::RangeErrorMeter(std::unique_ptr<State> state) : state_(std::move(state)) {}
RangeErrorMeter::RangeErrorMeter(RangeErrorMeter&&) noexcept = default;
RangeErrorMeter& RangeErrorMeter::operator=(RangeErrorMeter&&) noexcept = default;
RangeErrorMeter::~RangeErrorMeter() = default;

Result<RangeErrorMeter> RangeErrorMeter::create(const RcpccOptions& options) {
  if (const Status valid = rcpcc::check(options); !valid) return tl::unexpected(valid.error());
  return RangeErrorMeter(std::make_unique<State>(options));
}

Status RangeErrorMeter::add(const CloudView& cloud) {
  State& s = *state_;
  SweepCounts counts;
  s.projector.project(cloud, s.before, counts);
  if (Status encoded = s.encoder.encode(cloud, s.parts, counts); !encoded) return encoded;
  write_frame(CodecId::rcpcc, SweepInfo{}, counts, s.parts, s.frame);
  if (Status parsed = parse_frame_header(s.frame, s.header); !parsed) return parsed;
  if (Status decoded = s.decoder.decode(s.frame, s.header, s.decoded); !decoded) return decoded;

  const std::vector<std::int32_t>& before = s.before.range_mm;
  const std::vector<std::int32_t>& after = s.decoder.image().range_mm;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i] != 0) (s.encoder.fitted()[i] != 0 ? s.fitted : s.unfit).add(before[i], after[i]);
  }
  s.points += cloud.size;
  s.bytes += s.frame.size();
  return {};
}

RangeErrors RangeErrorMeter::errors() const {
  const ErrorSum& fitted = state_->fitted;
  const ErrorSum& unfit = state_->unfit;
  const ErrorSum all{fitted.metres + unfit.metres, fitted.cells + unfit.cells};
  RangeErrors errors;
  errors.fitted_mae_m = fitted.mean();
  errors.unfit_mae_m = unfit.mean();
  errors.mae_m = all.mean();
  errors.fitted_share = static_cast<double>(fitted.cells) / static_cast<double>(all.cells);
  if (state_->bytes > 0) {
    errors.ratio = 16.0 * static_cast<double>(state_->points) / static_cast<double>(state_->bytes);
  }
  return errors;
}

namespace {

RcpccOptions options_of(const ModelRow& row, RcpccOptions options) {
  options.model = row.model;
  options.params.threshold_m = row.threshold_m;
  return options;
}

RcpccOptions options_of(const UnfitRow& row, RcpccOptions options) {
  options.unfit = row.coding;
  options.params.quantiser_step_m = row.quantiser_step_m;
  return options;
}

/// Every row's meter: those of the first table, then those of the second.
Result<std::vector<RangeErrorMeter>> make_meters(const Ablation& tables, const RcpccOptions& base) {
  std::vector<RangeErrorMeter> meters;
  std::vector<RcpccOptions> settings;
  for (const ModelRow& row : tables.models) settings.push_back(options_of(row, base));
  for (const UnfitRow& row : tables.unfit) settings.push_back(options_of(row, base));
  for (const RcpccOptions& setting : settings) {
    auto meter = RangeErrorMeter::create(setting);
    if (!meter) return tl::unexpected(std::move(meter.error()));
    meters.push_back(std::move(*meter));
  }
  return meters;
}

}  // namespace

Result<Ablation> ablate(std::span<const std::filesystem::path> sweeps,
                        const AblationOptions& options) {
  if (sweeps.empty()) return fail(ErrorCode::invalid_argument, "ablate: no sweep to measure on");
  Ablation tables;
  auto meters = make_meters(tables, options.base);
  if (!meters) return tl::unexpected(std::move(meters.error()));
  PointCloud cloud;
  for (const auto& path : sweeps) {
    if (Status read = read_cloud(path, cloud); !read) return tl::unexpected(read.error());
    for (RangeErrorMeter& meter : *meters) {
      if (const Status added = meter.add(cloud); !added) {
        return fail(added.error().code, path.string() + ": " + added.error().message);
      }
    }
    if (options.on_sweep) options.on_sweep(path.filename().string());
  }
  auto meter = meters->begin();
  for (ModelRow& row : tables.models) row.ours = (meter++)->errors();
  for (UnfitRow& row : tables.unfit) row.ours = (meter++)->errors();
  return tables;
}

}  // namespace sweepcast::lab
