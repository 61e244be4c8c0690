#include "codec/beam/exact_coder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "codec/beam/integer_coder.hpp"
#include "codec/beam/ordered_float.hpp"
#include "codec/entropy/range_coder.hpp"
#include "core/bytes.hpp"
#include "sensor/motion.hpp"

namespace sweepcast::beam {
namespace {

using Point = std::array<float, 3>;

constexpr double kLargestMultiple = 1e9;

// The numbers that coordinates are multiples of: 1 / divisor, metres; or none.
struct Grid {
  std::int32_t divisor = 0;  // 0: floats' bits
  bool by_product = false;   // the file's maker multiplied floats in place of dividing

  [[nodiscard]] float value(std::int64_t multiple) const {
    if (by_product) return static_cast<float>(multiple) * (1.0F / static_cast<float>(divisor));
    return static_cast<float>(static_cast<double>(multiple) / divisor);
  }
  [[nodiscard]] std::int64_t nearest(double value) const {
    const double multiple = std::floor(value * divisor + 0.5);
    const bool sound = std::abs(multiple) <= kLargestMultiple;  // false for NaN
    return sound ? static_cast<std::int64_t>(multiple) : 0;
  }
};

// Zero may have a sign, which is coded apart.
bool is_multiple(const Grid& grid, float value) {
  if (!(std::abs(double{value} * grid.divisor) < kLargestMultiple)) return false;
  return grid.value(grid.nearest(value)) == value;
}

Grid find_grid(const PointCloud& truth) {
  for (const std::int32_t divisor : {1000, 100, 500, 10'000, 256, 1024, 4096, 65'536}) {
    for (const bool by_product : {false, true}) {
      const Grid grid{divisor, by_product};
      const auto fits = [&](const std::vector<float>& values) {
        return std::all_of(values.begin(), values.end(),
                           [&](float value) { return is_multiple(grid, value); });
      };
      if (fits(truth.x) && fits(truth.y) && fits(truth.z)) return grid;
    }
  }
  return {};
}

// The unit that ranges are multiples of, give or take their rounding, 0.1 mm; 0: none.
std::int32_t find_range_unit(std::span<const std::int32_t> ranges) {
  for (const std::int32_t unit : {50, 40, 30, 20, 10}) {
    const auto near = std::count_if(ranges.begin(), ranges.end(),
                                    [&](std::int32_t range) { return (range + 1) % unit <= 2; });
    if (!ranges.empty() && near * 100 >= static_cast<std::ptrdiff_t>(ranges.size()) * 98) {
      return unit;
    }
  }
  return 0;
}

Point point(const PointCloud& cloud, std::size_t i) {
  return {cloud.x[i], cloud.y[i], cloud.z[i]};
}

// Both directions. `Coder` is RangeEncoder or RangeDecoder.
template <class Coder>
class ExactCoder {
 public:
  ExactCoder(Coder& coder, const Grid& grid, std::int32_t range_unit, const PointOrigins& origins)
      : coder_(coder), grid_(grid), range_unit_(range_unit), origins_(origins) {}

  // Codes point `i` of which `decoded` is known. Decoding, `truth` and its range are not used.
  Point code(std::size_t i, const Point& decoded, const Point& truth, std::int32_t true_range) {
    const std::size_t row = origins_.row[i];
    const bool on_beam = row < origins_.beam_m.size();
    const std::array<double, 3> origin = on_beam ? origins_.beam_m[row] : std::array<double, 3>{};
    const std::size_t first = std::abs(decoded[0]) >= std::abs(decoded[1]) ? 0 : 1;
    const auto of_row = static_cast<std::uint32_t>(row) * 4U;
    Point exact{};
    double estimate_of_first = decoded[first];
    if (on_beam && range_unit_ > 0) {
      const std::int64_t range = code_range(origins_.range[i], of_row, true_range);
      const double stretch = static_cast<double>(range) / origins_.range[i];
      estimate_of_first = origin[first] + (decoded[first] - origin[first]) * stretch;
    }
    exact[first] = code_value(0, estimate_of_first, of_row, truth[first]);
    // How much farther along its beam the point lies.
    const double reach = decoded[first] - origin[first];
    const double stretch =
        on_beam && std::abs(reach) > kTooNear ? (exact[first] - origin[first]) / reach : 1.0;
    for (const std::size_t axis : {1 - first, std::size_t{2}}) {
      const double estimate = origin[axis] + (double{decoded[axis]} - origin[axis]) * stretch;
      exact[axis] = code_value(axis == 2 ? 2 : 1, estimate, of_row + 1, truth[axis]);
    }
    return exact;
  }

 private:
  static constexpr double kTooNear = 0.05;

