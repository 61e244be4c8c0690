#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

#include "io/file.hpp"
#include "io/ply_header.hpp"
#include "lab/mesh/triangle_mesh.hpp"

namespace sweepcast::lab {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{8} << 30U;
constexpr std::uint64_t kMaxElements = std::uint64_t{1} << 27U;

// Where x, y and z stand among a vertex' numbers; none where one is missing, or behind a list.
std::optional<std::array<std::size_t, 3>> find_coordinates(const PlyElement& vertex) {
  constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
  std::array<std::size_t, 3> found{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t i = 0;
    while (i < vertex.fields.size() && vertex.fields[i].name != kNames[axis]) ++i;
    if (i == vertex.fields.size() || vertex.fields[i].list_count) return {};
    found[axis] = i;
  }
  return found;
}

// Reads all of a record, lists being skipped.
void read_numbers(NumberReader& reader, const std::vector<RecordField>& fields,
                  std::vector<double>& numbers) {
  numbers.clear();
  reader.begin_record();
  for (const RecordField& field : fields) {
    if (field.list_count) {
      const std::int64_t length = reader.get(*field.list_count).integer;
      if (length < 0) reader.refuse("a list of negative length; write the file again");
      if (reader.ok()) reader.skip(field.type, static_cast<std::uint64_t>(length));
      numbers.push_back(0.0);
    } else {
      numbers.push_back(reader.get(field.type).real);
    }
  }
  reader.end_record();
}

void read_vertices(NumberReader& reader, const PlyElement& element,
                   const std::array<std::size_t, 3>& coordinates, TriangleMesh& mesh) {
  std::vector<double> numbers;
  for (std::uint64_t i = 0; i < element.count && reader.ok(); ++i) {
    read_numbers(reader, element.fields, numbers);
    Eigen::Vector3f vertex;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      vertex[static_cast<Eigen::Index>(axis)] = static_cast<float>(numbers[coordinates[axis]]);
    }
    if (!vertex.allFinite()) {
      reader.refuse("a vertex that is not finite; write the file again");
    }
    mesh.vertices.push_back(vertex);
  }
}

// Reads a list of vertices and cuts the polygon into triangles about its first corner.
void read_polygon(NumberReader& reader, const RecordField& field, TriangleMesh& mesh) {
  const std::int64_t length = reader.get(*field.list_count).integer;
  std::array<std::uint32_t, 3> triangle{};
  for (std::int64_t i = 0; i < length && reader.ok(); ++i) {
    const std::int64_t index = reader.get(field.type).integer;
    if (index < 0 || static_cast<std::uint64_t>(index) >= mesh.vertices.size()) {
      reader.refuse("a face with a vertex that is not there; write the file again");
      return;
    }
    triangle[static_cast<std::size_t>(std::min<std::int64_t>(i, 2))] =
        static_cast<std::uint32_t>(index);
    if (i < 2) continue;
    mesh.triangles.push_back(triangle);
    triangle[1] = triangle[2];
  }
}

bool is_polygon(const RecordField& field) {
  return field.list_count && !is_real(field.type) &&
         (field.name == "vertex_indices" || field.name == "vertex_index");
}

void read_faces(NumberReader& reader, const PlyElement& element, TriangleMesh& mesh) {
  std::vector<double> numbers;
  for (std::uint64_t i = 0; i < element.count && reader.ok(); ++i) {
    reader.begin_record();
    for (const RecordField& field : element.fields) {
      if (is_polygon(field)) {
        read_polygon(reader, field, mesh);
      } else if (field.list_count) {
        const std::int64_t length = reader.get(*field.list_count).integer;
        if (length > 0) reader.skip(field.type, static_cast<std::uint64_t>(length));
      } else {
        reader.skip(field.type, 1);
      }
    }
    reader.end_record();
  }
}

Status parse_mesh(std::span<const std::byte> bytes, TriangleMesh& mesh) {
  PlyHeader header;
  if (Status status = parse_ply_header(bytes, header); !status) return status;
  NumberReader reader(bytes.subspan(header.size), *header.coding, header.lines);
  bool has_faces = false;
  for (const PlyElement& element : header.elements) {
    if (element.count > kMaxElements) {
      return fail(ErrorCode::limit, "announces over 2^27 vertices or faces; give a smaller mesh");
    }
    if (element.name == "vertex") {
      const auto coordinates = find_coordinates(element);
      if (!coordinates) {
        return fail(ErrorCode::unsupported, "has vertices without x, y, z; give a mesh");
      }
      read_vertices(reader, element, *coordinates, mesh);
    } else if (element.name == "face") {
      has_faces = std::any_of(element.fields.begin(), element.fields.end(), is_polygon);
      read_faces(reader, element, mesh);
    } else if (Status status = skip_records(reader, element.fields, element.count); !status) {
      return status;
    }
    if (!reader.ok()) return tl::unexpected(reader.error());
  }
  if (!has_faces) {
    return fail(ErrorCode::unsupported, "has no faces with vertex_indices; give a mesh");
  }
  return {};
}

template <class T>
std::span<const std::byte> as_bytes_of(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

void append(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

// Faces in pieces, so that a mesh is not twice in memory.
Status write_faces(NewFile& file, const TriangleMesh& mesh) {
  constexpr std::size_t kPiece = 65'536;
  std::vector<std::byte> bytes;
  for (std::size_t begin = 0; begin < mesh.triangles.size(); begin += kPiece) {
    bytes.clear();
    const std::size_t end = std::min(mesh.triangles.size(), begin + kPiece);
    for (std::size_t i = begin; i < end; ++i) {
      bytes.push_back(std::byte{3});
      append(bytes, as_bytes_of(mesh.triangles[i]));
    }
    if (Status status = file.write(bytes); !status) return status;
  }
  return {};
}

}  // namespace

Result<TriangleMesh> read_mesh(const std::filesystem::path& file) {
  std::vector<std::byte> bytes;
  if (Status read = read_file(file, kMaxBytes, bytes); !read) return tl::unexpected(read.error());
  TriangleMesh mesh;
  if (Status status = parse_mesh(bytes, mesh); !status) {
    return fail(status.error().code, file.string() + ": " + status.error().message);
  }
  return mesh;
}

Status write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh) {
  static_assert(std::endian::native == std::endian::little, "binary_little_endian as it lies");
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) +
      "\nproperty list uchar uint vertex_indices\nend_header\n";
  auto made = NewFile::create(file);
  if (!made) return tl::unexpected(made.error());
  if (Status status = made->write(std::as_bytes(std::span(header))); !status) return status;
  if (Status status = made->write(std::as_bytes(std::span(mesh.vertices))); !status) return status;
  if (Status status = write_faces(*made, mesh); !status) return status;
  return made->commit(false);
}

}  // namespace sweepcast::lab
