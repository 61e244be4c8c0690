// The sensor's own range image: rows are beams, columns are firings. Cloud -> image and back; no
// point is lost: what finds no cell is listed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sensor/beam_geometry.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// Why a point has no cell.
enum class ExtraReason : std::uint8_t {
  not_finite,  ///< a coordinate is NaN or infinite
  zero_range,  ///< at the origin: the sensor's mark for "no return"
  stray,       ///< no beam within reach, or too far away for the range's 32 bits
  misfit,      ///< farther from its cell's place than the bound: too few such for residuals
  collision,   ///< another point has the cell: a second return, or the sweep's ends overlap
};

/// A point without a cell.
struct ExtraPoint {
  std::uint32_t point = 0;  ///< index in the cloud
  ExtraReason reason = ExtraReason::stray;
};

inline constexpr std::uint32_t kNoPoint = 0xFFFFFFFF;

/// Ranges along the beams. Planes are row-major: cell (row, col) is at row * cols + col.
/// Row k is beam k of the model; column j is a firing, at tick `firing_tick[j]`; the beam of cell
/// (k, j) looks at tick `firing_tick[j] + lag[k]`, modulo a turn; less `interpolated[k]` where the
/// firing was held.
struct BeamImage {
  int rows = 0;
  int cols = 0;
  std::vector<std::int32_t> firing_tick;  ///< increasing, in [0, ticks_per_turn)
  std::vector<std::uint8_t> held;         ///< by column: 1 where the firing was held; empty: none
  /// Distance from the beam's origin (0, 0, height) along the beam, 0.1 mm; 0 where empty.
  std::vector<std::int32_t> range;
  std::vector<std::uint32_t> point;  ///< index of the cell's point in the cloud, or kNoPoint

  // Residuals that are added to the beam's own: empty where the model holds within the bound, else
  // one a cell, 0 wherever the cell is within the bound without.
  std::vector<std::int32_t> azimuth_residual;  ///< 1 / azimuth_divisor of a tick
  std::vector<std::int32_t> height_residual;   ///< in height_step; added to z, at the same rho
  std::int32_t azimuth_divisor = 1;
  std::int32_t height_step = 0;  ///< 10 um

  /// What the sweep was deskewed by: undone before projecting, done again after `unproject`.
  std::optional<Motion> motion;

  std::vector<ExtraPoint> extras;  ///< by index

  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  }
};

struct BeamGridOptions {
  /// Cells whose point would be off by more get residuals, in steps that bring it within; metres,
  /// 3-D, the rounding of ranges apart. Firings whose ticks jitter are gathered in one column.
  /// 0: no residuals, the error is what the model leaves; a column for every tick that occurs.
  double max_error_m = 0.0;
  /// A point farther from every beam is a stray; metres, height.
  double max_height_residual_m = 0.5;
  /// Points with ranges outside are strays; 0.1 mm.
  std::int32_t nearest = 1;
  std::int32_t farthest = 1 << 30;
  /// What the sweep was deskewed by, to be undone; copied into the image.
  std::optional<Motion> motion;
};

/// Ring by ring, how many columns further on a cell's azimuth lies than its firing's: cell (k, j)
/// looks where cell (m, j + shift[k] - shift[m]) looks, columns counted round the turn.
/// Integer arithmetic: the same everywhere.
void column_shifts(const SensorModel& model, std::span<const std::int32_t> firing_tick,
                   std::vector<std::int32_t>& shift);

/// Makes range images; keeps its tables and buffers.
class BeamProjector {
 public:
  /// The model must have passed `check`.
  explicit BeamProjector(const SensorModel& model);
  BeamProjector(BeamProjector&&) noexcept;
  BeamProjector& operator=(BeamProjector&&) noexcept;
  ~BeamProjector();

  /// Fills `image` with the points of `cloud`; every point is in exactly one cell or extra. Where
  /// two points want a cell, the one nearer to its azimuth has it, of equal ones the first.
  void project(const CloudView& cloud, const BeamGridOptions& options, BeamImage& image);

  /// The same of points whose coordinates are columns already.
  void project(std::span<const float> x, std::span<const float> y, std::span<const float> z,
               const BeamGridOptions& options, BeamImage& image);

  /// The same of some points only (indices into `cloud`), as of the extras of an image: the second
  /// returns of a sweep make an image of their own.
  void project(const CloudView& cloud, std::span<const std::uint32_t> points,
               const BeamGridOptions& options, BeamImage& image);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Makes clouds of range images; keeps its tables.
class BeamUnprojector {
 public:
  /// The model must have passed `check`.
  explicit BeamUnprojector(const SensorModel& model);

  /// Fills the coordinates of `cloud`, one point for each cell with a range, row by row.
  /// Uses rows, cols, firing_tick, held, range and the residuals of `image`. Same bits on every
  /// machine.
  void unproject(const BeamImage& image, PointCloud& cloud);

 private:
  void decode_row(const BeamImage& image, int k);
  void hold(const BeamImage& image, int k);
  void add_residuals(const BeamImage& image, int k);
  void redo_motion(const BeamImage& image, int k);
  void redo_mount(const Mount& mount);

  SensorModel model_;
  std::vector<BeamGeometry> beams_;
  std::vector<double> sin_, cos_;  ///< of the firings' ticks
  std::vector<float> x_, y_, z_;   ///< one row, empty cells included
};

}  // namespace sweepcast
