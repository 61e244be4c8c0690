// The beams of a spinning LiDAR, found without ring numbers: in the plane of horizontal distance
// rho and height z every beam's points lie on a straight line, z = rho * tan + height.
#pragma once

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

  /// Index of the line nearest to (rho, z), rho above 0.
  [[nodiscard]] std::size_t nearest(float rho, float z) const {
    const float slope = (z - height_) / rho;
    const float at = (top_ - slope) * scale_;
    const float clamped = at < 0.0F ? 0.0F : (at > last_ ? last_ : at);
    std::size_t k = start_[static_cast<std::size_t>(clamped)];
    float miss = error(k, rho, z);
    // Lines run downward with k: below the line (miss < 0) look further on.
    if (miss < 0.0F) {
      while (k + 1 < tan_.size()) {
        const float next = error(k + 1, rho, z);
        if (next < 0.0F ? next < miss : next > -miss) break;
        miss = next;
        ++k;
        if (next >= 0.0F) break;
      }
    } else {
      while (k > 0) {
        const float next = error(k - 1, rho, z);
        if (next > 0.0F ? next > miss : next < -miss) break;
        miss = next;
        --k;
        if (next <= 0.0F) break;
      }
    }
    return k;
  }

  /// Height of (rho, z) above line k, metres.
  [[nodiscard]] float error(std::size_t k, float rho, float z) const {
    return z - (rho * tan_[k] + heights_[k]);
  }

 private:
  std::vector<float> tan_, heights_;
  std::vector<std::uint16_t> start_;
  float top_ = 0.0F, scale_ = 1.0F, last_ = 0.0F, height_ = 0.0F;
};

}  // namespace sweepcast