  // The true range, to the unit.
  std::int64_t code_range(std::int32_t decoded, std::uint32_t context, std::int32_t truth) {
    const auto multiple = [&](std::int32_t range) {
      return (std::int64_t{range} + range_unit_ / 2) / range_unit_;
    };
    const std::int64_t near = multiple(decoded);
    return std::clamp<std::int64_t>(
               wrapped_sum(near, ranges_.code(coder_, multiple(truth) - near, context)), 0,
               std::int64_t{1} << 32) *
           range_unit_;
  }

  float code_value(std::size_t role, double estimate, std::uint32_t context, float truth) {
    IntegerCoder& numbers = numbers_[role];
    if (grid_.divisor == 0) {
      // Beyond the floats only where damaged bytes stretch a point.
      const bool sound = std::abs(estimate) < 1e30;
      const std::int64_t near = ordered_bits(sound ? static_cast<float>(estimate) : 0.0F);
      const std::int64_t miss = std::int64_t{ordered_bits(truth)} - near;
      return float_of_ordered(
          static_cast<std::uint32_t>(wrapped_sum(near, numbers.code(coder_, miss, context))));
    }
    const std::int64_t near = grid_.nearest(estimate);
    const std::int64_t multiple =
        wrapped_sum(near, numbers.code(coder_, grid_.nearest(truth) - near, context));
    const float value = grid_.value(multiple);
    const bool negative_zero =
        value == 0 && signs_.code(coder_, std::signbit(truth) ? 1 : 0, 0) != 0;
    return negative_zero ? -0.0F : value;
  }

  Coder& coder_;
  Grid grid_;
  std::int32_t range_unit_;
  const PointOrigins& origins_;
  IntegerCoder ranges_;
  std::array<IntegerCoder, 3> numbers_;  // of the first coordinate, the second, and z
  IntegerCoder signs_;
};

}  // namespace

PointOrigins origins_of(const SensorModel* model, const BeamImage& image, std::size_t extras) {
  PointOrigins origins;
  if (model != nullptr && image.cols > 0) {
    const Mount& mount = mount_of(*model, image.motion);
    const Twist<double> twist(mount);
    for (const Beam& beam : model->beams) {
      const std::array<double, 3> own{0.0, 0.0, static_cast<double>(beam.height) / kLengthUnits};
      origins.beam_m.push_back(mount == Mount{} ? own : twist.redo(own, 1.0));
    }
    const auto cols = static_cast<std::size_t>(image.cols);
    for (std::size_t cell = 0; cell < image.cells(); ++cell) {
      if (image.range[cell] == 0) continue;
      origins.row.push_back(static_cast<std::uint16_t>(cell / cols));
      origins.range.push_back(image.range[cell]);
    }
  }
  const auto none = static_cast<std::uint16_t>(origins.beam_m.size());
  origins.row.resize(origins.row.size() + extras, none);
  return origins;
}

void write_exact(const PointCloud& decoded, const PointOrigins& origins, const PointCloud& truth,
                 std::span<const std::int32_t> ranges, std::vector<std::byte>& out) {
  const Grid grid = find_grid(truth);
  ByteWriter head(out);
  head.put_varint(static_cast<std::uint64_t>(grid.divisor));
  head.put(static_cast<std::uint8_t>(grid.by_product ? 1 : 0));
  const std::int32_t unit = grid.divisor == 0 ? find_range_unit(ranges) : 0;
  head.put_varint(static_cast<std::uint64_t>(unit));
  RangeEncoder coder(out);
  ExactCoder<RangeEncoder> points(coder, grid, unit, origins);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    points.code(i, point(decoded, i), point(truth, i), i < ranges.size() ? ranges[i] : 0);
  }
  coder.finish();
}

bool read_exact(std::span<const std::byte> bytes, const PointOrigins& origins, PointCloud& cloud) {
  constexpr std::uint64_t kLargestDivisor = 1 << 20;
  constexpr std::uint64_t kLargestRangeUnit = 1 << 10;
  ByteReader head(bytes);
  Grid grid;
  grid.divisor = static_cast<std::int32_t>(head.get_varint(kLargestDivisor));
  grid.by_product = head.get<std::uint8_t>() != 0;
  const auto unit = static_cast<std::int32_t>(head.get_varint(kLargestRangeUnit));
  if (!head.ok()) return false;
  RangeDecoder coder(head.get_bytes(head.remaining()));
  ExactCoder<RangeDecoder> points(coder, grid, unit, origins);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (coder.overran()) return false;
    const Point exact = points.code(i, point(cloud, i), {}, 0);
    cloud.x[i] = exact[0];
    cloud.y[i] = exact[1];
    cloud.z[i] = exact[2];
  }
  return !coder.overran();
}

}  // namespace sweepcast::beam
