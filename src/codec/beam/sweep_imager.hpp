// The first stage of codec beam: a sweep becomes a range image under the sensor's model, which is
// learnt from the sweeps themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sensor/beam_grid.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/frame.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::beam {

/// Makes range images; keeps its buffers, and the sensor's model from sweep to sweep.
class SweepImager {
 public:
  explicit SweepImager(const Crop& crop) : crop_(crop) {}

  /// Makes the image of a sweep, in which every cell's point decodes within `max_error_m` of its
  /// place, 3-D, when its range is rounded to `range_step(max_error_m)`; all others are the image's
  /// extras. Without a model, or where the image would be too sparse, all points are extras and the
  /// image has no columns. Counts the points that the crop leaves out.
  void project(const CloudView& cloud, double max_error_m, SweepCounts& counts);

  /// Moves to the extras all points nearer than `range`, 0.1 mm; or all, and the image is gone.
  void move_nearer(std::int32_t range);
  void move_all();

  [[nodiscard]] BeamImage& image() { return image_; }
  [[nodiscard]] const SensorModel* model() const { return model_ ? &*model_ : nullptr; }
  [[nodiscard]] std::uint32_t model_id() const { return model_id_; }  ///< CRC-32 of its bytes
  [[nodiscard]] BeamUnprojector& unprojector() { return *unprojector_; }

  /// Coordinates of the sweep's points, metres.
  [[nodiscard]] std::span<const float> x() const { return x_; }
  [[nodiscard]] std::span<const float> y() const { return y_; }
  [[nodiscard]] std::span<const float> z() const { return z_; }

 private:
  void learn_model(const CloudView& cloud);
  void choose(SweepCounts& counts);
  void keep_bound(double max_error_m);

  Crop crop_;
  std::optional<SensorModel> model_;
  std::uint32_t model_id_ = 0;
  std::optional<Motion> motion_;  ///< of the last sweep, where sweeps come deskewed
  int sweeps_to_wait_ = 0;        ///< before looking for a model again
  int patience_ = 4;
  std::optional<BeamProjector> projector_;
  std::optional<BeamUnprojector> unprojector_;
  std::vector<BeamGeometry> beams_;
  std::vector<float> x_, y_, z_;
  std::vector<std::uint32_t> chosen_;  ///< points that the crop leaves, where it takes any
  BeamImage image_;
  PointCloud placed_;
};

}  // namespace sweepcast::beam
