#include "lab/simulate/town.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sweepcast::lab {
namespace {

constexpr double kBuildingLine = kBlockHalf - 3.0;  // from a block's middle to its facades
constexpr double kDepth = 11.0;                     // of houses
constexpr double kStraight = 24.0;  // houses but the corner ones stand within this, to both sides
constexpr double kChamfer = 5.0;

// One side of a block, seen from its street: x to the right along the kerb, y into the block, both
// from the middle of the side's kerb.
class BlockSide {
 public:
  BlockSide(Town& town, Random& random, Vec3 middle, int side, bool detailed)
      : town_(town), random_(random), detailed_(detailed) {
    constexpr std::array<double, 4> kCos{1.0, 0.0, -1.0, 0.0};
    const auto turn = static_cast<std::size_t>(side);
    cos_ = kCos[turn];
    sin_ = kCos[(turn + 3) % 4];
    kerb_ = upright(middle, cos_, sin_).apply({0.0, -kBlockHalf, 0.0});
  }

  void build() {
    add_row();
    add_corner_house();
    if (!detailed_) return;
    add_trees();
    add_street_furniture();
    add_parked_cars();
  }

 private:
  // A builder whose frame stands at (x, y) of this side, on the block or on the road.
  MeshBuilder at(double x, double y, double lift = kKerbHeight, bool reversed = false) {
    Pose frame = upright(kerb_, cos_, sin_);
    frame.origin = frame.apply({x, y, 0.0});
    frame.origin.z = town_.terrain.height(frame.origin.x, frame.origin.y) + lift;
    if (reversed) frame = {frame.x * -1.0, frame.y * -1.0, frame.z, frame.origin};
    return {town_.mesh, frame, {}};
  }

  // Houses, and now and then a garden behind a fence or a hedge.
  void add_row() {
    const double front = kBlockHalf - kBuildingLine;
    double x = -kStraight;
    while (x < kStraight - 4.0) {
      const double width = std::min(random_.uniform(8.0, 16.0), kStraight - x);
      if (random_.chance(0.16)) {
        add_garden(x, std::min(width, 9.0), front);
        x += std::min(width, 9.0);
        continue;
      }
      const double setback = random_.chance(0.3) ? random_.uniform(0.5, 2.5) : 0.0;
      add_standing_house(x, front + setback,
                         {width, kDepth, 0.0, 1.5, 2 + random_.below(4), detailed_});
      x += width;
    }
  }

  void add_standing_house(double x, double y, const House& house) {
    MeshBuilder builder = at(x, y);
    // Floors are level: at the height of the street in the middle of the front.
    builder.frame.origin.z = at(x + 0.5 * house.width, y).frame.origin.z + 0.1;
    add_house(builder, house, random_);
  }

  void add_garden(double x, double width, double y) {
    if (detailed_) {
      if (random_.chance(0.5)) {
        add_hedge(at(x, y), width, random_);
      } else {
        add_fence(at(x, y), width, random_);
      }
      const double along = random_.uniform(0.3, 0.7);
      add_tree(at(x + along * width, y + random_.uniform(3.5, 7.0)), random_);
      for (int i = 0; i < 3; ++i) {
        const double beside = random_.uniform(0.1, 0.9);
        add_bush(at(x + beside * width, y + random_.uniform(1.5, 9.0)), random_);
      }
    }
    MeshBuilder back = at(x, y + kDepth);  // the garden's end: another house's plain wall
    back.surface = {Material::matt, 38, 0};
    back.quad({0, 0, -1.5}, {width, 0, -1.5}, {width, 0, 5.0}, {0, 0, 5.0});
  }

  // Each side owns the corner at its right end.
  void add_corner_house() {
    const double width = kBuildingLine - kStraight;
    add_standing_house(kStraight, kBlockHalf - kBuildingLine,
                       {width, width, kChamfer, 1.5, 3 + random_.below(3), detailed_});
  }

