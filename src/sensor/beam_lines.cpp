#include "sensor/beam_lines.hpp"

#include <algorithm>
#include <cmath>

namespace sweepcast {
namespace {

constexpr double kTop = 2.4;         // of the tangents looked at, either way: 67 degrees
constexpr double kMaxHeight = 0.36;  // of a beam's origin, metres, either way
constexpr double kHeightStep = 0.004;
constexpr int kHeights = 2 * static_cast<int>(kMaxHeight / kHeightStep) + 1;
constexpr int kMiddle = kHeights / 2;  // the row of height 0
constexpr int kMinSupport = 12;        // points of a beam
constexpr std::size_t kMaxVoters = 60'000;

// Votes of points for lines: row per height, column per tangent.
class Hough {
 public:
  Hough(const Profile& points, double bin) : bin_(bin), cols_(static_cast<int>(2.0 * kTop / bin)) {
    votes_.assign(static_cast<std::size_t>(kHeights) * static_cast<std::size_t>(cols_), 0);
    const std::size_t step = points.size() / kMaxVoters + 1;
    for (std::size_t i = 0; i < points.size(); i += step) {
      rho_.push_back(points.rho[i]);
      z_.push_back(points.z[i]);
      vote(rho_.size() - 1, 1);
    }
  }

  [[nodiscard]] std::size_t voters() const { return rho_.size(); }

  struct Peak {
    double tan = 0.0, height = 0.0;
    int votes = 0;
  };

  // The strongest three neighbouring bins among the heights allowed at each tangent.
  [[nodiscard]] Peak strongest() const {
    Peak best;
    for (const Band& band : bands_) {
      const std::int32_t* votes = row(band.height);
      for (int c = band.begin; c < band.end; ++c) {
        const int sum = votes[c - 1] + votes[c] + votes[c + 1];
        if (sum > best.votes) best = {tangent(c), height(band.height), sum};
      }
    }
    return best;
  }

  // Withdraws the votes of the points within reach of a line; returns how many there were.
  std::size_t withdraw(const BeamLine& line, double reach) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < rho_.size();) {
      if (!near(i, line, reach)) {
        ++i;
        continue;
      }
      vote(i, -1);
      rho_[i] = rho_.back();
      z_[i] = z_.back();
      rho_.pop_back();
      z_.pop_back();
      ++count;
    }
    return count;
  }

  // Beams of a block share their height, or nearly so: for every window of tangents, allows only
  // heights near the one at which votes are piled highest, there or next to it. Without it a table
  // top would pass for a beam.
  void restrict_heights() {
    const int window = static_cast<int>(0.06 / bin_) + 1;
    std::vector<int> piled;
    for (int begin = 1; begin + 1 < cols_; begin += window) {
      double most = 0.0;
      piled.push_back(-1);
      for (int h = 0; h < kHeights; ++h) {
        double power = 0.0;
        for (int c = begin; c < std::min(begin + window, cols_ - 1); ++c) {
          const double sum = row(h)[c - 1] + row(h)[c] + row(h)[c + 1];
          power += sum * sum;
        }
        if (power > most) {
          most = power;
          piled.back() = h;
        }
      }
    }
    const int last = static_cast<int>(piled.size()) - 1;
    for (int w = 0; w <= last; ++w) {
      for (int h = 0; h < kHeights; ++h) {
        bool allowed = false;
        for (int near = std::max(w - 1, 0); near <= std::min(w + 1, last); ++near) {
          const int centre = piled[static_cast<std::size_t>(near)];
          allowed = allowed || (centre >= 0 && std::abs(h - centre) <= 2);
        }
        const int begin = 1 + w * window;
        if (allowed) bands_.push_back({h, begin, std::min(begin + window, cols_ - 1)});
      }
    }
  }

  void gather(const BeamLine& line, double reach, std::vector<std::size_t>& found) const {
    found.clear();
    for (std::size_t i = 0; i < rho_.size(); ++i) {
      if (near(i, line, reach)) found.push_back(i);
    }
  }

  [[nodiscard]] double rho(std::size_t i) const { return rho_[i]; }
  [[nodiscard]] double z(std::size_t i) const { return z_[i]; }

 private:
  // Where peaks are looked for: columns of one row.
  struct Band {
    int height, begin, end;
  };

  // Close to the sensor beams run close to each other, so the reach narrows.
  [[nodiscard]] bool near(std::size_t i, const BeamLine& line, double reach) const {
    return std::abs(z_[i] - (rho_[i] * line.tan + line.height)) < std::min(reach, 1e-3 * rho_[i]);
  }

  static double height(int h) { return (h - kMiddle) * kHeightStep; }
  [[nodiscard]] double tangent(int c) const { return (c + 0.5) * bin_ - kTop; }
  [[nodiscard]] const std::int32_t* row(int h) const {
    return votes_.data() + static_cast<std::size_t>(h) * static_cast<std::size_t>(cols_);
  }

  void vote(std::size_t i, int votes) {
    const double inverse = 1.0 / (rho_[i] * bin_);
    double at = (z_[i] - height(0)) * inverse + kTop / bin_;
    const double step = -kHeightStep * inverse;
    for (int h = 0; h < kHeights; ++h, at += step) {
      if (at >= 0.0 && at < cols_) {
        votes_[static_cast<std::size_t>(h) * static_cast<std::size_t>(cols_) +
               static_cast<std::size_t>(at)] += votes;
      }
    }
  }

