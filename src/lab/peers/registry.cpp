#include "lab/peers/registry.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "lab/peers/draco.hpp"
#include "lab/peers/gpcc.hpp"
#include "lab/peers/j2k.hpp"
#include "lab/peers/jpegls.hpp"
#include "lab/peers/pcl_octree.hpp"
#include "lab/peers/zstd_grid.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::array<PeerKind, 8> kKinds{{
    {"draco", "Google's Draco, kd-tree", draco_ladder},
    {"pcl", "the Point Cloud Library's octree", pcl_octree_ladder},
    {"gpcc", "MPEG's G-PCC, octree, by its program tmc3", gpcc_ladder},
    {"j2k", "JPEG 2000 on a range image, a row a beam, with a mask", j2k_ladder},
    {"j2k-naive", "JPEG 2000 on a range image of equal angles, without a mask", j2k_naive_ladder},
    {"jpegls", "JPEG-LS on a range image, a row a beam, with a mask", jpegls_ladder},
    {"zstd", "a grid of steps in Morton order, zstd", zstd_morton_ladder},
    {"zstd-delta", "a grid of steps in the order given, differences, zstd", zstd_delta_ladder},
}};

bool is_kind(const std::string& name) {
  return std::any_of(kKinds.begin(), kKinds.end(),
                     [&](const PeerKind& kind) { return kind.name == name; });
}

bool is_absence(const Error& error) {
  return error.code == ErrorCode::unsupported || error.code == ErrorCode::not_found;
}

}  // namespace

std::span<const PeerKind> peer_kinds() {
  return kKinds;
}

Result<PeerChoice> make_peers(std::span<const std::string> names) {
  const auto chosen = [&](std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const std::string& name : names) {
    if (name == "all" || is_kind(name)) continue;
    std::string known = "all";
    for (const PeerKind& kind : kKinds) known.append(", ").append(kind.name);
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: no such codec; give some of {}", name, known));
  }
  PeerChoice choice;
  for (const PeerKind& kind : kKinds) {
    if (!chosen("all") && !chosen(kind.name)) continue;
    auto ladder = kind.ladder();
    if (ladder) {
      std::move(ladder->begin(), ladder->end(), std::back_inserter(choice.peers));
    } else if (!chosen(kind.name) && is_absence(ladder.error())) {
      choice.left_out.push_back(std::move(ladder.error().message));
    } else {
      return tl::unexpected(std::move(ladder.error()));
    }
  }
  return choice;
}

}  // namespace sweepcast::lab
