#include "sweepcast/cloud.hpp"

namespace sweepcast {
namespace {

template <class T>
T load(const std::byte* p) noexcept {
  T value;
  std::memcpy(&value, p, sizeof(T));
  return value;
}

template <class T>
FieldView column(const std::vector<T>& values, ScalarType type) noexcept {
  if (values.empty()) return {};
  return {reinterpret_cast<const std::byte*>(values.data()), sizeof(T), type};
}

FieldView column(std::span<const float> values) noexcept {
  return {reinterpret_cast<const std::byte*>(values.data()), sizeof(float), ScalarType::f32};
}

}  // namespace

void PointCloud::clear() noexcept {
  x.clear();
  y.clear();
  z.clear();
  intensity.clear();
  ring.clear();
  time_ns.clear();
  filled.clear();
  width = 0;
}

void PointCloud::resize_xyz(std::size_t count) {
  x.resize(count);
  y.resize(count);
  z.resize(count);
}

std::size_t size_of(ScalarType type) noexcept {
  switch (type) {
    case ScalarType::i8:
    case ScalarType::u8:
      return 1;
    case ScalarType::i16:
    case ScalarType::u16:
      return 2;
    case ScalarType::i32:
    case ScalarType::u32:
    case ScalarType::f32:
      return 4;
    case ScalarType::i64:
    case ScalarType::f64:
      return 8;
  }
  return 0;
}

double FieldView::at(std::size_t i) const noexcept {
  const std::byte* p = data + i * stride;
  const auto value = [&]() -> double {
    switch (type) {
      case ScalarType::i8:
        return load<std::int8_t>(p);
      case ScalarType::u8:
        return load<std::uint8_t>(p);
      case ScalarType::i16:
        return load<std::int16_t>(p);
      case ScalarType::u16:
        return load<std::uint16_t>(p);
      case ScalarType::i32:
        return load<std::int32_t>(p);
      case ScalarType::u32:
        return load<std::uint32_t>(p);
      case ScalarType::i64:
        return static_cast<double>(load<std::int64_t>(p));
      case ScalarType::f32:
        return static_cast<double>(load<float>(p));
      case ScalarType::f64:
        return load<double>(p);
    }
    return 0.0;
  }();
  return value * scale;
}

void FieldView::read(std::size_t begin, std::span<float> out) const noexcept {
  if (type == ScalarType::f32 && scale == 1.0) {  // the common case, kept free of branches
    const std::byte* p = data + begin * stride;
    for (float& value : out) {
      value = load<float>(p);
      p += stride;
    }
    return;
  }
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>(at(begin + i));
}

CloudView::CloudView(const PointCloud& cloud) noexcept
    : size(cloud.size()),
      x(column(std::span<const float>(cloud.x))),
      y(column(std::span<const float>(cloud.y))),
      z(column(std::span<const float>(cloud.z))),
      intensity(column(cloud.intensity, ScalarType::f32)),
      ring(column(cloud.ring, ScalarType::u16)),
      time_ns(column(cloud.time_ns, ScalarType::i64)),
      width(cloud.width) {}

CloudView CloudView::columns(std::span<const float> x, std::span<const float> y,
                             std::span<const float> z) noexcept {
  CloudView view;
  view.size = x.size();
  view.x = column(x);
  view.y = column(y);
  view.z = column(z);
  return view;
}

FieldView CloudView::field(std::span<const std::byte> data, std::size_t step, FieldLayout layout,
                           double scale) noexcept {
  if (layout.offset > step || size_of(layout.type) > step - layout.offset) return {};
  return {data.data() + layout.offset, step, layout.type, scale};
}

CloudView CloudView::records(std::span<const std::byte> data, std::size_t step, FieldLayout x,
                             FieldLayout y, FieldLayout z) noexcept {
  CloudView view;
  view.size = step == 0 ? 0 : data.size() / step;
  view.x = field(data, step, x);
  view.y = field(data, step, y);
  view.z = field(data, step, z);
  return view;
}

}  // namespace sweepcast