  double bin_;
  int cols_;
  std::vector<std::int32_t> votes_;
  std::vector<Band> bands_;
  std::vector<double> rho_, z_;
};

// Weighted sums of a line fit z = rho * tan + height.
struct LineSums {
  double w = 0, r = 0, rr = 0, z = 0, rz = 0;

  void add(double weight, double rho, double height) {
    w += weight;
    r += weight * rho;
    rr += weight * rho * rho;
    z += weight * height;
    rz += weight * rho * height;
  }

  // With a pull of weight `pull` towards `expected` height.
  void solve(double pull, double expected, BeamLine& line) const {
    const double ww = w + pull;
    const double zz = z + pull * expected;
    const double det = rr * ww - r * r;
    if (!(det > 1e-12 * rr * ww)) return;
    line.tan = (rz * ww - r * zz) / det;
    line.height = (rr * zz - r * rz) / det;
  }
};

// Fits the line to the points near it, nearer ones each time.
void settle(const Hough& hough, const LineSearch& search, BeamLine& line) {
  std::vector<std::size_t> near;
  const double start_height = line.height;
  for (const double reach : {0.012, 0.008, 0.006, 0.004, 0.004}) {
    hough.gather(line, reach + search.blur_m, near);
    LineSums sums;
    for (const std::size_t i : near) {
      const double e =
          (hough.z(i) - (hough.rho(i) * line.tan + line.height)) / (reach / 3.0 + search.blur_m);
      sums.add(1.0 / (1.0 + e * e), hough.rho(i), hough.z(i));
    }
    sums.solve(2.0, start_height, line);
    line.support = near.size();
  }
}

}  // namespace

std::vector<BeamLine> find_beam_lines(const Profile& points, const LineSearch& search) {
  Hough hough(points, 2.5e-4);
  hough.restrict_heights();
  std::vector<BeamLine> lines;
  while (lines.size() < static_cast<std::size_t>(search.max_beams)) {
    const Hough::Peak peak = hough.strongest();
    if (peak.votes < kMinSupport) break;
    BeamLine line{peak.tan, peak.height, 0};
    settle(hough, search, line);
    line.support = hough.withdraw(line, 0.006 + search.blur_m);
    if (line.support >= static_cast<std::size_t>(kMinSupport)) {
      lines.push_back(line);
    } else if (hough.withdraw({peak.tan, peak.height, 0}, 0.01) == 0) {
      break;
    }
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const BeamLine& a, const BeamLine& b) { return a.tan > b.tan; });
  return lines;
}

LineTable::LineTable(std::span<const BeamLine> lines) {
  constexpr float kBeyond = 1e30F;
  std::vector<double> heights;
  lines_.push_back({0.0F, kBeyond});
  for (const BeamLine& line : lines) {
    lines_.push_back({static_cast<float>(line.tan), static_cast<float>(line.height)});
    heights.push_back(line.height);
  }
  lines_.push_back({0.0F, kBeyond});
  std::nth_element(heights.begin(),
                   heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2),
                   heights.end());
  height_ = static_cast<float>(heights[heights.size() / 2]);
  constexpr int kEntries = 4096;
  const double top = lines.front().tan + 0.02;
  const double span = top - (lines.back().tan - 0.02);
  top_ = static_cast<float>(top);
  scale_ = static_cast<float>(kEntries / span);
  last_ = kEntries - 1;
  start_.resize(kEntries);
  std::size_t k = 0;
  for (int i = 0; i < kEntries; ++i) {
    const double slope = top - (i + 0.5) * span / kEntries;
    while (k + 1 < lines.size() &&
           std::abs(lines[k + 1].tan - slope) < std::abs(lines[k].tan - slope)) {
      ++k;
    }
    start_[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(k + 1);
  }
}

void assign_lines(const Profile& points, std::span<const BeamLine> lines,
                  std::vector<std::uint16_t>& beam) {
  const LineTable table(lines);
  beam.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    beam[i] = static_cast<std::uint16_t>(table.nearest(points.rho[i], points.z[i]));
  }
}

void refine_lines(const Profile& points, std::span<const std::uint16_t> beam, double scale_m,
                  std::span<BeamLine> lines) {
  std::vector<LineSums> sums(lines.size());
  for (BeamLine& line : lines) line.support = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    BeamLine& line = lines[beam[i]];
    const double e = (points.z[i] - (points.rho[i] * line.tan + line.height)) / scale_m;
    const double weight = 1.0 / ((1.0 + e * e) * (1.0 + e * e));
    sums[beam[i]].add(weight, points.rho[i], points.z[i]);
    if (std::abs(e) < 4.0) ++line.support;
  }
  std::vector<double> heights;
  for (const BeamLine& line : lines) heights.push_back(line.height);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (sums[k].w < 3.0) continue;
    const auto first = heights.begin() + static_cast<std::ptrdiff_t>(k < 2 ? 0 : k - 2);
    std::vector<double> near(
        first, heights.begin() + static_cast<std::ptrdiff_t>(std::min(k + 3, heights.size())));
    std::sort(near.begin(), near.end());
    sums[k].solve(2.0, near[near.size() / 2], lines[k]);
  }
}

}  // namespace sweepcast
