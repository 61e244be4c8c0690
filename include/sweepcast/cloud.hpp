// Clouds: an owning one in columns, and a view of anybody's memory.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace sweepcast {

/// The points of one sweep, in columns. Coordinates are metres in the sensor's frame: x forward,
/// y left, z up. The optional columns are either empty or as long as `x`.
struct PointCloud {
  std::vector<float> x, y, z;
  std::vector<float> intensity;       ///< the sensor's own unit; optional
  std::vector<std::uint16_t> ring;    ///< the beam's number, 0 the first; optional
  std::vector<std::int64_t> time_ns;  ///< nanoseconds since the sweep's first firing; optional
  /// 1 where a point was not measured but interpolated by the decoder; optional.
  std::vector<std::uint8_t> filled;
  /// Points in a row of an organised cloud, which is stored row after row, its size a multiple of
  /// it; 0: not organised. Slots without a point have NaN coordinates.
  std::uint32_t width = 0;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] bool empty() const noexcept { return x.empty(); }
  [[nodiscard]] bool has_intensity() const noexcept { return !intensity.empty(); }
  [[nodiscard]] bool has_ring() const noexcept { return !ring.empty(); }
  [[nodiscard]] bool has_time() const noexcept { return !time_ns.empty(); }

  /// Whether all coordinates of a point are numbers: neither NaN nor infinite.
  [[nodiscard]] bool is_finite(std::size_t i) const noexcept {
    return std::isfinite(x[i]) && std::isfinite(y[i]) && std::isfinite(z[i]);
  }

  /// Empties every column and keeps their memory.
  void clear() noexcept;
  /// Gives the coordinates `count` entries; the optional columns stay as they are.
  void resize_xyz(std::size_t count);
};

/// The number types that a point's field may have in foreign memory.
enum class ScalarType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, f32, f64 };

/// Bytes that a number of this type takes.
[[nodiscard]] std::size_t size_of(ScalarType type) noexcept;

/// One field of every point in foreign memory: the i-th value is at `data + i * stride`, in the
/// machine's byte order, not necessarily aligned. Absent where `data` is null.
struct FieldView {
  const std::byte* data = nullptr;
  std::size_t stride = 0;
  ScalarType type = ScalarType::f32;
  double scale = 1.0;  ///< multiplies what is read: 1e9 makes nanoseconds of seconds

  [[nodiscard]] bool present() const noexcept { return data != nullptr; }

  /// Value `i` as a double, scaled. Integers beyond 2^53 lose their last digits.
  [[nodiscard]] double at(std::size_t i) const noexcept;
  /// Converts `out.size()` values from index `begin` on.
  void read(std::size_t begin, std::span<float> out) const noexcept;
};

/// Where a named field of a packed record lies, as a ROS PointCloud2 describes it.
struct FieldLayout {
  std::size_t offset = 0;  ///< bytes from the start of a record
  ScalarType type = ScalarType::f32;
};

/// A view of a cloud that somebody else owns; copies nothing, whatever the layout.
/// The memory must outlive the view.
struct CloudView {
  std::size_t size = 0;
  FieldView x, y, z;
  FieldView intensity;      ///< optional
  FieldView ring;           ///< optional
  FieldView time_ns;        ///< optional; nanoseconds after scaling
  std::uint32_t width = 0;  ///< points in a row of an organised cloud, else 0

  CloudView() = default;
  /// Columns: a `PointCloud`.
  CloudView(const PointCloud& cloud) noexcept;  // NOLINT(google-explicit-constructor): a view of it

  /// Columns of floats; all three must be equally long.
  [[nodiscard]] static CloudView columns(std::span<const float> x, std::span<const float> y,
                                         std::span<const float> z) noexcept;

  /// Records of `step` bytes with the three coordinates at the given places, as in the data of a
  /// PointCloud2. Optional fields are added by `field()`. A field that does not lie within a record
  /// comes out absent, which an encoder refuses.
  [[nodiscard]] static CloudView records(std::span<const std::byte> data, std::size_t step,
                                         FieldLayout x, FieldLayout y, FieldLayout z) noexcept;

  /// Array of structs: `CloudView::structs(points, &P::x, &P::y, &P::z)`, members float or double.
  template <class Point, class Scalar>
  [[nodiscard]] static CloudView structs(std::span<const Point> points, Scalar Point::*x,
                                         Scalar Point::*y, Scalar Point::*z) noexcept {
    static_assert(sizeof(Scalar) == 4 || sizeof(Scalar) == 8, "float or double members");
    const auto type = sizeof(Scalar) == 4 ? ScalarType::f32 : ScalarType::f64;
    CloudView view;
    view.size = points.size();
    if (points.empty()) return view;
    const auto member = [&](Scalar Point::*m) {
      return FieldView{reinterpret_cast<const std::byte*>(&(points.front().*m)), sizeof(Point),
                       type};
    };
    view.x = member(x);
    view.y = member(y);
    view.z = member(z);
    return view;
  }

  /// A further field of the records that `records()` was given, for `intensity`, `ring`, `time_ns`.
  [[nodiscard]] static FieldView field(std::span<const std::byte> data, std::size_t step,
                                       FieldLayout layout, double scale = 1.0) noexcept;
};

}  // namespace sweepcast
