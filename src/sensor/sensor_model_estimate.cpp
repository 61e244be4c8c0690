// A sensor's model from its sweeps: beams in the (rho, z) plane first, then their azimuths.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/trig.hpp"
#include "sensor/beam_azimuth.hpp"
#include "sensor/beam_columns.hpp"
#include "sensor/beam_geometry.hpp"
#include "sensor/beam_lines.hpp"
#include "sensor/held_firings.hpp"
#include "sensor/sensor_estimate.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {
namespace {

constexpr std::size_t kMinPoints = 500;
constexpr double kClearly = 0.95;    // fewer columns than this share are clearly fewer
constexpr double kRounding = 0.003;  // metres: scale of height residuals of a crisp beam

// The points of all sweeps that are looked at, in the sensor's frame.
struct Samples {
  std::vector<float> rho, z;
  std::vector<std::uint16_t> ring;  // empty where a sweep has none
  std::vector<std::uint16_t> beam;
  std::vector<BeamSamples> sweeps;  // the same points, by sweep

  [[nodiscard]] Profile profile() const { return {rho, z}; }

  void share_beams() {
    std::size_t at = 0;
    for (BeamSamples& sweep : sweeps) {
      const auto first = beam.begin() + static_cast<std::ptrdiff_t>(at);
      at += sweep.size();
      sweep.beam.assign(first, beam.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
};

// Whole sweeps, evenly spread, up to the cap; the first one always.
std::vector<CloudView> chosen(std::span<const CloudView> sweeps, std::size_t max_points) {
  std::size_t total = 0;
  for (const CloudView& sweep : sweeps) total += sweep.size;
  const std::size_t step = std::max<std::size_t>(1, (total + max_points - 1) / max_points);
  std::vector<CloudView> some;
  for (std::size_t i = 0; i < sweeps.size(); i += step) some.push_back(sweeps[i]);
  return some;
}

void add_sweep(const CloudView& cloud, bool use_ring, Samples& samples) {
  BeamSamples sweep;
  for (std::size_t i = 0; i < cloud.size; ++i) {
    const double x = cloud.x.at(i);
    const double y = cloud.y.at(i);
    const double z = cloud.z.at(i);
    const double rho = std::sqrt(x * x + y * y);
    if (!(rho > 0.05 && rho < 1e4 && std::abs(z) < 1e4)) continue;
    const double turn = arc_tangent(y, x) / kTwoPi;
    sweep.turn.push_back(static_cast<float>(turn < 0.0 ? turn + 1.0 : turn));
    sweep.inverse_rho.push_back(static_cast<float>(1.0 / rho));
    samples.rho.push_back(static_cast<float>(rho));
    samples.z.push_back(static_cast<float>(z));
    if (use_ring) samples.ring.push_back(static_cast<std::uint16_t>(cloud.ring.at(i)));
  }
  samples.sweeps.push_back(std::move(sweep));
}

// A first line for every ring: through the origin at the median slope.
std::vector<BeamLine> lines_of_rings(const Samples& samples) {
  const std::size_t rings = 1 + *std::max_element(samples.ring.begin(), samples.ring.end());
  std::vector<std::vector<double>> slopes(rings);
  for (std::size_t i = 0; i < samples.ring.size(); ++i) {
    slopes[samples.ring[i]].push_back(static_cast<double>(samples.z[i]) / samples.rho[i]);
  }
  std::vector<BeamLine> lines(rings);
  for (std::size_t k = 0; k < rings; ++k) {
    if (slopes[k].empty()) continue;
    const auto middle = slopes[k].begin() + static_cast<std::ptrdiff_t>(slopes[k].size() / 2);
    std::nth_element(slopes[k].begin(), middle, slopes[k].end());
    lines[k].tan = *middle;
  }
  for (const double scale : {0.3, 0.1, 0.03, 0.01, 0.003}) {
    refine_lines(samples.profile(), samples.ring, scale, lines);
  }
  return lines;
}

void order_lines(std::vector<BeamLine>& lines, std::size_t min_support) {
  lines.erase(std::remove_if(lines.begin(), lines.end(),
                             [&](const BeamLine& line) { return line.support < min_support; }),
              lines.end());
  std::stable_sort(lines.begin(), lines.end(),
                   [](const BeamLine& a, const BeamLine& b) { return a.tan > b.tan; });
}

// Beams and the points of each.
std::vector<BeamLine> fit_lines(Samples& samples, int max_beams) {
  std::vector<BeamLine> lines;
  if (samples.ring.empty()) {
    lines = find_beam_lines(samples.profile(), {max_beams, 0.0});
  } else {
    lines = lines_of_rings(samples);
  }
  for (int round = 0; round < 4 && !lines.empty(); ++round) {
    order_lines(lines, 3);
    if (lines.empty()) break;
    assign_lines(samples.profile(), lines, samples.beam);
    refine_lines(samples.profile(), samples.beam, kRounding, lines);
  }
  order_lines(lines, 3);
  if (lines.empty()) return lines;
  assign_lines(samples.profile(), lines, samples.beam);
  samples.share_beams();
  return lines;
}

// About as many columns as the fullest beam has points, where there are no ticks to be found.
int columns_for(const BeamSamples& sweep, std::size_t beams) {
  std::vector<int> count(beams, 0);
  for (const std::uint16_t k : sweep.beam) ++count[k];
  return std::max(360, *std::max_element(count.begin(), count.end()) * 11 / 10);
}

std::int32_t quantised(double value, double units) {
  return static_cast<std::int32_t>(std::lround(value * units));
}

SensorModel model_of(const std::vector<BeamLine>& lines, const std::vector<BeamAzimuth>& azimuths,
                     int ticks) {
  std::vector<int> lags;
  lags.reserve(azimuths.size());
  for (const BeamAzimuth& azimuth : azimuths) lags.push_back(azimuth.lag);
  std::nth_element(lags.begin(), lags.begin() + static_cast<std::ptrdiff_t>(lags.size() / 2),
                   lags.end());
  SensorModel model;
  model.ticks_per_turn = ticks;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    Beam beam;
    beam.tan_elevation = quantised(lines[k].tan, kTangentUnits);
    beam.height = quantised(lines[k].height, kLengthUnits);
    beam.azimuth_offset = quantised(azimuths[k].phase * 360.0 / ticks, kAngleUnits);
    beam.lateral_offset = quantised(azimuths[k].lateral_m, kLengthUnits);
    beam.lag = azimuths[k].lag - lags[lags.size() / 2];
    beam.interpolated = azimuths[k].interpolated;
    model.beams.push_back(beam);
  }
  return model;
}

// Residuals of a point with the integers of a model.
struct Miss {
  double height, ticks, distance;
};

Miss miss_of(const BeamGeometry& beam, double rho, double z, double turn, int ticks) {
  const double height = z - (rho * beam.tan + beam.height_m);
  const double at = (turn - lateral_turns(beam, rho)) * ticks - beam.phase;
  const double off = wrap(at);
  const double aside = off / ticks * kTwoPi * rho;
  const double above = height * beam.inverse_slant;
  return {height, off, std::sqrt(aside * aside + above * above)};
}

double percentile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// How far the beams next to this one are, in height at a distance.
double half_spacing(const std::vector<BeamGeometry>& beams, std::size_t k, double rho) {
  double nearest = 1e9;
  for (const std::size_t other : {k - 1, k + 1}) {  // k - 1 of 0 is past the end
    if (other >= beams.size()) continue;
    const double apart =
        (beams[k].tan - beams[other].tan) * rho + beams[k].height_m - beams[other].height_m;
    nearest = std::min(nearest, std::abs(apart));
  }
  return std::max(0.5 * nearest, 1e-6);
}

SensorResiduals residuals_of(const Samples& samples, const SensorModel& model) {
  const std::vector<BeamGeometry> beams = beam_geometry(model);
  std::vector<double> heights, azimuths, distances, blurs;
  std::size_t i = 0;
  for (const BeamSamples& sweep : samples.sweeps) {
    for (std::size_t n = 0; n < sweep.size(); ++n, ++i) {
      const std::size_t k = samples.beam[i];
      const Miss miss =
          miss_of(beams[k], samples.rho[i], samples.z[i], sweep.turn[n], model.ticks_per_turn);
      heights.push_back(std::abs(miss.height));
      azimuths.push_back(std::abs(miss.ticks) * 360.0 / model.ticks_per_turn);
      distances.push_back(miss.distance);
      blurs.push_back(std::abs(miss.height) / half_spacing(beams, k, samples.rho[i]));
    }
  }
  const auto share = [&](double limit) {
    const auto within = std::count_if(distances.begin(), distances.end(),
                                      [&](double distance) { return distance <= limit; });
    return static_cast<double>(within) / static_cast<double>(distances.size());
  };
  SensorResiduals residuals;
  residuals.points = heights.size();
  residuals.share_5mm = share(0.005);
  residuals.share_2cm = share(0.02);
  residuals.share_5cm = share(0.05);
  residuals.height_median_m = percentile(heights, 0.5);
  residuals.height_p95_m = percentile(heights, 0.95);
  residuals.height_p99_m = percentile(heights, 0.99);
  residuals.azimuth_median_deg = percentile(azimuths, 0.5);
  residuals.azimuth_p95_deg = percentile(azimuths, 0.95);
  residuals.azimuth_p99_deg = percentile(azimuths, 0.99);
  residuals.blur = percentile(blurs, 0.5);
  return residuals;
}

struct Jitter {
  std::int32_t ticks = 0;
  std::size_t columns = 0;  ///< that a sweep has with it
  std::size_t apart = 0;    ///< that it has without
};

// The smallest jitter that brings the number of columns down; 0 where none does so clearly.
Jitter find_jitter(const BeamSamples& sweep, const SensorModel& model) {
  const std::vector<BeamGeometry> beams = beam_geometry(model);
  std::vector<FiringPlace> places;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    const std::size_t k = sweep.beam[i];
    const double q = beams[k].lateral_m * sweep.inverse_rho[i];
    const double at = (sweep.turn[i] - q / kTwoPi) * model.ticks_per_turn - beams[k].phase;
    const int tick =
        (static_cast<int>(std::floor(at + 0.5)) - model.beams[k].lag) % model.ticks_per_turn;
    places.push_back(
        {tick < 0 ? tick + model.ticks_per_turn : tick, static_cast<std::uint16_t>(k)});
  }
  HeldFirings holds;
  std::span<const std::uint8_t> held;
  const std::vector<std::int32_t> interpolated = interpolated_lags(model);
  if (!interpolated.empty()) held = holds.find(places, interpolated, model.ticks_per_turn);
  ColumnFinder finder;
  std::vector<std::int32_t> ticks;
  const auto columns = [&](int jitter) {
    (void)finder.find(places, held, model.ticks_per_turn, static_cast<int>(beams.size()), jitter,
                      ticks);
    return ticks.size();
  };
  const auto much_below = [](std::size_t few, double share, std::size_t many) {
    return static_cast<double>(few) < share * static_cast<double>(many);
  };
  Jitter best{0, columns(0), columns(0)};
  for (const int jitter : {1, 2, 3, 4, 6, 8, 10, 12, 14, 16, 20, 24, 32}) {
    const std::size_t count = columns(jitter);
    const bool clearly = best.ticks == 0 ? much_below(count, kClearly, best.apart)
                                         : much_below(count, 0.97, best.columns);
    if (clearly) best = {jitter, count, best.apart};
  }
  return best;
}

// Where a driver holds firings, by a model that knows columns get fewer, or as few with less
// jitter.
void look_for_held_firings(const Samples& samples, const std::vector<BeamLine>& lines,
                           const std::vector<BeamAzimuth>& azimuths, SensorModel& model) {
  Jitter best = find_jitter(samples.sweeps.front(), model);
  model.jitter = best.ticks;
  for (const HeldFit fit : {HeldFit::some_beams, HeldFit::all_beams}) {
    // What lies scattered looks like jitter.
    if (fit == HeldFit::all_beams && best.ticks == 0) break;
    std::vector<BeamAzimuth> split_azimuths = azimuths;
    split_lags(samples.sweeps, model.ticks_per_turn, fit, split_azimuths);
    SensorModel split = model_of(lines, split_azimuths, model.ticks_per_turn);
    if (interpolated_lags(split).empty()) continue;
    const Jitter found = find_jitter(samples.sweeps.front(), split);
    split.jitter = found.ticks;
    const bool fewer = 10 * found.apart < 9 * best.apart;
    const bool steadier = found.ticks < best.ticks && 2 * found.ticks <= best.ticks &&
                          50 * found.columns <= 51 * best.columns;
    if (!fewer && !steadier) continue;
    model = std::move(split);
    best = found;
  }
}

}  // namespace

Result<SensorEstimate> estimate_still(std::span<const CloudView> sweeps, bool use_ring,
                                      const SensorEstimateOptions& options) {
  Samples samples;
  for (const CloudView& sweep : sweeps) add_sweep(sweep, use_ring, samples);
  if (samples.rho.size() < kMinPoints) {
    return fail(ErrorCode::invalid_argument,
                std::to_string(samples.rho.size()) +
                    " points are too few for a sensor model; at least " +
                    std::to_string(kMinPoints) + " are needed");
  }
  const std::vector<BeamLine> lines = fit_lines(samples, options.max_beams);
  if (lines.empty()) {
    return fail(ErrorCode::unsupported, "no beams of a spinning LiDAR in these points");
  }
  int ticks = options.ticks_per_turn;
  if (ticks == 0) ticks = find_ticks(samples.sweeps, lines.size());
  const bool coherent = ticks != 0;
  if (!coherent) ticks = columns_for(samples.sweeps.front(), lines.size());
  std::vector<BeamAzimuth> azimuths(lines.size());
  if (coherent) {
    azimuths = fit_azimuths(samples.sweeps, lines.size(), ticks);
    fit_lags(samples.sweeps, ticks, azimuths);
  }
  SensorEstimate estimate;
  estimate.model = model_of(lines, azimuths, ticks);
  if (coherent) look_for_held_firings(samples, lines, azimuths, estimate.model);
  if (const Status sound = check(estimate.model); !sound) return tl::unexpected(sound.error());
  estimate.residuals = residuals_of(samples, estimate.model);
  return estimate;
}

Result<SensorEstimate> estimate_sensor_model(std::span<const CloudView> sweeps,
                                             const SensorEstimateOptions& options) {
  // Beams whose points lie this much of the way to the next are crisp.
  constexpr double kCrisp = 0.06;
  constexpr double kBlurred = 0.3;
  if (sweeps.empty()) {
    return fail(ErrorCode::invalid_argument, "no sweep to estimate a sensor model from");
  }
  const std::vector<CloudView> some = chosen(sweeps, options.max_points);
  const bool use_ring =
      options.use_ring && std::all_of(some.begin(), some.end(),
                                      [](const CloudView& sweep) { return sweep.ring.present(); });
  auto estimate = estimate_still(some, use_ring, options);
  const auto blur = [](const Result<SensorEstimate>& e) { return e ? e->residuals.blur : 1.0; };
  if (options.undo_motion && blur(estimate) > kCrisp) {
    auto straight = estimate_deskewed(some, options);
    if (blur(straight) < 0.5 * blur(estimate)) estimate = std::move(straight);
  }
  if (estimate && estimate->residuals.blur > kBlurred) {
    const auto percent = std::lround(100.0 * estimate->residuals.share_5cm);
    return fail(ErrorCode::unsupported,
                "these points do not lie on the beams of a spinning LiDAR: the best model has " +
                    std::to_string(percent) +
                    " % of them within 5 cm, and its beams are hardly crisper than chance");
  }
  if (estimate && !estimate->motions.empty()) fill_motions(sweeps, *estimate);
  return estimate;
}

}  // namespace sweepcast
