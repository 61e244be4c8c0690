// Sweeps fused into surfaces that are known.
#include "lab/mesh/tsdf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "lab/mesh/marching_cubes.hpp"
#include "lab/mesh/mesh_error.hpp"
#include "lab/mesh/seen_space.hpp"

namespace sweepcast::lab {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

TEST(CubeCase, CutsEveryEdgeThatChangesSidesAndNoOther) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    std::set<std::size_t> cut, used;
    for (std::size_t i = 0; i < kCubeEdges; ++i) {
      const unsigned begin = kCubeEdge[i].begin, end = begin | (1U << kCubeEdge[i].axis);
      if (((inside >> begin) & 1U) != ((inside >> end) & 1U)) cut.insert(i);
    }
    const CubeCase& cube = cube_case(static_cast<std::uint8_t>(inside));
    for (std::size_t i = 0; i < cube.count; ++i) {
      used.insert(cube.triangles[i].begin(), cube.triangles[i].end());
    }
    EXPECT_EQ(cut, used) << inside;
  }
  EXPECT_EQ(cube_case(1).count, 1);
  EXPECT_EQ(cube_case(0x0F).count, 2);        // a plane
  EXPECT_EQ(cube_case(0b01101001).count, 4);  // every other corner
}

// Ends spread evenly over a sphere, seen from its middle.
std::vector<Ray> sphere_from_within(double radius, int count, const Eigen::Vector3d& middle) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, turn = 2.39996322972865332 * i;
    const double rho = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d direction(rho * std::cos(turn), rho * std::sin(turn), z);
    rays.push_back({middle, middle + radius * direction});
  }
  return rays;
}

TriangleMesh fuse(std::span<const Ray> rays, const TsdfOptions& options = {}, int weight = 1) {
  auto volume = TsdfVolume::create(options);
  EXPECT_TRUE(volume) << volume.error().message;
  volume->add(rays);
  return volume->surface(weight);
}

TEST(TsdfVolume, ASphereSeenFromWithinIsClosedAndOfItsSize) {
  constexpr double kRadius = 2.0;
  const Eigen::Vector3d middle(-3.03, 0.51, 7.77);
  const TriangleMesh mesh = fuse(sphere_from_within(kRadius, 60'000, middle));
  std::map<Edge, int> edges;
  double volume = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    volume += (mesh.corner(i, 0) - middle)
                  .dot((mesh.corner(i, 1) - middle).cross(mesh.corner(i, 2) - middle)) /
              6.0;
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U) << "a hole";
  }
  // Solid is what lies beyond the ends, so the surface faces the sensor.
  EXPECT_NEAR(volume, -4.0 / 3.0 * M_PI * std::pow(kRadius, 3), 0.3);
  for (const auto& vertex : mesh.vertices) {
    EXPECT_NEAR((vertex.cast<double>() - middle).norm(), kRadius, 0.02);
  }
}

// Rays from 10 m above onto the ground at height `noise` about 0, 2 x 2 m, every 2 cm.
std::vector<Ray> ground(double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> height(0.0, 1.0);
  std::vector<Ray> rays;
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 100; ++k) {
      const double z = noise * height(random);
      rays.push_back({{1.0, 1.0, 10.0}, {0.02 * i, 0.02 * k, z + 0.013}});
    }
  }
  return rays;
}

TEST(TsdfVolume, AveragesNoiseAway) {
  auto volume = TsdfVolume::create({});
  ASSERT_TRUE(volume);
  for (unsigned sweep = 0; sweep < 20; ++sweep) volume->add(ground(0.03, sweep));
  const TriangleMesh mesh = volume->surface(20);
  ASSERT_GT(surface_area(mesh), 3.2);
  double sum = 0.0;
  for (const auto& vertex : mesh.vertices) {
    const bool is_inner = (vertex.head<2>().array() - 1.0F).abs().maxCoeff() < 0.8F;
    EXPECT_NEAR(vertex.z(), 0.013F, is_inner ? 0.015F : 0.05F);  // few rays meet at the rim
    sum += static_cast<double>(vertex.z());
  }
  EXPECT_NEAR(sum / static_cast<double>(mesh.vertices.size()), 0.013, 0.003);
}

TEST(TsdfVolume, ClosesGapsOfOneCubeAndNoWiderOnes) {
  // Rows of rays straight down, every 1 cm along y, `gap` metres apart along x.
  const auto area = [](double gap) {
    std::vector<Ray> rays;
    for (double x = 0.05; x < 2.0; x += gap) {
      for (double y = 0.0; y < 2.0; y += 0.01) rays.push_back({{x, y, 10.0}, {x, y, 0.013}});
    }
    return surface_area(fuse(rays));
  };
  EXPECT_GT(area(0.1), 3.2);
  EXPECT_GT(area(0.2), 3.2);
  EXPECT_EQ(area(0.4), 0.0);
}

