#include "lab/detect/anchors.hpp"

#include <algorithm>
#include <cmath>

#include "core/trig.hpp"
#include "lab/detect/box_overlap.hpp"

namespace sweepcast::lab {

namespace {

constexpr double kAnchorCell = 2.0 * static_cast<double>(PillarGrid::kSize);
constexpr double kPositive = 0.55;
constexpr double kNegative = 0.4;

constexpr double kVanHeight = 1.76;  // between the highest cars and the lowest vans

// An anchor's size, between a car's and a van's, and its middle for a sensor 1.73 m above the road.
constexpr double kCarLength = 4.4, kCarWidth = 1.8, kCarHeight = 1.6, kMiddle = -0.93;

// An angle's representative in [-pi / 2, pi / 2): a box's outline has no front.
double half_turn(double angle) {
  return angle - kPi * std::floor(angle / kPi + 0.5);
}

// What turns an anchor into a box: equation 1 of the paper.
std::array<float, kResiduals> residuals_of(const Box& box, const Box& at) {
  const double diagonal = std::hypot(at.length, at.width);
  const std::array<double, kResiduals> exact{(box.centre.x() - at.centre.x()) / diagonal,
                                             (box.centre.y() - at.centre.y()) / diagonal,
                                             (box.centre.z() - at.centre.z()) / at.height,
                                             std::log(box.length / at.length),
                                             std::log(box.width / at.width),
                                             std::log(box.height / at.height),
                                             half_turn(box.yaw - at.yaw)};
  std::array<float, kResiduals> residuals{};
  std::transform(exact.begin(), exact.end(), residuals.begin(),
                 [](double value) { return static_cast<float>(value); });
  return residuals;
}

bool points_backward(const Box& box, const Box& at) {
  return std::cos(box.yaw - at.yaw - half_turn(box.yaw - at.yaw)) < 0.0;
}

int cell_index(double at) {
  const double reach = static_cast<double>(PillarGrid::kReach);
  return static_cast<int>(std::floor((at + reach) / kAnchorCell));
}

// Calls `visit(index)` for the anchors within 3 m of a box.
template <class Visit>
void near_anchors(const Box& box, const Visit& visit) {
  constexpr int kSpan = 5;
  const int column = cell_index(box.centre.x());
  const int row = cell_index(box.centre.y());
  for (int r = std::max(0, row - kSpan); r <= std::min(kOutputSide - 1, row + kSpan); ++r) {
    for (int c = std::max(0, column - kSpan); c <= std::min(kOutputSide - 1, column + kSpan); ++c) {
      for (int which = 0; which < kAnchorsOfCell; ++which) {
        visit((r * kOutputSide + c) * kAnchorsOfCell + which);
      }
    }
  }
}

constexpr double kSameThing = 0.5;  ///< IoU of boxes that vote about a box

// The mean of boxes that say much the same, weighted by their scores.
struct Votes {
  double weight = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  double turn = 0.0;  ///< from the best box's yaw, times weight

