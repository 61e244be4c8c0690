#include "io/record_table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace sweepcast {
namespace {

struct ColumnName {
  CloudColumn column;
  std::string_view name;  // in lower case
};

/// In order of preference within a column.
constexpr std::array<ColumnName, 16> kColumnNames{{
    {CloudColumn::x, "x"},
    {CloudColumn::y, "y"},
    {CloudColumn::z, "z"},
    {CloudColumn::intensity, "intensity"},
    {CloudColumn::intensity, "i"},
    {CloudColumn::intensity, "reflectivity"},
    {CloudColumn::intensity, "scalar_intensity"},
    {CloudColumn::ring, "ring"},
    {CloudColumn::ring, "channel"},
    {CloudColumn::ring, "laser_id"},
    {CloudColumn::time, "time"},
    {CloudColumn::time, "t"},
    {CloudColumn::time, "timestamp"},
    {CloudColumn::time, "time_stamp"},
    {CloudColumn::time, "time_offset"},
    {CloudColumn::filled, "filled"},
}};

bool same_name(std::string_view name, std::string_view lower) {
  const auto lower_case = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::equal(name.begin(), name.end(), lower.begin(), lower.end(),
                    [&](char a, char b) { return lower_case(a) == b; });
}

bool has_column(const std::vector<RecordField>& fields, CloudColumn column) {
  return std::any_of(fields.begin(), fields.end(),
                     [&](const RecordField& field) { return field.column == column; });
}

/// Whole seconds whose nanoseconds fit 63 bits: 292 years.
constexpr std::uint64_t kLongestSeconds = 9'223'372'036U;

/// Puts numbers where they belong in a cloud.
class CloudFiller {
 public:
  CloudFiller(const std::vector<RecordField>& fields, std::size_t count, PointCloud& cloud)
      : cloud_(cloud) {
    cloud_.clear();
    cloud_.resize_xyz(count);
    for (const RecordField& field : fields) {
      if (field.column == CloudColumn::intensity) cloud_.intensity.resize(count);
      if (field.column == CloudColumn::ring) cloud_.ring.resize(count);
      if (field.column == CloudColumn::filled) cloud_.filled.resize(count);
      if (field.column != CloudColumn::time) continue;
      cloud_.time_ns.resize(count);
      if (is_real(field.type)) seconds_.resize(count);
    }
  }

  /// Value of point `i`; what it cannot be is refused on the reader.
  void put(CloudColumn column, std::size_t i, Number number, NumberReader& reader) {
    switch (column) {
      case CloudColumn::x:
        cloud_.x[i] = static_cast<float>(number.real);
        break;
      case CloudColumn::y:
        cloud_.y[i] = static_cast<float>(number.real);
        break;
      case CloudColumn::z:
        cloud_.z[i] = static_cast<float>(number.real);
        break;
      case CloudColumn::intensity:
        cloud_.intensity[i] = static_cast<float>(number.real);
        break;
      case CloudColumn::ring:
        put_ring(i, number.real, reader);
        break;
      case CloudColumn::time:
        cloud_.time_ns[i] = number.integer;
        if (!seconds_.empty()) seconds_[i] = number.real;
        break;
      case CloudColumn::filled:
        cloud_.filled[i] = number.real > 0.0 ? 1 : 0;
        break;
      case CloudColumn::none:
        break;
    }
  }

  /// Makes times relative to the first one. Errors: corrupt.
  [[nodiscard]] Status finish() {
    const bool sound = seconds_.empty() ? subtract_first() : convert_seconds();
    if (sound) return {};
    return fail(ErrorCode::corrupt, "the times of the points lie more than 292 years apart");
  }

 private:
  void put_ring(std::size_t i, double value, NumberReader& reader) {
    if (std::isnan(value)) value = 0.0;  // an organised cloud's point without return
    if (!(value >= 0.0 && value <= std::numeric_limits<std::uint16_t>::max())) {
      return reader.refuse("a ring outside 0 to 65535");
    }
    cloud_.ring[i] = static_cast<std::uint16_t>(value);
  }