  void add_trees() {
    if (random_.chance(0.3)) return;  // a street without
    for (double x = -22.0; x < 22.0; x += random_.uniform(7.0, 13.0)) {
      add_tree(at(x, 0.8), random_);
    }
  }

  void add_street_furniture() {
    add_lamp(at(random_.uniform(-17.0, -13.0), 0.55), random_);
    add_lamp(at(random_.uniform(10.0, 15.0), 0.55), random_);
    // Traffic keeps right: on the side's own lane it runs towards -x.
    for (double x : {-12.0, 5.0, 21.0}) {
      if (random_.chance(0.7)) {
        add_sign(at(x + random_.uniform(-4.0, 4.0), 0.4, kKerbHeight, true), random_);
      };
    }
    if (random_.chance(0.5)) add_traffic_light(at(-kStraight - 0.5, 0.6, kKerbHeight, true));
    for (int i = 0; i < 4; ++i) add_bollard(at(kStraight + 0.5 + 1.3 * i, 0.4 + 0.18 * i * i));
    for (int i = 0; i < 3; ++i) {
      const double x = random_.uniform(-21.0, 21.0);
      add_furniture(at(x, random_.uniform(2.0, 2.5)), random_);
    }
  }

  // Along the kerb, in the driving direction of the side's own lane.
  void add_parked_cars() {
    for (double x = -18.0; x < 19.0; x += random_.uniform(5.7, 6.4)) {
      if (!random_.chance(0.6)) continue;
      MeshBuilder builder = at(x, random_.uniform(-1.15, -1.05), 0.0, true);
      const Pose middle = builder.frame;
      builder.frame = on_slope(middle);
      builder.surface.object = static_cast<std::uint16_t>(town_.parked.size() + 1);
      const Extent extent = add_car(builder, random_);
      town_.parked.push_back({extent, builder.frame});
    }
  }

  // Tilted as the road under a car's four wheels.
  [[nodiscard]] Pose on_slope(const Pose& level) const {
    const auto ground = [&](double forward, double left) {
      Vec3 p = level.apply({forward, left, 0.0});
      p.z = town_.terrain.height(p.x, p.y);
      return p;
    };
    Pose pose = level;
    pose.x = normalized(ground(1.3, 0.0) - ground(-1.3, 0.0));
    pose.z = normalized(cross(pose.x, ground(0.0, 0.8) - ground(0.0, -0.8)));
    pose.y = cross(pose.z, pose.x);
    return pose;
  }

  Town& town_;
  Random& random_;
  bool detailed_;
  double cos_ = 1.0;
  double sin_ = 0.0;
  Vec3 kerb_;
};

}  // namespace

Town build_town(std::uint64_t seed) {
  Town town{Terrain(Random(seed, 1)), {}, {}};
  const MeshBuilder world{town.mesh};
  add_carriageways(world, town.terrain);
  for (int j = kFirstBlock; j <= kLastBlock; ++j) {
    for (int i = kFirstBlock; i <= kLastBlock; ++i) {
      const Vec3 middle{(i + 0.5) * kPitch, (j + 0.5) * kPitch, 0.0};
      const auto number =
          static_cast<std::uint64_t>(j + 8) * 16 + static_cast<std::uint64_t>(i + 8);
      Random random(seed, 2, number);
      add_block_ground(world, town.terrain, middle.x, middle.y, random);
      // The loop passes blocks -1 to 2; from there the others are seen end on, far away.
      const bool detailed = std::min(i, j) >= -1 && std::max(i, j) <= 2;
      for (int side = 0; side < 4; ++side) {
        BlockSide(town, random, middle, side, detailed).build();
      }
      if (!detailed) continue;
      add_markings(world, town.terrain, i * kPitch, j * kPitch, true);
      add_markings(world, town.terrain, i * kPitch, j * kPitch, false);
    }
  }
  return town;
}

}  // namespace sweepcast::lab
