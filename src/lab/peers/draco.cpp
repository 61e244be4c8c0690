#include "lab/peers/draco.hpp"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sweepcast::lab {
namespace {

constexpr auto kPosition = draco::GeometryAttribute::POSITION;

using Points = std::vector<std::array<float, 3>>;

Points finite_points(const PointCloud& cloud) {
  Points points;
  points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.is_finite(i)) points.push_back({cloud.x[i], cloud.y[i], cloud.z[i]});
  }
  return points;
}

/// Draco's explicit quantisation of a cloud: coordinates as whole steps from a corner.
struct Quantisation {
  std::array<float, 3> origin{};
  int bits = 1;
  float range = 0;

  /// For at least one point. No bits where more than 30 would be needed.
  Quantisation(const Points& points, double step_m) : origin(points.front()) {
    std::array<float, 3> highest = origin;
    for (const auto& point : points) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        origin[axis] = std::min(origin[axis], point[axis]);
        highest[axis] = std::max(highest[axis], point[axis]);
      }
    }
    double steps = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      steps = std::max(steps, (double{highest[axis]} - double{origin[axis]}) / step_m + 1.0);
    }
    while (bits <= kMostBits && largest() < steps) ++bits;
    if (bits > kMostBits) bits = 0;
    range = static_cast<float>(step_m * largest());
  }

  static constexpr int kMostBits = 30;

  [[nodiscard]] double largest() const {
    return static_cast<double>((std::int64_t{1} << bits) - 1);
  }
};

/// At least one point, as Draco wants them.
std::unique_ptr<draco::PointCloud> to_draco(const Points& points) {
  auto attribute = std::make_unique<draco::PointAttribute>();
  attribute->Init(kPosition, 3, draco::DT_FLOAT32, false, points.size());
  attribute->buffer()->Write(0, points.data(), points.size() * sizeof(points[0]));
  auto result = std::make_unique<draco::PointCloud>();
  result->set_num_points(static_cast<std::uint32_t>(points.size()));
  result->AddAttribute(std::move(attribute));
  return result;
}

Status from_draco(const draco::PointCloud& decoded, PointCloud& cloud) {
  const draco::PointAttribute* position = decoded.GetNamedAttribute(kPosition);
  if (position == nullptr) return fail(ErrorCode::corrupt, "draco: the result has no positions");
  cloud.clear();
  cloud.resize_xyz(decoded.num_points());
  for (std::uint32_t i = 0; i < decoded.num_points(); ++i) {
    std::array<float, 3> point{};
    position->GetMappedValue(draco::PointIndex(i), point.data());
    cloud.x[i] = point[0];
    cloud.y[i] = point[1];
    cloud.z[i] = point[2];
  }
  return {};
}

Status failed(const draco::Status& status) {
  return fail(ErrorCode::corrupt, "draco: " + status.error_msg_string());
}

class DracoPeer : public Peer {
 public:
  explicit DracoPeer(const DracoOptions& options)
      : Peer("draco-kd", setting_of(options)), step_m_(options.step_m) {
    const int speed = 10 - options.compression_level;
    encoder_.SetSpeedOptions(speed, speed);
    encoder_.SetAttributeQuantization(kPosition, options.quantisation_bits);
    encoder_.SetEncodingMethod(draco::POINT_CLOUD_KD_TREE_ENCODING);
  }

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    const Points points = finite_points(cloud);
    if (points.empty()) return std::span<const std::byte>{};  // Draco refuses these
    if (step_m_ > 0.0) {
      const Quantisation to(points, step_m_);
      if (to.bits == 0) {
        return fail(ErrorCode::limit,
                    fmt::format("draco: the cloud is too large for steps of {} m; "
                                "allow larger errors",
                                step_m_));
      }
      encoder_.SetAttributeExplicitQuantization(kPosition, to.bits, 3, to.origin.data(), to.range);
    }
    buffer_.Clear();
    const draco::Status status = encoder_.EncodePointCloudToBuffer(*to_draco(points), &buffer_);
    if (!status.ok()) return tl::unexpected(failed(status).error());
    return std::as_bytes(std::span(buffer_.data(), buffer_.size()));
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    cloud.clear();
    if (bytes.empty()) return {};
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    auto decoded = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
    if (!decoded.ok()) return failed(decoded.status());
    return from_draco(*decoded.value(), cloud);
  }

 private:
  static std::string setting_of(const DracoOptions& options) {
    if (options.step_m > 0.0) return fmt::format("step {} m", options.step_m);
    return fmt::format("qp{} cl{}", options.quantisation_bits, options.compression_level);
  }

  double step_m_;
  draco::Encoder encoder_;
  draco::EncoderBuffer buffer_;
};

}  // namespace

