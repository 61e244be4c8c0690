// The small sweeps and options that golden frames were made of, and the checksum of a cloud.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/scene.hpp"
#include "core/bytes.hpp"
#include "core/crc32.hpp"
#include "cross/made_sweeps.hpp"

namespace sweepcast::test {

struct GoldenSource {
  std::string name;
  EncoderOptions options;
  PointCloud cloud;
};

/// New ones go at the end; see README.md.
inline std::vector<GoldenSource> golden_sources() {
  std::vector<GoldenSource> sources;
  const auto add = [&](const char* name, const PointCloud& cloud, auto change) {
    EncoderOptions options;
    options.codec = CodecId::rcpcc;
    change(options.rcpcc);
    sources.push_back({name, options, cloud});
  };
  const PointCloud sweep = street(16, 180);
  PointCloud one;
  add_point(one, 3, -4, 0.5);
  add("empty", {}, [](RcpccOptions&) {});
  add("one_point", one, [](RcpccOptions&) {});
  add("default", sweep, [](RcpccOptions&) {});
  add("level0", sweep, [](RcpccOptions& o) { o.params = kRcpccLevels[0]; });
  add("level5", sweep, [](RcpccOptions& o) { o.params = kRcpccLevels[5]; });
  add("plane_8x8", sweep, [](RcpccOptions& o) {
    o.params = {2, 1, 0.2, 0.1};
    o.model = SurfaceModel::plane;
    o.block_size = 8;
    o.region_size = 8;
  });
  add("large_blocks_truncated", sweep, [](RcpccOptions& o) {
    o.block_size = 16;
    o.region_size = 32;
    o.rounding = Rounding::truncate;
  });
  add("raw_unfit", sweep, [](RcpccOptions& o) {
    o.params = {4, 2, 0.1, 0.2};
    o.unfit = UnfitCoding::raw;
  });
  add("across_the_seam", sweep, [](RcpccOptions& o) {
    o.azimuth_min_deg = 100;
    o.azimuth_max_deg = -100;
    o.elevation_min_deg = -20;
    o.elevation_max_deg = 5;
    o.collision = CollisionRule::nearest_range;
    o.region_size = 16;
    o.zstd_level = 19;
  });
  const auto add_beam = [&](const char* name, const MadeSweep& make, auto change) {
    EncoderOptions options;
    options.codec = CodecId::beam;
    change(options.beam);
    sources.push_back({name, options, made_sweep(make)});
  };
  const MadeSweep spinning;
  const MadeSweep rich{.firings = 180, .seed = 2, .second_returns = 40, .attributes = true};
  add_beam("beam_fast", spinning, [](BeamOptions& o) { o.effort = Effort::fast; });
  add_beam("beam_normal", spinning, [](BeamOptions&) {});
  add_beam("beam_best", spinning, [](BeamOptions& o) { o.effort = Effort::best; });
  add_beam("beam_level2", spinning, [](BeamOptions& o) { o.level = 2; });
  add_beam("beam_level5_fast", spinning, [](BeamOptions& o) {
    o.level = 5;
    o.effort = Effort::fast;
  });
  add_beam("beam_jitter", {.firings = 160, .jitter_deg = 0.2}, [](BeamOptions& o) {
    o.max_error_m = 0.1;
    o.effort = Effort::fast;
  });
  add_beam("beam_deskewed", {.beams = 24, .firings = 360, .deskewed = true},
           [](BeamOptions& o) { o.max_error_m = 0.05; });
  add_beam("beam_attributes", rich, [](BeamOptions& o) { o.intensity_step = 20; });
  add_beam("beam_attributes_fast", rich, [](BeamOptions& o) {
    o.effort = Effort::fast;
    o.intensity_step = 20;
    o.keep_order = true;
  });
  add_beam("beam_attributes_best", rich, [](BeamOptions& o) {
    o.effort = Effort::best;
    o.intensity_step = 20;
  });
  add_beam("beam_lossless", {.beams = 8, .firings = 180, .millimetres = true},
           [](BeamOptions& o) { o.lossless = true; });
  add_beam("beam_organised", {.organised = true}, [](BeamOptions& o) { o.keep_order = true; });
  EncoderOptions octree;
  octree.codec = CodecId::beam;
  sources.push_back({"beam_octree", octree, made_scatter(200, 1)});
  add_beam("beam_crowded", {.firings = 160, .jitter_deg = 0.2},
           [](BeamOptions& o) { o.max_error_m = 0.1; });
  add_beam("beam_deep", spinning, [](BeamOptions& o) { o.effort = Effort::best; });
  return sources;
}

/// CRC-32 of the coordinates' bits: x, y, z of each point, little-endian.
inline std::uint32_t checksum_of(const PointCloud& cloud) {
  Bytes bytes;
  ByteWriter out(bytes);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (const float value : {cloud.x[i], cloud.y[i], cloud.z[i]}) {
      const bool missing = value != value;  // NaNs differ from machine to machine
      out.put(missing ? 0x7FC00000U : std::bit_cast<std::uint32_t>(value));
    }
  }
  return crc32(bytes);
}

/// CRC-32 of the other columns: intensity, ring, time, and the width, little-endian.
inline std::uint32_t attributes_checksum_of(const PointCloud& cloud) {
  Bytes bytes;
  ByteWriter out(bytes);
  for (const float value : cloud.intensity) out.put(std::bit_cast<std::uint32_t>(value));
  for (const std::uint16_t ring : cloud.ring) out.put(ring);
  for (const std::int64_t time : cloud.time_ns) out.put(time);
  out.put(cloud.width);
  return crc32(bytes);
}

}  // namespace sweepcast::test