TEST(TsdfVolume, LeavesOutWhatTooFewRaysHaveSeen) {
  const auto rays = ground(0.0, 1);
  EXPECT_GT(surface_area(fuse(rays)), 3.2);
  EXPECT_EQ(surface_area(fuse(rays, {}, 100)), 0.0);
}

TEST(TsdfVolume, CarvesWhatRaysPassThrough) {
  auto rays = ground(0.0, 1);
  std::vector<Ray> passer_by;
  for (const Ray& ray : rays)
    passer_by.push_back({ray.origin, ray.origin + 0.85 * (ray.end - ray.origin)});
  const auto area_above = [&](bool carve) {
    TsdfOptions options;
    options.carve = carve;
    auto volume = TsdfVolume::create(options);
    EXPECT_TRUE(volume);
    volume->add(passer_by);
    for (int i = 0; i < 5; ++i) volume->add(rays);
    TriangleMesh mesh = volume->surface();
    std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.vertices[t[0]].z() < 0.5F; });
    return surface_area(mesh);
  };
  EXPECT_GT(area_above(false), 2.4);
  EXPECT_LT(area_above(true), 0.1);
}

TEST(TsdfVolume, DoesNotFollowRaysBeyondItsGrid) {
  auto volume = TsdfVolume::create({});
  ASSERT_TRUE(volume);
  const double nan = std::nan("");
  const std::vector<Ray> rays{{{0, 0, 0}, {1e30, 0, 0}},
                              {{0, 0, 0}, {0, 0, 0}},
                              {{0, 0, 0}, {nan, 1, 1}},
                              {{nan, 0, 0}, {1, 1, 1}}};
  const std::size_t before = volume->memory_bytes();
  volume->add(rays);
  EXPECT_EQ(volume->memory_bytes(), before);
  EXPECT_TRUE(volume->surface().triangles.empty());
}

TEST(TsdfVolume, RefusesOptionsOutOfRange) {
  TsdfOptions options;
  options.voxel_m = 0.0;
  EXPECT_EQ(TsdfVolume::create(options).error().code, ErrorCode::invalid_argument);
  options = {};
  options.truncation_voxels = std::nan("");
  EXPECT_EQ(TsdfVolume::create(options).error().code, ErrorCode::invalid_argument);
}

TEST(SeenSpace, IsWhatLiesAboutEnds) {
  SeenSpace seen(0.1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-5.0, 5.0);
  std::vector<Ray> rays;
  for (int i = 0; i < 300; ++i) {
    rays.push_back({{0, 0, 0}, {coordinate(random), coordinate(random), coordinate(random)}});
  }
  seen.add(rays);
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d offset(coordinate(random), coordinate(random), coordinate(random));
    const Eigen::Vector3d place = rays[static_cast<std::size_t>(i % 300)].end + 0.06 * offset;
    double nearest = 1e9;
    for (const Ray& ray : rays) nearest = std::min(nearest, (ray.end - place).norm());
    const bool is_seen = seen.is_seen(place);
    EXPECT_TRUE(is_seen || nearest > 0.1) << nearest;
    EXPECT_TRUE(!is_seen || nearest < 0.35) << nearest;
  }
}

TEST(RaysOf, StartWhereTheSensorWasAtEachFiring) {
  // It drove 2 m along x, and turned by a quarter to the left while it did.
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = Eigen::Vector3d(2.0, 0.0, 0.0);
  pose.rotate(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  const std::vector<RigidTransform> poses{RigidTransform::Identity(), pose};
  PointCloud cloud;
  cloud.x = {5.0F, 5.0F, 1.0F, std::nanf(""), 100.0F};
  cloud.y = cloud.z = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  const std::vector<float> when{0.0F, 1.0F, 1.0F, 0.0F, 0.5F};
  std::vector<Ray> rays;
  rays_of(cloud, when, poses[1], motion_during(poses, 1), {}, rays);
  ASSERT_EQ(rays.size(), 2U);
  EXPECT_TRUE(rays[0].origin.isApprox(Eigen::Vector3d(0, 0, 0), 1e-9) ||
              rays[0].origin.norm() < 1e-9);
  EXPECT_TRUE(rays[0].end.isApprox(Eigen::Vector3d(5, 0, 0), 1e-6));
  EXPECT_TRUE(rays[1].origin.isApprox(Eigen::Vector3d(2, 0, 0), 1e-6));
  EXPECT_TRUE(rays[1].end.isApprox(Eigen::Vector3d(2, 5, 0), 1e-6));
  rays_of(cloud, {}, poses[1], motion_during(poses, 1), {}, rays);
  EXPECT_TRUE(rays[0].end.isApprox(Eigen::Vector3d(2, 5, 0), 1e-6));
}

}  // namespace
}  // namespace sweepcast::lab
