#include "view/foxglove.hpp"

#include <bit>
#include <initializer_list>

#include "view/protobuf.hpp"

namespace sweepcast::view {
namespace {

// Types of fields in google/protobuf/descriptor.proto.
enum class FieldType : std::uint8_t {
  real = 1,
  int64 = 3,
  int32 = 5,
  text = 9,
  message = 11,
  bytes = 12,
  fixed32 = 7,
  enumeration = 14,
};

// Values of foxglove.PackedElementField.NumericType.
constexpr std::uint64_t kUint16 = 3;
constexpr std::uint64_t kFloat32 = 7;

struct Field {
  std::string_view name;
  FieldType type = FieldType::real;
  std::string_view type_name{};  ///< of a message or an enumeration
  bool repeated = false;
};

/// A DescriptorProto whose fields are numbered from 1.
Bytes message_type(std::string_view name, std::initializer_list<Field> fields) {
  Bytes out;
  ProtobufWriter message(out);
  message.text(1, name);
  std::uint64_t number = 0;
  for (const Field& field : fields) {
    Bytes bytes;
    ProtobufWriter writer(bytes);
    writer.text(1, field.name).varint(3, ++number).varint(4, field.repeated ? 3 : 1);
    writer.varint(5, static_cast<std::uint64_t>(field.type));
    if (!field.type_name.empty()) writer.text(6, field.type_name);
    message.bytes(2, bytes);
  }
  return out;
}

Bytes numeric_type() {
  Bytes out;
  ProtobufWriter enumeration(out);
  enumeration.text(1, "NumericType");
  std::uint64_t number = 0;
  for (const char* name :
       {"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"}) {
    Bytes value;
    ProtobufWriter(value).text(1, name).varint(2, number++);
    enumeration.bytes(2, value);
  }
  return out;
}

/// A FileDescriptorProto of one message, appended to the set.
void add_file(Bytes& set, std::string_view name, std::string_view package,
              std::initializer_list<std::string_view> imports, const Bytes& message) {
  Bytes file;
  ProtobufWriter writer(file);
  writer.text(1, name).text(2, package);
  for (const std::string_view import : imports) writer.text(3, import);
  writer.bytes(4, message).text(12, "proto3");
  ProtobufWriter(set).bytes(1, file);
}

}  // namespace

Bytes point_cloud_descriptors() {
  using enum FieldType;
  Bytes element = message_type("PackedElementField",
                               {{"name", text},
                                {"offset", fixed32},
                                {"type", enumeration, ".foxglove.PackedElementField.NumericType"}});
  ProtobufWriter(element).bytes(4, numeric_type());
  Bytes set;
  add_file(set, "google/protobuf/timestamp.proto", "google.protobuf", {},
           message_type("Timestamp", {{"seconds", int64}, {"nanos", int32}}));
  add_file(set, "foxglove/Vector3.proto", "foxglove", {},
           message_type("Vector3", {{"x"}, {"y"}, {"z"}}));
  add_file(set, "foxglove/Quaternion.proto", "foxglove", {},
           message_type("Quaternion", {{"x"}, {"y"}, {"z"}, {"w"}}));
  add_file(set, "foxglove/Pose.proto", "foxglove",
           {"foxglove/Vector3.proto", "foxglove/Quaternion.proto"},
           message_type("Pose", {{"position", message, ".foxglove.Vector3"},
                                 {"orientation", message, ".foxglove.Quaternion"}}));
  add_file(set, "foxglove/PackedElementField.proto", "foxglove", {}, element);
  add_file(set, "foxglove/PointCloud.proto", "foxglove",
           {"foxglove/PackedElementField.proto", "foxglove/Pose.proto",
            "google/protobuf/timestamp.proto"},
           message_type("PointCloud", {{"timestamp", message, ".google.protobuf.Timestamp"},
                                       {"frame_id", text},
                                       {"pose", message, ".foxglove.Pose"},
                                       {"point_stride", fixed32},
                                       {"fields", message, ".foxglove.PackedElementField", true},
                                       {"data", bytes}}));
  return set;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out.push_back(i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63]);
    }
  }
  return out;
}

Bytes point_cloud_message(const PointCloud& cloud, std::int64_t stamp_ns,
                          std::string_view frame_id) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t nanos = (stamp_ns % kSecond_ns + kSecond_ns) % kSecond_ns;
  Bytes out;
  Bytes part;
  ProtobufWriter message(out);
  ProtobufWriter(part)
      .varint(1, static_cast<std::uint64_t>((stamp_ns - nanos) / kSecond_ns))
      .varint(2, static_cast<std::uint64_t>(nanos));
  message.bytes(1, part).text(2, frame_id);
  Bytes turn;
  ProtobufWriter(turn).real(4, 1.0);  // the quaternion of no turn
  part.clear();
  ProtobufWriter(part).bytes(1, {}).bytes(2, turn);
  message.bytes(3, part);

  std::uint32_t stride = 0;
  Bytes fields;
  const auto add_field = [&](std::string_view name, std::uint64_t type, std::uint32_t size) {
    part.clear();
    ProtobufWriter(part).text(1, name).fixed32(2, stride).varint(3, type);
    ProtobufWriter(fields).bytes(5, part);
    stride += size;
  };
  for (const char* name : {"x", "y", "z"}) add_field(name, kFloat32, sizeof(float));
  if (cloud.has_intensity()) add_field("intensity", kFloat32, sizeof(float));
  if (cloud.has_ring()) add_field("ring", kUint16, sizeof(std::uint16_t));
  message.fixed32(4, stride);
  out.insert(out.end(), fields.begin(), fields.end());

  std::size_t points = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) points += cloud.is_finite(i) ? 1 : 0;
  out.reserve(out.size() + points * stride + 16);
  message.begin_bytes(6, points * stride);
  ByteWriter data(out);
  const auto put = [&](float value) { data.put(std::bit_cast<std::uint32_t>(value)); };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.is_finite(i)) continue;
    put(cloud.x[i]);
    put(cloud.y[i]);
    put(cloud.z[i]);
    if (cloud.has_intensity()) put(cloud.intensity[i]);
    if (cloud.has_ring()) data.put(cloud.ring[i]);
  }
  return out;
}

}  // namespace sweepcast::view
