#include "lab/detect/average_precision.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "lab/detect/box_overlap.hpp"

namespace sweepcast::lab {

namespace {

using Overlap = double (*)(const Box&, const Box&);

bool is_far(const Box& box, const ScoreOptions& options) {
  return box.centre.head<2>().norm() > options.max_range_m;
}

// A true box as the scoring sees it.
struct Target {
  const Box* box;
  bool counts;  // else finding it is neither right nor wrong
  bool found = false;
};

std::vector<Target> targets_of(const std::vector<Box>& truth, const ScoreOptions& options) {
  std::vector<Target> targets;
  for (const Box& box : truth) {
    const bool is_alike =
        std::find(options.alike.begin(), options.alike.end(), box.label) != options.alike.end();
    if (box.label != options.label && !is_alike) continue;
    const bool has_points = box.points < 0 || box.points >= options.min_points;
    targets.push_back({&box, !is_alike && has_points && !is_far(box, options)});
  }
  return targets;
}

// The free target that a box overlaps most; one that counts goes before those that do not.
Target* best_target(std::vector<Target>& targets, const Box& box, Overlap overlap, double least) {
  Target* best = nullptr;
  double most = 0.0;
  for (Target& target : targets) {
    if (target.found) continue;
    const double shared = overlap(*target.box, box);
    if (shared < least || (best && best->counts && !target.counts)) continue;
    if (!best || (target.counts && !best->counts) || shared > most) {
      best = &target;
      most = shared;
    }
  }
  return best;
}

// Judges the boxes found in one sweep, the best scored first; returns how many were to be found.
int judge(const std::vector<Box>& truth, const std::vector<Box>& found, const ScoreOptions& options,
          Overlap overlap, double least, std::vector<Judged>& judged) {
  std::vector<Target> targets = targets_of(truth, options);
  std::vector<const Box*> order;
  for (const Box& box : found) {
    if (box.label == options.label) order.push_back(&box);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Box* a, const Box* b) { return a->score > b->score; });
  for (const Box* box : order) {
    Target* target = best_target(targets, *box, overlap, least);
    if (target) target->found = true;
    const bool counts = target ? target->counts : !is_far(*box, options);
    if (counts) judged.push_back({box->score, target != nullptr});
  }
  return static_cast<int>(
      std::count_if(targets.begin(), targets.end(), [](const Target& t) { return t.counts; }));
}

}  // namespace

double average_precision(std::vector<Judged> judged, int wanted, int recall_points) {
  if (wanted <= 0 || recall_points < 2) return 0.0;
  std::sort(judged.begin(), judged.end(),
            [](const Judged& a, const Judged& b) { return a.score > b.score; });
  // Right ones and precision wherever the score falls.
  std::vector<std::pair<int, double>> curve;
  int right = 0;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    right += judged[i].right ? 1 : 0;
    if (i + 1 < judged.size() && judged[i + 1].score == judged[i].score) continue;
    curve.emplace_back(right, static_cast<double>(right) / static_cast<double>(i + 1));
  }
  for (std::size_t i = curve.size(); i-- > 1;) {
    curve[i - 1].second = std::max(curve[i - 1].second, curve[i].second);
  }
  const int first = recall_points == 11 ? 0 : 1;
  const int last = recall_points == 11 ? 10 : recall_points;
  double sum = 0.0;
  for (int k = first; k <= last; ++k) {
    // In whole numbers, so that a recall of exactly k / last is reached.
    const auto at = std::find_if(curve.begin(), curve.end(), [&](const auto& point) {
      return static_cast<long long>(point.first) * last >= static_cast<long long>(k) * wanted;
    });
    if (at != curve.end()) sum += at->second;
  }
  return sum / static_cast<double>(recall_points);
}

DetectionScore detection_score(std::span<const std::vector<Box>> truth,
                               std::span<const std::vector<Box>> found,
                               const ScoreOptions& options) {
  const auto score = [&](Overlap overlap, double least) {
    std::vector<Judged> judged;
    int wanted = 0;
    for (std::size_t i = 0; i < std::min(truth.size(), found.size()); ++i) {
      wanted += judge(truth[i], found[i], options, overlap, least, judged);
    }
    return 100.0 * average_precision(std::move(judged), wanted, options.recall_points);
  };
  return {score(bev_iou, 0.5), score(bev_iou, 0.7), score(iou_3d, 0.5), score(iou_3d, 0.7)};
}

}  // namespace sweepcast::lab
