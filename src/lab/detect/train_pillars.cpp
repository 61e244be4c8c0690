#include "lab/detect/train_pillars.hpp"

#include <ATen/Parallel.h>
#include <torch/nn/functional/loss.h>
#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adamw.h>
#include <torch/types.h>
#include <torch/utils.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "io/file.hpp"
#include "lab/detect/pillar_network.hpp"

namespace sweepcast::lab {

namespace {

namespace F = torch::nn::functional;

// What the network is to say of a batch.
struct BatchTargets {
  torch::Tensor state;      ///< sweeps x kAnchors: 1, 0 or -1
  torch::Tensor positive;   ///< indices into all anchors of the batch
  torch::Tensor residuals;  ///< of the positive ones
  torch::Tensor backward;
};

BatchTargets join(std::span<const Example> examples) {
  std::vector<float> state, residuals;
  std::vector<std::int64_t> positive, backward;
  for (std::size_t b = 0; b < examples.size(); ++b) {
    const AnchorTargets& targets = examples[b].targets;
    state.insert(state.end(), targets.state.begin(), targets.state.end());
    residuals.insert(residuals.end(), targets.residuals.begin(), targets.residuals.end());
    backward.insert(backward.end(), targets.backward.begin(), targets.backward.end());
    for (const std::int64_t index : targets.positive) {
      positive.push_back(static_cast<std::int64_t>(b) * kAnchors + index);
    }
  }
  return {torch::tensor(state).view({-1, kAnchors}), torch::tensor(positive, torch::kInt64),
          torch::tensor(residuals).view({static_cast<std::int64_t>(backward.size()), kResiduals}),
          torch::tensor(backward, torch::kInt64)};
}

// Focal loss (Lin et al., Focal loss for dense object detection, ICCV 2017), summed.
torch::Tensor focal_loss(const torch::Tensor& logits, const torch::Tensor& state) {
  constexpr double kAlpha = 0.25;
  const torch::Tensor wanted = state.clamp_min(0.0);
  const torch::Tensor p = torch::sigmoid(logits);
  const torch::Tensor miss = wanted * (1.0 - p) + (1.0 - wanted) * p;
  const torch::Tensor weight = wanted * kAlpha + (1.0 - wanted) * (1.0 - kAlpha);
  const torch::Tensor entropy = F::binary_cross_entropy_with_logits(
      logits, wanted, F::BinaryCrossEntropyWithLogitsFuncOptions().reduction(torch::kNone));
  return ((state >= 0.0) * weight * miss.square() * entropy).sum();
}

torch::Tensor loss_of(const PillarOutput& output, const BatchTargets& targets) {
  constexpr double kBoxWeight = 2.0;
  constexpr double kDirectionWeight = 0.2;
  constexpr double kBend = 1.0 / 9.0;  // where smooth L1 turns from square to straight
  const auto count = static_cast<double>(std::max<std::int64_t>(1, targets.positive.size(0)));
  torch::Tensor loss = focal_loss(output.logits, targets.state) / count;
  if (targets.positive.size(0) == 0) return loss;
  const torch::Tensor residuals =
      output.residuals.reshape({-1, kResiduals}).index_select(0, targets.positive);
  torch::Tensor error = residuals - targets.residuals;
  // The sine does not mind half a turn, which the direction tells.
  error = torch::cat({error.slice(1, 0, 6), torch::sin(error.slice(1, 6, 7))}, 1);
  const torch::Tensor box =
      torch::smooth_l1_loss(error, torch::zeros_like(error), at::Reduction::Sum, kBend);
  const torch::Tensor directions =
      output.directions.reshape({-1, 2}).index_select(0, targets.positive);
  const torch::Tensor direction = F::cross_entropy(
      directions, targets.backward, F::CrossEntropyFuncOptions().reduction(torch::kSum));
  return loss + (kBoxWeight * box + kDirectionWeight * direction) / count;
}

// Rises as a cosine over the first quarter of the steps, then falls to nothing (Smith, 2018).
double rate_at(int step, const TrainOptions& options) {
  constexpr double kRise = 0.25;
  const double at = (step + 0.5) / options.steps;
  const double part = at < kRise ? at / kRise - 1.0 : (at - kRise) / (1.0 - kRise);
  return options.learning_rate * (0.02 + 0.98 * 0.5 * (1.0 + std::cos(std::numbers::pi * part)));
}

// Goes through the sweeps in a new order each time.
class Shuffle {
 public:
  Shuffle(std::size_t size, std::uint64_t seed) : order_(size), random_(seed, 1) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }
  std::size_t next() {
    if (at_ == 0) {
      for (std::size_t i = order_.size(); i-- > 1;) {
        std::swap(order_[i],
                  order_[static_cast<std::size_t>(random_.below(static_cast<int>(i) + 1))]);
      }
    }
    const std::size_t chosen = order_[at_];
    at_ = (at_ + 1) % order_.size();
    return chosen;
  }

 private:
  std::vector<std::size_t> order_;
  std::size_t at_ = 0;
  Random random_;
};

void train(PillarNetwork& network, std::span<const LabelledSweep> sweeps,
           const TrainOptions& options, const std::function<void(int, double)>& progress) {
  torch::optim::AdamW adam(network->parameters(),
                           torch::optim::AdamWOptions(options.learning_rate).weight_decay(0.01));
  Shuffle shuffle(sweeps.size(), options.seed);
  Random random(options.seed, 2);
  double mean = 0.0;
  network->train();
  for (int step = 0; step < options.steps; ++step) {
    std::vector<Example> examples;
    std::vector<Pillars> pillars;
    for (int i = 0; i < options.batch; ++i) {
      examples.push_back(make_example(sweeps[shuffle.next()], random));
      pillars.push_back(std::move(examples.back().pillars));
    }
    for (auto& group : adam.param_groups()) group.options().set_lr(rate_at(step, options));
    adam.zero_grad();
    const torch::Tensor loss = loss_of(network->forward(make_batch(pillars)), join(examples));
    loss.backward();
    torch::nn::utils::clip_grad_norm_(network->parameters(), 10.0);
    adam.step();
    const double weight = 1.0 / std::min(step + 1, 50);
    mean += weight * (loss.item<double>() - mean);
    if (progress) progress(step + 1, mean);
  }
}

Status check(std::span<const LabelledSweep> sweeps, const TrainOptions& options) {
  if (sweeps.empty()) {
    return fail(ErrorCode::invalid_argument, "train-detector: no sweeps; give drives");
  }
  if (options.steps < 1 || options.batch < 1 || options.threads < 1 ||
      !(options.learning_rate > 0.0)) {
    return fail(ErrorCode::invalid_argument,
                "train-detector: steps, sweeps a step, threads and learning rate must be above 0");
  }
  return {};
}

}  // namespace

Status train_pillars(std::span<const LabelledSweep> sweeps, const TrainOptions& options,
                     const std::filesystem::path& weights,
                     const std::function<void(int, double)>& progress) try {
  if (Status status = check(sweeps, options); !status) return status;
  if (Status status = check_writable(weights); !status) return status;
  at::set_num_threads(options.threads);
  torch::manual_seed(options.seed);
  PillarNetwork network;
  train(network, sweeps, options, progress);
  return write_weights(weights, network);
} catch (const std::exception& error) {  // libtorch throws, as where memory runs out
  return fail(ErrorCode::limit, std::string("train-detector: libtorch gave up (") + error.what() +
                                    "); take fewer sweeps a step");
}

}  // namespace sweepcast::lab
