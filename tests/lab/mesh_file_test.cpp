// Meshes in files: what was written comes back, whatever the kind of PLY, and damage is an error.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "lab/mesh/triangle_mesh.hpp"

namespace sweepcast::lab {
namespace {

class MeshFile : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Result<TriangleMesh> read(const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return read_mesh(file_);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("sweepcast-mesh-file-" + std::to_string(getpid()));
  std::filesystem::path file_ = folder_ / "mesh.ply";
};

const std::string kVertices =
    "property float x\nproperty float y\nproperty double z\nproperty uchar red\n";
const std::string kFace = "element face 1\nproperty list uchar int vertex_index\nend_header\n";

std::string header(int vertices) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) + "\n" + kVertices +
         kFace;
}

TEST_F(MeshFile, ComesBackAsWritten) {
  const TriangleMesh mesh{{{0, 0, 0}, {1.5F, 0, 0}, {0, 2.25F, -3}, {1e-7F, 4, 5}},
                          {{0, 1, 2}, {3, 2, 1}}};
  ASSERT_TRUE(write_mesh(file_, mesh));
  const auto again = read_mesh(file_);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->vertices, mesh.vertices);
  EXPECT_EQ(again->triangles, mesh.triangles);
}

TEST_F(MeshFile, CutsPolygonsIntoTriangles) {
  const auto mesh = read(header(4) + "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0.5 9\n4 0 1 2 3\n");
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->triangles.size(), 2U);
  EXPECT_EQ(mesh->triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(mesh->triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_FLOAT_EQ(mesh->vertices[3].z(), 0.5F);
}

TEST_F(MeshFile, RefusesWhatIsDamaged) {
  EXPECT_EQ(read(header(3) + "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 3\n").error().code,
            ErrorCode::corrupt);
  EXPECT_EQ(read(header(3) + "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 -1\n").error().code,
            ErrorCode::corrupt);
  EXPECT_EQ(read(header(3) + "0 0 0 9\n1 0 nan 9\n0 1 0 9\n3 0 1 2\n").error().code,
            ErrorCode::corrupt);
  EXPECT_EQ(read(header(3) + "0 0 0 9\n1 0 0 9\n").error().code, ErrorCode::truncated);
  EXPECT_EQ(read(header(300'000'000) + "0 0 0 9\n").error().code, ErrorCode::limit);
  const auto cloud =
      read("ply\nformat ascii 1.0\nelement vertex 1\n" + kVertices + "end_header\n0 0 0 0\n");
  EXPECT_EQ(cloud.error().code, ErrorCode::unsupported);
  EXPECT_NE(cloud.error().message.find("mesh.ply: "), std::string::npos);
  EXPECT_EQ(read_mesh(folder_ / "none.ply").error().code, ErrorCode::not_found);
}

TEST_F(MeshFile, RefusesEveryTruncation) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  ASSERT_TRUE(write_mesh(file_, mesh));
  for (auto size = std::filesystem::file_size(file_); size-- > 0;) {
    std::filesystem::resize_file(file_, size);
    EXPECT_FALSE(read_mesh(file_)) << size << " bytes";
  }
}

}  // namespace
}  // namespace sweepcast::lab
