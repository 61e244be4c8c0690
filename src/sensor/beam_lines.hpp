// The beams of a spinning LiDAR, found without ring numbers: in the plane of horizontal distance
// rho and height z every beam's points lie on a straight line, z = rho * tan + height.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sensor/beam_geometry.hpp"

namespace sweepcast {

/// A beam's line in the (rho, z) plane.
struct BeamLine {
  double tan = 0.0;
  double height = 0.0;      ///< metres
  std::size_t support = 0;  ///< points near it
};

/// The lines of a model's beams.
[[nodiscard]] inline std::vector<BeamLine> lines_of(const std::vector<BeamGeometry>& beams) {
  std::vector<BeamLine> lines;
  lines.reserve(beams.size());
  for (const BeamGeometry& beam : beams) lines.push_back({beam.tan, beam.height_m, 0});
  return lines;
}

/// Points in the (rho, z) plane, metres; columns of one length.
struct Profile {
  std::span<const float> rho, z;

  [[nodiscard]] std::size_t size() const { return rho.size(); }
};

struct LineSearch {
  int max_beams = 256;
  double blur_m = 0.0;  ///< how far points may lie off their line beyond rounding: deskewed sweeps
};

/// Finds the lines, steepest upward first: a Hough transform over (tan, height), the strongest
/// peak taken, refined on its points, and the votes of those points withdrawn, until no peak has
/// the support of a beam.
[[nodiscard]] std::vector<BeamLine> find_beam_lines(const Profile& points,
                                                    const LineSearch& search);

/// The nearest line of each point by height. Lines are ordered by falling tangent.
void assign_lines(const Profile& points, std::span<const BeamLine> lines,
                  std::vector<std::uint16_t>& beam);

/// Fits every line to the points assigned to it, robustly (weights 1 / (1 + (e / scale)^2) after
/// Geman and McClure), with a weak pull of its height towards its neighbours', for beams that see
/// a single distance. Lines without points stay as they are.
void refine_lines(const Profile& points, std::span<const std::uint16_t> beam, double scale_m,
                  std::span<BeamLine> lines);

/// Finds the line nearest in height to points, by a table over z / rho and a short walk.
class LineTable {
 public:
  LineTable() = default;
  /// Lines ordered by falling tangent; at least one.
  explicit LineTable(std::span<const BeamLine> lines);

  /// What `guess` needs, as a copy, so that loops around it vectorise.
  struct Line {
    float tan, height;
  };
  struct View {
    const std::int32_t* start;
    const Line* lines;
    float top, scale, last, height;

    /// The best of the three lines around the one that the table says for (rho, z), rho above 0;
    /// `inverse` is 1 / rho. Mostly it is the nearest.
    [[nodiscard]] std::int32_t guess(float rho, float z, float inverse) const {
      const float at = (top - (z - height) * inverse) * scale;
      const float from_top = at > 0.0F ? at : 0.0F;
      const float clamped = from_top < last ? from_top : last;
      const std::int32_t k = start[static_cast<std::int32_t>(clamped)];
      const float here = distance(k, rho, z);
      const float above = distance(k - 1, rho, z);
      const float below = distance(k + 1, rho, z);
      const std::int32_t other = above < below ? -1 : 1;
      const float nearer = above < below ? above : below;
      return (nearer < here ? other : 0) + k - 1;
    }
    [[nodiscard]] float distance(std::int32_t k, float rho, float z) const {
      return std::abs(z - (rho * lines[k].tan + lines[k].height));
    }
  };
  [[nodiscard]] View view() const {
    return {start_.data(), lines_.data(), top_, scale_, last_, height_};
  }

  /// Index of the nearest line, from a guess near it.
  [[nodiscard]] std::int32_t walk(std::int32_t line, float rho, float z) const {
    const View table = view();
    std::int32_t k = line + 1;
    float here = table.distance(k, rho, z);
    const std::int32_t step = table.distance(k - 1, rho, z) < here ? -1 : 1;
    for (float next = table.distance(k + step, rho, z); next < here;
         next = table.distance(k + step, rho, z)) {
      k += step;
      here = next;
    }
    return k - 1;
  }

  /// Index of the line nearest to (rho, z), rho above 0.
  [[nodiscard]] std::size_t nearest(float rho, float z) const {
    return static_cast<std::size_t>(walk(view().guess(rho, z, 1.0F / rho), rho, z));
  }

 private:
  std::vector<Line> lines_;          // a line beyond reach at either end
  std::vector<std::int32_t> start_;  // index in lines_
  float top_ = 0.0F, scale_ = 1.0F, last_ = 0.0F, height_ = 0.0F;
};

}  // namespace sweepcast
