#include <string>

#include "io/formats.hpp"
#include "io/ply_header.hpp"

namespace sweepcast {

Status parse_ply(std::span<const std::byte> bytes, PointCloud& cloud,
                 std::vector<std::string>* skipped) {
  if (bytes.empty()) return fail(ErrorCode::truncated, "is empty; copy or record it again");
  PlyHeader header;
  if (Status status = parse_ply_header(bytes, header); !status) return status;
  NumberReader reader(bytes.subspan(header.size), *header.coding, header.lines);
  for (PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      if (Status status = assign_columns(element.fields); !status) return status;
      if (skipped != nullptr) *skipped = names_of_skipped(element.fields);
      return read_records(reader, element.fields, element.count, cloud);
    }
    if (Status status = skip_records(reader, element.fields, element.count); !status) return status;
  }
  return fail(ErrorCode::unsupported, "has no element 'vertex'; it is not a point cloud");
}

void serialize_ply(const PointCloud& cloud, CloudEncoding encoding, std::vector<std::byte>& out) {
  out.clear();
  const bool text = encoding == CloudEncoding::ascii;
  const std::vector<RecordField> fields = fields_of(cloud);
  std::string header = "ply\nformat ";
  header += text ? "ascii" : "binary_little_endian";
  header += " 1.0\nelement vertex " + std::to_string(cloud.size()) + "\n";
  for (const RecordField& field : fields) {
    (header += "property ") += ply_name_of(field.type);
    header += " " + field.name + "\n";
  }
  append_text(header + "end_header\n", out);
  write_records(cloud, fields, text ? NumberCoding::text : NumberCoding::little_endian, out);
}

}  // namespace sweepcast
