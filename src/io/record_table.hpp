// What PCD and PLY share: a table of records whose fields have a name and a number type. Each
// format adds only its header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/number_reader.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// The most points that a cloud in a file may have.
inline constexpr std::uint64_t kMaxPoints = std::uint64_t{1} << 24;
/// The most fields of a record, and numbers of a field, that a header may announce.
inline constexpr std::uint64_t kMaxFields = 4096;

/// What a field means to a cloud.
enum class CloudColumn : std::uint8_t { none, x, y, z, intensity, ring, time, filled };

/// A field of every record.
struct RecordField {
  std::string name;
  NumberType type = NumberType::f32;
  std::uint64_t count = 1;                 ///< numbers in a row; the first is the value
  std::optional<NumberType> list_count{};  ///< the field is a list: its length is stored, as this
  CloudColumn column = CloudColumn::none;
};

/// Finds the fields that `read_cloud` documents by their names (upper or lower case), and sets
/// their `column`. Of several candidates the one that stands first in the documentation wins.
/// Errors: unsupported (no x, y or z).
[[nodiscard]] Status assign_columns(std::vector<RecordField>& fields);

/// The names of the fields that no column takes; padding, named "_", is none. To be called after
/// `assign_columns`.
[[nodiscard]] std::vector<std::string> names_of_skipped(const std::vector<RecordField>& fields);

/// Bytes of a record without lists.
[[nodiscard]] std::size_t record_size(const std::vector<RecordField>& fields);

/// Reads `count` records into a cloud, record after record. Reals in a time field are seconds,
/// integers nanoseconds; the smallest becomes 0; NaN becomes 0 in ring and time.
/// Errors: corrupt (a number, a ring outside 0 to 65535), truncated, limit (count).
[[nodiscard]] Status read_records(NumberReader& reader, const std::vector<RecordField>& fields,
                                  std::uint64_t count, PointCloud& cloud);

/// The same for a table that is stored field after field: all values of the first one, and so on.
/// Binary only, without lists.
[[nodiscard]] Status read_columns(NumberReader& reader, const std::vector<RecordField>& fields,
                                  std::uint64_t count, PointCloud& cloud);

/// Passes over `count` records. Errors: corrupt, truncated.
[[nodiscard]] Status skip_records(NumberReader& reader, const std::vector<RecordField>& fields,
                                  std::uint64_t count);

/// The fields that a cloud is written with: x y z and intensity as f32, ring as u16, time as f64
/// seconds, filled as u8; optional ones where the cloud has them.
[[nodiscard]] std::vector<RecordField> fields_of(const PointCloud& cloud);

/// Appends all records to `out`, record after record; text has a line for each. Not big-endian.
void write_records(const PointCloud& cloud, const std::vector<RecordField>& fields,
                   NumberCoding coding, std::vector<std::byte>& out);

/// Appends the table field after field, in binary, little-endian.
void write_columns(const PointCloud& cloud, const std::vector<RecordField>& fields,
                   std::vector<std::byte>& out);

/// Appends text.
void append_text(std::string_view text, std::vector<std::byte>& out);

}  // namespace sweepcast