  void add(const Box& best, const Box& box) {
    weight += box.score;
    centre += box.score * box.centre;
    size += box.score * Eigen::Vector3d(box.length, box.width, box.height);
    turn += box.score * half_turn(box.yaw - best.yaw);
  }
  void decide(Box& best) const {
    best.centre = centre / weight;
    best.length = size.x() / weight;
    best.width = size.y() / weight;
    best.height = size.z() / weight;
    best.yaw += turn / weight;
  }
};

}  // namespace

Box anchor(int index) {
  const int which = index % kAnchorsOfCell;
  const int cell = index / kAnchorsOfCell;
  const double reach = static_cast<double>(PillarGrid::kReach);
  Box box;
  const int row = cell / kOutputSide, column = cell % kOutputSide;
  box.centre = {(column + 0.5) * kAnchorCell - reach, (row + 0.5) * kAnchorCell - reach, kMiddle};
  box.length = kCarLength;
  box.width = kCarWidth;
  box.height = kCarHeight;
  box.yaw = which == 0 ? 0.0 : 0.5 * kPi;
  return box;
}

AnchorTargets assign_targets(std::span<const Box> boxes, int min_points) {
  AnchorTargets targets;
  targets.state.assign(kAnchors, 0.0F);
  std::vector<double> overlap(kAnchors, 0.0);
  std::vector<int> owner(kAnchors, -1);
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    if (boxes[b].label != "Car" && boxes[b].label != "Van") continue;
    const bool counts = boxes[b].points < 0 || boxes[b].points >= min_points;
    int best = -1;
    double most = 0.0;
    near_anchors(boxes[b], [&](int index) {
      const auto i = static_cast<std::size_t>(index);
      const double iou = bev_iou(boxes[b], anchor(index));
      if (iou > most) {
        most = iou;
        best = index;
      }
      if (iou < kNegative || iou < overlap[i]) return;
      overlap[i] = iou;
      const bool is_positive = counts && iou >= kPositive;
      owner[i] = is_positive ? static_cast<int>(b) : -1;
      targets.state[i] = is_positive ? 1.0F : -1.0F;
    });
    if (best < 0 || !counts) continue;
    overlap[static_cast<std::size_t>(best)] = 1.0;
    owner[static_cast<std::size_t>(best)] = static_cast<int>(b);
    targets.state[static_cast<std::size_t>(best)] = 1.0F;
  }
  for (int index = 0; index < kAnchors; ++index) {
    const int b = owner[static_cast<std::size_t>(index)];
    if (b < 0) continue;
    const Box& box = boxes[static_cast<std::size_t>(b)];
    const Box at = anchor(index);
    const auto residuals = residuals_of(box, at);
    targets.positive.push_back(index);
    targets.residuals.insert(targets.residuals.end(), residuals.begin(), residuals.end());
    targets.backward.push_back(points_backward(box, at) ? 1 : 0);
  }
  return targets;
}

Box decode_box(int index, std::span<const float, kResiduals> residuals, bool backward,
               double score) {
  constexpr double kMostLog = 1.5;  // nothing is 4.5 times as long as a car
  const auto at = [&](int i) {
    return static_cast<double>(residuals[static_cast<std::size_t>(i)]);
  };
  const auto scale = [&](int i) { return std::exp(std::clamp(at(i), -kMostLog, kMostLog)); };
  Box box = anchor(index);
  const double diagonal = std::hypot(box.length, box.width);
  box.centre += Eigen::Vector3d(at(0) * diagonal, at(1) * diagonal, at(2) * box.height);
  box.length *= scale(3);
  box.width *= scale(4);
  box.height *= scale(5);
  if (box.height > kVanHeight) box.label = "Van";
  const double yaw = box.yaw + half_turn(at(6)) + (backward ? kPi : 0.0);
  box.yaw = yaw - 2.0 * kPi * std::floor(yaw / (2.0 * kPi) + 0.5);
  box.score = score;
  return box;
}

std::vector<Box> suppress_overlaps(std::vector<Box> boxes, double most) {
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const Box& a, const Box& b) { return a.score > b.score; });
  std::vector<Box> kept;
  std::vector<Votes> votes;
  for (const Box& box : boxes) {
    double overlap = 0.0;
    const auto better = std::find_if(kept.begin(), kept.end(), [&](const Box& other) {
      overlap = bev_iou(other, box);
      return overlap > most;
    });
    const auto k = static_cast<std::size_t>(better - kept.begin());
    if (better == kept.end()) {
      kept.push_back(box);
      votes.emplace_back();
      overlap = 1.0;
    }
    if (overlap >= kSameThing) votes[k].add(kept[k], box);
  }
  for (std::size_t k = 0; k < kept.size(); ++k) votes[k].decide(kept[k]);
  return kept;
}

}  // namespace sweepcast::lab