Result<std::unique_ptr<Peer>> make_draco_peer(const DracoOptions& options) {
  if (options.quantisation_bits < 1 || options.quantisation_bits > 30) {
    return fail(ErrorCode::invalid_argument, "draco: quantisation bits must be from 1 to 30");
  }
  if (options.compression_level < 0 || options.compression_level > 10) {
    return fail(ErrorCode::invalid_argument, "draco: compression level must be from 0 to 10");
  }
  if (!(options.step_m >= 0.0 && std::isfinite(options.step_m))) {
    return fail(ErrorCode::invalid_argument,
                "draco: the step must be a number of metres from 0 up");
  }
  return std::make_unique<DracoPeer>(options);
}

Result<Peers> draco_ladder() {
  static constexpr std::array<int, 8> kBits{7, 8, 9, 10, 11, 12, 13, 14};
  return make_ladder(kBits, [](int bits) {
    return make_draco_peer({.quantisation_bits = bits, .compression_level = 7});
  });
}

namespace {

/// Whether no point misses its place by more than `most` (metres), else the worst error so far.
double worst_error(const Points& points, double step_m, double most) {
  if (points.empty()) return 0.0;
  const Quantisation to(points, step_m);
  if (to.bits == 0) return std::numeric_limits<double>::infinity();
  // In Draco's own floats: draco::Quantizer and draco::Dequantizer.
  const auto largest = static_cast<float>(to.largest());
  const float inverse = largest / to.range;
  const float delta = to.range / largest;
  double worst = 0.0;
  for (const auto& point : points) {
    double squared = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float steps = std::floor((point[axis] - to.origin[axis]) * inverse + 0.5F);
      const double miss = double{steps * delta + to.origin[axis]} - double{point[axis]};
      squared += miss * miss;
    }
    worst = std::max(worst, squared);
    if (worst > most * most) break;
  }
  return std::sqrt(worst);
}

}  // namespace

double draco_worst_error(const PointCloud& cloud, double step_m) {
  return worst_error(finite_points(cloud), step_m, std::numeric_limits<double>::infinity());
}

Result<double> coarsest_draco_step(std::span<const PointCloud> clouds, double max_error_m) {
  if (!(max_error_m >= 0.001 && max_error_m <= 2.0)) {
    return fail(ErrorCode::invalid_argument,
                "draco: the largest error must lie between 0.001 and 2 m");
  }
  std::vector<Points> sweeps;
  sweeps.reserve(clouds.size());
  for (const PointCloud& cloud : clouds) sweeps.push_back(finite_points(cloud));
  constexpr double kUnits = 1e5;  // a step is whole 10 um
  const double safe = 2.0 / std::sqrt(3.0) * max_error_m * kUnits;
  const std::int64_t less = std::max<std::int64_t>(1, std::llround(safe / 1000.0));
  for (auto step = std::llround(1.1 * safe); 2.0 * static_cast<double>(step) > safe; step -= less) {
    const double step_m = static_cast<double>(step) / kUnits;
    const auto holds = [&](const Points& points) {
      return worst_error(points, step_m, max_error_m) <= max_error_m;
    };
    if (std::all_of(sweeps.begin(), sweeps.end(), holds)) return step_m;
  }
  return fail(ErrorCode::limit, fmt::format("draco: no step keeps every point within {} m; allow "
                                            "larger errors, or leave far points out",
                                            max_error_m));
}

}  // namespace sweepcast::lab
