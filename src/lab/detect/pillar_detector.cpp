#include <torch/types.h>
#include <torch/utils.h>

#include <exception>
#include <string>
#include <utility>

#include "lab/detect/anchors.hpp"
#include "lab/detect/detector.hpp"
#include "lab/detect/pillar_network.hpp"

namespace sweepcast::lab {

namespace {

constexpr float kLeastScore = 0.1F;
constexpr double kMostOverlap = 0.1;  // cars stand side by side, not in each other

// Boxes of the anchors that score, in a batch of one sweep.
std::vector<Box> boxes_of(const PillarOutput& output) {
  const torch::Tensor scores = torch::sigmoid(output.logits).contiguous();
  const torch::Tensor residuals = output.residuals.contiguous();
  const torch::Tensor directions = output.directions.contiguous();
  const float* score = scores.data_ptr<float>();
  const float* residual = residuals.data_ptr<float>();
  const float* direction = directions.data_ptr<float>();
  std::vector<Box> boxes;
  for (int index = 0; index < kAnchors; ++index) {
    const auto i = static_cast<std::size_t>(index);
    if (!(score[i] >= kLeastScore)) continue;
    const std::span<const float, kResiduals> own(residual + i * kResiduals, kResiduals);
    const bool backward = direction[2 * i + 1] > direction[2 * i];
    boxes.push_back(decode_box(index, own, backward, static_cast<double>(score[i])));
  }
  return boxes;
}

class PillarDetector : public Detector {
 public:
  explicit PillarDetector(PillarNetwork network) : network_(std::move(network)) {
    network_->eval();
  }

  Result<std::vector<Box>> detect(const PointCloud& cloud) override try {
    const Pillars pillars = make_pillars(cloud.x, cloud.y, cloud.z);
    if (pillars.cell.empty()) return std::vector<Box>();
    const torch::NoGradGuard frozen;
    const PillarOutput output = network_->forward(make_batch(std::span(&pillars, 1)));
    std::vector<Box> boxes = suppress_overlaps(boxes_of(output), kMostOverlap);
    count_points(cloud, boxes);
    return boxes;
  } catch (const std::exception& error) {  // libtorch throws, as where memory runs out
    return fail(ErrorCode::limit, std::string("detect: libtorch gave up (") + error.what() +
                                      "); give it more memory");
  }

 private:
  PillarNetwork network_;
};

}  // namespace

Result<std::unique_ptr<Detector>> make_pillar_detector(const std::filesystem::path& weights) try {
  PillarNetwork network;
  if (Status read = read_weights(weights, network); !read) return tl::unexpected(read.error());
  return std::make_unique<PillarDetector>(std::move(network));
} catch (const std::exception& error) {
  return fail(ErrorCode::limit,
              std::string("detect: libtorch gave up (") + error.what() + "); give it more memory");
}

}  // namespace sweepcast::lab
