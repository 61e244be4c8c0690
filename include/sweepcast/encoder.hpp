// The encoder: sweeps in, frames out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "sweepcast/cloud.hpp"
#include "sweepcast/frame.hpp"
#include "sweepcast/ladder.hpp"
#include "sweepcast/stages.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// An axis-aligned box in the sensor's frame, metres; both corners belong to it.
struct Box {
  float min_x = 0, min_y = 0, min_z = 0;
  float max_x = 0, max_y = 0, max_z = 0;
};

/// Points to leave out before coding; they are counted in `SweepCounts::cropped`.
struct Crop {
  float min_range = 0.0F;    ///< nearer points go, metres
  float max_range = 0.0F;    ///< farther points go, metres; 0 means no limit
  std::optional<Box> keep;   ///< points outside go
  std::optional<Box> robot;  ///< points inside go: the robot's own body
};

/// The model that a block of cells is fitted with.
enum class SurfaceModel : std::uint8_t {
  surface,  ///< r = -d / (a i + b j + c): the paper's equation 4
  plane,    ///< a plane in space: the paper's equation 3, for comparison
};

/// What becomes of the points that no surface fits.
enum class UnfitCoding : std::uint8_t {
  sa_dct,  ///< shape-adaptive DCT, quantised by the step
  raw,     ///< ranges to the millimetre, without transform ("No Compr." of the paper's table)
};

/// How a real number becomes a multiple of the quantiser's step.
enum class Rounding : std::uint8_t {
  nearest,
  truncate,  ///< towards zero, as the released code does; for comparison only
};

/// Which point a cell keeps when several fall into it. The others are counted as collided.
enum class CollisionRule : std::uint8_t {
  nearest_centre,  ///< the one nearest to the cell's centre; of equally near ones the shorter range
  nearest_range,   ///< the one nearest to the sensor
};

/// Options of codec `rcpcc`. The defaults are the paper's timing setting.
struct RcpccOptions {
  RcpccParams params;
  double elevation_min_deg = -90.0;  ///< field of view, degrees; the whole sphere by default:
  double elevation_max_deg = 90.0;   ///< rows without a point cost nothing
  double azimuth_min_deg = -180.0;   ///< may exceed azimuth_max: the view then crosses +-180
  double azimuth_max_deg = 180.0;
  double max_range_m = 500.0;  ///< farther points count as out of view
  int block_size = 4;          ///< side of a macroblock in cells: 4, 8 or 16
  int region_size = 4;         ///< side of an SA-DCT region in cells: 4, 8, 16 or 32
  SurfaceModel model = SurfaceModel::surface;
  UnfitCoding unfit = UnfitCoding::sa_dct;
  Rounding rounding = Rounding::nearest;
  CollisionRule collision = CollisionRule::nearest_centre;
  int zstd_level = 1;  ///< 1 to 22; docs/rcpcc.md has what each costs
};

/// How much time codec `beam` spends to save bytes. Decoding takes about as long as encoding.
enum class Effort : std::uint8_t {
  fast,    ///< one context a decision
  normal,  ///< several, mixed
  best,    ///< many, mixed twice: four times the time
};

/// Which of a cloud's fields are coded.
enum class Fields : std::uint8_t {
  xyz,
  xyzi,  ///< and intensity
  all,   ///< and ring and time
};

/// Options of codec `beam`.
struct BeamOptions {
  double max_error_m = 0.05;  ///< no point decodes farther from its place, metres, 0.001 to 2
  std::optional<int> level;   ///< 0 to 5: one of kBeamLevels in place of max_error_m
  /// Where above 0: as good as fits so many bytes a frame, the sensor's model not counted, in place
  /// of max_error_m.
  std::size_t target_bytes = 0;
  Effort effort = Effort::normal;
  int model_interval = 10;      ///< every how many frames the sensor's model is sent, at least 1
  Fields fields = Fields::all;  ///< of those that the cloud has; the optional ones are exact
  /// Intensities are rounded to its multiples, in the sensor's unit; 0: they are exact.
  double intensity_step = 0.0;
  /// Points come back in the cloud's order; organised clouds organised, points that are not coded
  /// as NaN in their slots. Else points come firing by firing, and those not coded are left out.
  bool keep_order = false;
  /// Coordinates and attributes come back to the bit; `max_error_m` and `intensity_step` then count
  /// for nothing. Points that are not coded, and the order, are as without.
  bool lossless = false;
};

/// Options of an encoder.
struct EncoderOptions {
  CodecId codec = CodecId::beam;
  Crop crop{};
  RcpccOptions rcpcc{};
  BeamOptions beam{};
  StageClock* stages = nullptr;  ///< learns what each stage takes, where there is one
};

/// Makes frames of sweeps. Keeps its buffers: from the second sweep of a kind on, `encode`
/// allocates nothing. One thread at a time may use an encoder; different encoders share nothing.
class Encoder {
 public:
  /// Checks the options. Errors: invalid_argument, with the option and its range.
  [[nodiscard]] static Result<Encoder> create(const EncoderOptions& options);

  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;
  ~Encoder();

  /// Encodes one sweep into a frame. The bytes stay valid until the next call.
  /// Points that cannot be coded are left out and counted, see `last_counts`; a sweep without a
  /// single codable point gives a frame that decodes to an empty cloud.
  /// Errors: invalid_argument (coordinates missing, sensor name too long), limit (over 2^24
  /// points).
  [[nodiscard]] Result<std::span<const std::byte>> encode(const CloudView& cloud,
                                                          const SweepInfo& info);

  /// Changes `BeamOptions::target_bytes`, above 0, from the next sweep on.
  /// Error: invalid_argument (0; another codec; an encoder that was made without a target).
  [[nodiscard]] Status set_target_bytes(std::size_t bytes);

  /// Where the points of the last encoded sweep went.
  [[nodiscard]] const SweepCounts& last_counts() const noexcept;

 private:
  struct State;
  explicit Encoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast
