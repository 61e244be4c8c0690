// The beams of a spinning LiDAR, found without ring numbers: in the plane of horizontal distance
// rho and height z every beam's points lie on a straight line, z = rho * tan + height.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast {

/// A beam's line in the (rho, z) plane.
struct BeamLine {
  double tan = 0.0;
  double height = 0.0;      ///< metres
  std::size_t support = 0;  ///< points near it
};

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

  /// Index of the line nearest to (rho, z), rho above 0; `inverse` is 1 / rho.
  [[nodiscard]] std::size_t nearest(float rho, float z, float inverse) const {
    const float at = (top_ - (z - height_) * inverse) * scale_;
    const float clamped = at < 0.0F ? 0.0F : (at > last_ ? last_ : at);
    std::size_t k = start_[static_cast<std::size_t>(static_cast<std::int32_t>(clamped))];
    // Mostly it is the one that the table says, or the next; one branch that tells is predictable.
    float here = distance(k, rho, z);
    const float above = distance(k - 1, rho, z);
    const float below = distance(k + 1, rho, z);
    if ((here <= above) & (here <= below)) return k - 1;
    const std::size_t step = above < below ? std::size_t(0) - 1 : 1;
    float next = std::min(above, below);
    while (next < here) {
      k += step;
      here = next;
      next = distance(k + step, rho, z);
    }
    return k - 1;
  }

  [[nodiscard]] std::size_t nearest(float rho, float z) const {
    return nearest(rho, z, 1.0F / rho);
  }

 private:
  [[nodiscard]] float distance(std::size_t k, float rho, float z) const {
    return std::abs(z - (rho * lines_[k].tan + lines_[k].height));
  }

  struct Line {
    float tan, height;
  };

  std::vector<Line> lines_;           // a line beyond reach at either end
  std::vector<std::uint16_t> start_;  // index in lines_
  float top_ = 0.0F, scale_ = 1.0F, last_ = 0.0F, height_ = 0.0F;
};

}  // namespace sweepcast
