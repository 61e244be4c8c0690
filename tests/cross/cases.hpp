// Sweeps and options that between them use all that codec `beam` has, and some of codec `rcpcc`.
#pragma once

#include <string>
#include <vector>

#include "cross/made_sweeps.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::test {

struct CrossCase {
  std::string name;
  EncoderOptions options;
  std::vector<PointCloud> sweeps;
};

/// Two sweeps of a kind: the second stands elsewhere and has other noise.
inline std::vector<PointCloud> two_sweeps(MadeSweep make) {
  std::vector<PointCloud> sweeps{made_sweep(make)};
  make.shift_m += 0.5;
  ++make.seed;
  sweeps.push_back(made_sweep(make));
  return sweeps;
}

inline std::vector<CrossCase> cross_cases() {
  std::vector<CrossCase> cases;
  const auto add = [&](const char* name, const std::vector<PointCloud>& sweeps, auto change) {
    EncoderOptions options;
    options.codec = CodecId::beam;
    change(options.beam);
    cases.push_back({name, options, sweeps});
  };
  const auto plain = two_sweeps({});
  add("fast", plain, [](BeamOptions& o) { o.effort = Effort::fast; });
  add("fine", plain, [](BeamOptions& o) { o.max_error_m = 0.002; });
  add("best", plain, [](BeamOptions& o) { o.effort = Effort::best; });
  add("coarse best", plain, [](BeamOptions& o) {
    o.max_error_m = 0.5;
    o.effort = Effort::best;
  });
  add("level 2 fast", plain, [](BeamOptions& o) {
    o.level = 2;
    o.effort = Effort::fast;
  });
  add("level 3", plain, [](BeamOptions& o) { o.level = 3; });
  add("level 5 best", plain, [](BeamOptions& o) {
    o.level = 5;
    o.effort = Effort::best;
  });
  const auto jitter = two_sweeps({.seed = 5, .jitter_deg = 0.2});
  add("jitter", jitter, [](BeamOptions& o) { o.effort = Effort::fast; });
  add("crowded", jitter, [](BeamOptions&) {});
  add("deskewed", two_sweeps({.beams = 24, .firings = 360, .seed = 7, .deskewed = true}),
      [](BeamOptions& o) { o.max_error_m = 0.02; });

  const auto rich = two_sweeps({.seed = 9, .second_returns = 9, .attributes = true});
  add("attributes", rich, [](BeamOptions& o) { o.level = 4; });
  add("intensity step", rich, [](BeamOptions& o) {
    o.effort = Effort::best;
    o.fields = Fields::xyzi;
    o.intensity_step = 2.5;
  });
  add("lossless", rich, [](BeamOptions& o) {
    o.lossless = true;
    o.keep_order = true;
  });
  add("rings in order", two_sweeps({.seed = 11, .by_rings = true, .attributes = true}),
      [](BeamOptions& o) { o.keep_order = true; });
  add("organised", two_sweeps({.seed = 13, .organised = true}),
      [](BeamOptions& o) { o.keep_order = true; });
  add("octree", {made_scatter(300, 3), made_scatter(200, 4)}, [](BeamOptions&) {});
  add("empty", {PointCloud{}}, [](BeamOptions&) {});

  CrossCase range_image{"rcpcc", {}, plain};
  range_image.options.codec = CodecId::rcpcc;
  cases.push_back(range_image);
  range_image.name = "rcpcc planes";
  range_image.options.rcpcc.model = SurfaceModel::plane;
  range_image.options.rcpcc.region_size = 16;
  cases.push_back(range_image);
  return cases;
}

}  // namespace sweepcast::test
