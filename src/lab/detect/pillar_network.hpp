// PointPillars' network on libtorch (Lang et al., PointPillars, CVPR 2019, 2): pillar features, a
// 2-D backbone, an anchor head. Only the files that need libtorch include this.
#pragma once

#include <torch/nn/module.h>
#include <torch/nn/modules/batchnorm.h>
#include <torch/nn/modules/container/sequential.h>
#include <torch/nn/modules/conv.h>

#include <filesystem>
#include <span>
#include <vector>

#include "lab/detect/pillars.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Sweeps as tensors: N points on P pillars, those of all sweeps after each other.
struct PillarBatch {
  torch::Tensor features;  ///< N x kPointFeatures
  torch::Tensor owner;     ///< N: index of a point's pillar
  torch::Tensor cell;      ///< P: (sweep * kSide + row) * kSide + column
  std::int64_t sweeps = 0;
};

[[nodiscard]] PillarBatch make_batch(std::span<const Pillars> sweeps);

/// What the network says; anchors in the order of anchors.hpp.
struct PillarOutput {
  torch::Tensor logits;      ///< sweeps x kAnchors: the score before the sigmoid
  torch::Tensor residuals;   ///< sweeps x kAnchors x kResiduals
  torch::Tensor directions;  ///< sweeps x kAnchors x 2: forward, backward, before the softmax
};

class PillarNetworkImpl : public torch::nn::Module {
 public:
  PillarNetworkImpl();
  PillarOutput forward(const PillarBatch& batch);

 private:
  torch::nn::Conv2d point_layer_;
  torch::nn::BatchNorm2d point_norm_;
  std::vector<torch::nn::Sequential> down_;  ///< the backbone's blocks, each at half the resolution
  std::vector<torch::nn::Sequential> up_;    ///< back to the resolution of the first
  torch::nn::Conv2d head_;
};
TORCH_MODULE(PillarNetwork);

/// Weights as they are filed: a head, and float32 numbers in the network's own order.
/// Errors: io; and for reading not_found, corrupt, truncated, unsupported (of another network).
[[nodiscard]] Status write_weights(const std::filesystem::path& file, PillarNetwork& network);
[[nodiscard]] Status read_weights(const std::filesystem::path& file, PillarNetwork& network);

}  // namespace sweepcast::lab