  bool subtract_first() {
    std::vector<std::int64_t>& times = cloud_.time_ns;
    if (times.empty()) return true;
    const auto [first, last] = std::minmax_element(times.begin(), times.end());
    const auto begin = static_cast<std::uint64_t>(*first);  // differences modulo 2^64 are exact
    if (static_cast<std::uint64_t>(*last) - begin > kLongestSeconds * 1'000'000'000U) return false;
    for (std::int64_t& time : times) {
      time = static_cast<std::int64_t>(static_cast<std::uint64_t>(time) - begin);
    }
    return true;
  }

  bool convert_seconds() {
    double begin = std::numeric_limits<double>::infinity();
    for (const double time : seconds_) begin = std::min(begin, std::isnan(time) ? begin : time);
    for (std::size_t i = 0; i < seconds_.size(); ++i) {
      const double since = std::isnan(seconds_[i]) ? 0.0 : seconds_[i] - begin;
      if (!(since <= static_cast<double>(kLongestSeconds))) return false;
      cloud_.time_ns[i] = std::llround(since * 1e9);
    }
    return true;
  }

  PointCloud& cloud_;
  std::vector<double> seconds_;
};

/// Refuses a count that the data cannot hold, before memory is taken for it.
Status check_count(const NumberReader& reader, const std::vector<RecordField>& fields,
                   std::uint64_t count) {
  if (count > kMaxPoints) {
    return fail(ErrorCode::limit, "announces " + std::to_string(count) + " points, more than " +
                                      std::to_string(kMaxPoints) + "; split the cloud");
  }
  // Every number takes at least one byte, in text too.
  if (count * fields.size() <= reader.remaining()) return {};
  return fail(ErrorCode::truncated, "announces " + std::to_string(count) +
                                        " points, but the data ends before that; copy or "
                                        "record the file again");
}

/// How many numbers field `field` has in the record that is being read.
std::uint64_t length_of(const RecordField& field, NumberReader& reader) {
  if (!field.list_count) return field.count;
  const Number length = reader.get(*field.list_count);
  if (length.integer >= 0) return static_cast<std::uint64_t>(length.integer);
  reader.refuse("a list of negative length");
  return 0;
}

Status failure_at(std::uint64_t record, std::uint64_t count, const Error& error) {
  return fail(error.code, "record " + std::to_string(record + 1) + " of " + std::to_string(count) +
                              ": " + error.message + "; write the file again");
}

/// A field's value of point `i`, as the file has it; an intensity that the cloud lacks is 0.
double value_of(const PointCloud& cloud, CloudColumn column, std::size_t i) {
  switch (column) {
    case CloudColumn::x:
      return cloud.x[i];
    case CloudColumn::y:
      return cloud.y[i];
    case CloudColumn::z:
      return cloud.z[i];
    case CloudColumn::intensity:
      return cloud.has_intensity() ? cloud.intensity[i] : 0.0F;
    case CloudColumn::ring:
      return cloud.ring[i];
    case CloudColumn::time:
      return static_cast<double>(cloud.time_ns[i]) / 1e9;
    case CloudColumn::filled:
      return cloud.filled[i];
    case CloudColumn::none:
      break;
  }
  return 0.0;
}

template <class T>
void append_number(T value, std::vector<std::byte>& out) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  append_text({digits.data(), static_cast<std::size_t>(end - digits.data())}, out);
}

void append_bits(std::uint64_t bits, std::size_t size, std::vector<std::byte>& out) {
  for (std::size_t i = 0; i < size; ++i) out.push_back(static_cast<std::byte>(bits >> (8 * i)));
}

/// Writes one of the types that `fields_of` uses.
void append_value(double value, NumberType type, NumberCoding coding, std::vector<std::byte>& out) {
  const bool text = coding == NumberCoding::text;
  if (type == NumberType::f32) {
    const auto narrow = static_cast<float>(value);
    return text ? append_number(narrow, out)
                : append_bits(std::bit_cast<std::uint32_t>(narrow), 4, out);
  }
  if (type == NumberType::f64) {
    return text ? append_number(value, out)
                : append_bits(std::bit_cast<std::uint64_t>(value), 8, out);
  }
  const auto integer = static_cast<std::uint64_t>(value);
  return text ? append_number(integer, out) : append_bits(integer, size_of(type), out);
}

}  // namespace

Status assign_columns(std::vector<RecordField>& fields) {
  for (const auto& [column, name] : kColumnNames) {
    if (has_column(fields, column)) continue;
    for (RecordField& field : fields) {
      if (field.list_count || !same_name(field.name, name)) continue;
      field.column = column;
      break;
    }
  }
  for (const auto& [column, name] : kColumnNames) {
    if (column > CloudColumn::z || has_column(fields, column)) continue;
    return fail(ErrorCode::unsupported,
                "has no field '" + std::string(name) + "'; a cloud needs x, y and z");
  }
  return {};
}

std::vector<std::string> names_of_skipped(const std::vector<RecordField>& fields) {
  std::vector<std::string> names;
  for (const RecordField& field : fields) {
    if (field.column == CloudColumn::none && field.name != "_") names.push_back(field.name);
  }
  return names;
}

std::size_t record_size(const std::vector<RecordField>& fields) {
  std::size_t size = 0;
  for (const RecordField& field : fields) {
    size += size_of(field.type) * static_cast<std::size_t>(field.count);
  }
  return size;
}

Status read_records(NumberReader& reader, const std::vector<RecordField>& fields,
                    std::uint64_t count, PointCloud& cloud) {
  if (Status status = check_count(reader, fields, count); !status) return status;
  CloudFiller filler(fields, static_cast<std::size_t>(count), cloud);
  for (std::size_t i = 0; i < count; ++i) {
    reader.begin_record();
    for (const RecordField& field : fields) {
      std::uint64_t length = length_of(field, reader);
      if (field.column != CloudColumn::none) {
        filler.put(field.column, i, reader.get(field.type), reader);
        --length;
      }
      reader.skip(field.type, length);
    }
    reader.end_record();
    if (!reader.ok()) return failure_at(i, count, reader.error());
  }
  return filler.finish();
}

Status read_columns(NumberReader& reader, const std::vector<RecordField>& fields,
                    std::uint64_t count, PointCloud& cloud) {
  if (Status status = check_count(reader, fields, count); !status) return status;
  CloudFiller filler(fields, static_cast<std::size_t>(count), cloud);
  for (const RecordField& field : fields) {
    if (field.column == CloudColumn::none) {
      reader.skip(field.type, field.count * count);
      continue;
    }
    for (std::size_t i = 0; i < count; ++i) {
      filler.put(field.column, i, reader.get(field.type), reader);
      reader.skip(field.type, field.count - 1);
      if (!reader.ok()) return failure_at(i, count, reader.error());
    }
  }
  if (!reader.ok()) return failure_at(0, count, reader.error());
  return filler.finish();
}

Status skip_records(NumberReader& reader, const std::vector<RecordField>& fields,
                    std::uint64_t count) {
  if (fields.empty()) return {};  // takes no bytes, however many there are
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!reader.skip_line()) {
      for (const RecordField& field : fields) reader.skip(field.type, length_of(field, reader));
    }
    if (!reader.ok()) return failure_at(i, count, reader.error());
  }
  return {};
}

std::vector<RecordField> fields_of(const PointCloud& cloud) {
  std::vector<RecordField> fields;
  const auto add = [&](const char* name, NumberType type, CloudColumn column) {
    fields.push_back({.name = name, .type = type, .column = column});
  };
  add("x", NumberType::f32, CloudColumn::x);
  add("y", NumberType::f32, CloudColumn::y);
  add("z", NumberType::f32, CloudColumn::z);
  if (cloud.has_intensity()) add("intensity", NumberType::f32, CloudColumn::intensity);
  if (cloud.has_ring()) add("ring", NumberType::u16, CloudColumn::ring);
  if (cloud.has_time()) add("time", NumberType::f64, CloudColumn::time);
  if (!cloud.filled.empty()) add("filled", NumberType::u8, CloudColumn::filled);
  return fields;
}

void write_records(const PointCloud& cloud, const std::vector<RecordField>& fields,
                   NumberCoding coding, std::vector<std::byte>& out) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (coding == NumberCoding::text && k > 0) append_text(" ", out);
      append_value(value_of(cloud, fields[k].column, i), fields[k].type, coding, out);
    }
    if (coding == NumberCoding::text) append_text("\n", out);
  }
}

void write_columns(const PointCloud& cloud, const std::vector<RecordField>& fields,
                   std::vector<std::byte>& out) {
  for (const RecordField& field : fields) {
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      append_value(value_of(cloud, field.column, i), field.type, NumberCoding::little_endian, out);
    }
  }
}

void append_text(std::string_view text, std::vector<std::byte>& out) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  out.insert(out.end(), begin, begin + text.size());
}

}  // namespace sweepcast
