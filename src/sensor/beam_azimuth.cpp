#include "sensor/beam_azimuth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "core/trig.hpp"
#include "sensor/held_firings.hpp"

namespace sweepcast {
namespace {

// Encoders and column counts of spinning LiDARs, and other round numbers.
constexpr std::array kEncoders{360,  400,  450,  500,  512,  600,   720,   800,   900,
                               1000, 1024, 1200, 1440, 1500, 1600,  1800,  2000,  2048,
                               2250, 2400, 2500, 2880, 3000, 3600,  4000,  4096,  4500,
                               5000, 6000, 7200, 8192, 9000, 10000, 12000, 18000, 36000};

struct Sample {
  double turn, inverse_rho;
};

// One beam's samples of all sweeps, at most `cap`, evenly thinned.
std::vector<std::vector<Sample>> by_beam(std::span<const BeamSamples> sweeps, std::size_t beams) {
  std::vector<std::vector<Sample>> samples(beams);
  for (const BeamSamples& sweep : sweeps) {
    for (std::size_t i = 0; i < sweep.size(); ++i) {
      samples[sweep.beam[i]].push_back({sweep.turn[i], sweep.inverse_rho[i]});
    }
  }
  return samples;
}

// Mean phasor of the samples' positions between ticks. Far points weigh more: coordinates are
// rounded, so that the azimuths of near ones are coarse.
std::complex<double> phasor(std::span<const Sample> samples, double ticks, double lateral) {
  double re = 0.0;
  double im = 0.0;
  double weights = 0.0;
  for (const Sample& s : samples) {
    const double phase = ticks * (s.turn - lateral * s.inverse_rho / kTwoPi);
    const double weight = 1.0 / (s.inverse_rho + 0.1);
    const SinCos at = unit_phasor(wrap(phase));
    re += weight * at.cos;
    im += weight * at.sin;
    weights += weight;
  }
  return weights > 0.0 ? std::complex<double>(re, im) / weights : 0.0;
}

std::vector<Sample> thinned(std::span<const Sample> samples, std::size_t cap) {
  std::vector<Sample> some;
  const std::size_t step = samples.size() / cap + 1;
  for (std::size_t i = 0; i < samples.size(); i += step) some.push_back(samples[i]);
  return some;
}

// The lateral offset of highest coherence, on a grid; 0 unless another is clearly better.
double search_lateral(std::span<const Sample> samples, double ticks) {
  constexpr double kStep = 0.003;
  double best = std::abs(phasor(samples, ticks, 0.0)) * 1.03;
  double lateral = 0.0;
  for (int i = -25; i <= 25; ++i) {
    const double here = std::abs(phasor(samples, ticks, i * kStep));
    if (here > best) {
      best = here;
      lateral = i * kStep;
    }
  }
  return lateral;
}

BeamAzimuth fit_beam(std::span<const Sample> samples, double ticks, bool search) {
  BeamAzimuth fit;
  if (samples.empty()) return fit;
  if (search) fit.lateral_m = search_lateral(thinned(samples, 600), ticks);
  fit.phase = std::arg(phasor(samples, ticks, fit.lateral_m)) / kTwoPi;
  // Least squares of the wrapped phase over 1 and 1/rho; robust against points between ticks. A
  // weak pull keeps the lateral offset of a beam that sees one distance.
  for (int round = 0; round < 4; ++round) {
    double w = 0, q = 0, qq = 1e-4, e = 0, qe = 0;
    for (const Sample& s : samples) {
      const double model = fit.phase + ticks * fit.lateral_m * s.inverse_rho / kTwoPi;
      const double miss = wrap(ticks * s.turn - model);
      const double weight = 1.0 / ((s.inverse_rho + 0.1) * (1.0 + 60.0 * miss * miss));
      w += weight;
      q += weight * s.inverse_rho;
      qq += weight * s.inverse_rho * s.inverse_rho;
      e += weight * miss;
      qe += weight * s.inverse_rho * miss;
    }
    const double det = w * qq - q * q;
    if (det < 1e-6 * w * qq) break;
    fit.phase += (e * qq - q * qe) / det;
    fit.lateral_m += (w * qe - q * e) / det * kTwoPi / ticks;
  }
  fit.phase = wrap(fit.phase);
  fit.coherence = std::abs(phasor(samples, ticks, fit.lateral_m));
  return fit;
}

// 95th percentile of the sideways distance to the nearest tick, metres.
double sideways_error(std::span<const Sample> samples, double ticks, const BeamAzimuth& fit) {
  std::vector<double> errors;
  for (const Sample& s : samples) {
    const double model = fit.phase + ticks * fit.lateral_m * s.inverse_rho / kTwoPi;
    errors.push_back(std::abs(wrap(ticks * s.turn - model)) / ticks * kTwoPi / s.inverse_rho);
  }
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() * 95 / 100);
  std::nth_element(errors.begin(), at, errors.end());
  return errors.empty() ? 0.0 : *at;
}

// Finds lags: every beam's ticks, shifted by its lag, should fall on those of the others.
class LagFinder {
 public:
  LagFinder(std::span<const BeamSamples> sweeps, int ticks_per_turn, std::span<BeamAzimuth> beams)
      : beams_(beams), turn_(ticks_per_turn), reach_(static_cast<int>(turn_ * kMaxLagTurns)) {
    for (const BeamSamples& sweep : sweeps) {
      fired_.emplace_back(static_cast<std::size_t>(turn_), 0);
      auto& own = ticks_.emplace_back(beams.size());
      for (std::size_t i = 0; i < sweep.size(); ++i) {
        const BeamAzimuth& beam = beams[sweep.beam[i]];
        const double lateral = beam.lateral_m * sweep.inverse_rho[i] / kTwoPi;
        const double at = turn_ * (sweep.turn[i] - lateral) - beam.phase;
        own[sweep.beam[i]].push_back(wrapped(static_cast<int>(std::lround(at))));
      }
    }
  }

  // Adds a beam's ticks to the firings, or takes them away.
  void count(std::size_t k, int weight) {
    for (std::size_t n = 0; n < fired_.size(); ++n) {
      for (const int tick : ticks_[n][k]) {
        fired_[n][static_cast<std::size_t>(wrapped(tick - beams_[k].lag))] += weight;
      }
    }
  }

  // The lag that takes most ticks to firings; of several, the smallest. That many beams fired
  // counts for no more than that `enough` did: where firings are at nearly equal distances the
  // scene would decide, else.
  [[nodiscard]] int best_lag(std::size_t k, int enough) const {
    std::vector<std::int64_t> score(2 * static_cast<std::size_t>(reach_) + 1, 0);
    for (std::size_t n = 0; n < fired_.size(); ++n) {
      const std::vector<int>& fired = fired_[n];
      struct Firing {
        int tick, weight;
      };
      std::vector<Firing> occupied;  // a turn and the reach beyond either end
      for (int tick = -reach_; tick < turn_ + reach_; ++tick) {
        const int beams = fired[static_cast<std::size_t>(wrapped(tick))];
        if (beams != 0) occupied.push_back({tick, std::min(beams, enough)});
      }
      const auto& own = ticks_[n][k];
      const std::size_t step = own.size() / 1500 + 1;
      for (std::size_t i = 0; i < own.size(); i += step) {
        const int at = wrapped(own[i]);
        for (auto near =
                 std::lower_bound(occupied.begin(), occupied.end(), at - reach_,
                                  [](const Firing&firing, int tick) { return firing.tick < tick; });
             near != occupied.end() && near->tick <= at + reach_; ++near) {
          score[index(at - near->tick)] += near->weight;
        }
      }
    }
    const std::int64_t most = *std::max_element(score.begin(), score.end());
    for (int lag = 0; lag <= reach_; ++lag) {
      if (score[index(lag)] == most) return lag;
      if (score[index(-lag)] == most) return -lag;
    }
    return 0;
  }

  // Ticks at which any beam fired, all sweeps together.
  [[nodiscard]] std::size_t firings() const {
    std::size_t count = 0;
    for (const auto& sweep : fired_) {
      count += sweep.size() - static_cast<std::size_t>(std::count(sweep.begin(), sweep.end(), 0));
    }
    return count;
  }

  // The ticks of each beam's points in the first sweep.
  [[nodiscard]] std::span<const std::vector<int>> ticks() const { return ticks_.front(); }

  // Beams, the one of most points first.
  [[nodiscard]] std::vector<std::size_t> order() const {
    std::vector<std::size_t> beams(beams_.size());
    for (std::size_t k = 0; k < beams.size(); ++k) beams[k] = k;
    const auto& own = ticks_.front();
    std::stable_sort(beams.begin(), beams.end(),
                     [&](std::size_t a, std::size_t b) { return own[a].size() > own[b].size(); });
    return beams;
  }

 private:
  static constexpr double kMaxLagTurns = 25.0 / 360.0;

  // Of a lag among the scores.
  [[nodiscard]] std::size_t index(int lag) const {
    return static_cast<std::size_t>(lag) + static_cast<std::size_t>(reach_);
  }

  [[nodiscard]] int wrapped(int tick) const {
    tick %= turn_;
    return tick < 0 ? tick + turn_ : tick;
  }

  std::span<BeamAzimuth> beams_;
  int turn_, reach_;
  std::vector<std::vector<int>> fired_;               // per sweep and tick: beams
  std::vector<std::vector<std::vector<int>>> ticks_;  // per sweep and beam
};

}  // namespace

std::span<const int> encoder_ticks() {
  return kEncoders;
}

int find_ticks(std::span<const BeamSamples> sweeps, std::size_t beams) {
  auto samples = by_beam(sweeps, beams);
  std::stable_sort(samples.begin(), samples.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  samples.resize(std::min<std::size_t>(samples.size(), 5));
  for (auto& beam : samples) beam = thinned(beam, 1500);
  std::array<double, kEncoders.size()> errors{};
  double best = 1e9;
  for (std::size_t c = 0; c < kEncoders.size(); ++c) {
    double coherence = 0.0;
    for (const auto& beam : samples) {
      const BeamAzimuth fit = fit_beam(beam, kEncoders[c], true);
      coherence += fit.coherence / static_cast<double>(samples.size());
      errors[c] += sideways_error(beam, kEncoders[c], fit) / static_cast<double>(samples.size());
    }
    // A fine tick is near to any azimuth: only coherence tells that it means something.
    if (coherence < 0.5) errors[c] = 1e9;
    best = std::min(best, errors[c]);
  }
  if (best > 1e8) return 0;
  for (std::size_t c = 0; c < kEncoders.size(); ++c) {
    if (errors[c] <= 1.2 * best + 2e-4) return kEncoders[c];
  }
  return 0;
}

std::vector<BeamAzimuth> fit_azimuths(std::span<const BeamSamples> sweeps, std::size_t beams,
                                      int ticks_per_turn) {
  std::vector<BeamAzimuth> fits;
  for (const auto& samples : by_beam(sweeps, beams)) {
    fits.push_back(fit_beam(samples, ticks_per_turn, true));
  }
  return fits;
}

void fit_lags(std::span<const BeamSamples> sweeps, int ticks_per_turn,
              std::span<BeamAzimuth> beams) {
  constexpr std::size_t kSweeps = 3;
  LagFinder finder(sweeps.first(std::min(sweeps.size(), kSweeps)), ticks_per_turn, beams);
  const std::vector<std::size_t> order = finder.order();
  finder.count(order.front(), 1);
  for (std::size_t i = 1; i < order.size(); ++i) {
    beams[order[i]].lag = finder.best_lag(order[i], static_cast<int>(beams.size()));
    finder.count(order[i], 1);
  }
  // The first ones had little to go by. What serves one sensor does not serve all: the lags that
  // leave the fewest firings are kept.
  const int all = static_cast<int>(beams.size());
  std::vector<BeamAzimuth> best(beams.begin(), beams.end());
  std::size_t fewest = finder.firings();
  for (const int enough : {all, std::max(2, all / 4), std::max(2, all / 4)}) {
    for (const std::size_t k : order) {
      finder.count(k, -1);
      beams[k].lag = finder.best_lag(k, enough);
      finder.count(k, 1);
    }
    if (finder.firings() < fewest) {
      fewest = finder.firings();
      std::copy(beams.begin(), beams.end(), best.begin());
    }
  }
  std::copy(best.begin(), best.end(), beams.begin());
}

void split_lags(std::span<const BeamSamples> sweeps, int ticks_per_turn, HeldFit fit,
                std::span<BeamAzimuth> beams) {
  const LagFinder finder(sweeps.first(1), ticks_per_turn, beams);
  std::vector<std::int32_t> lags;
  for (const BeamAzimuth& beam : beams) lags.push_back(beam.lag);
  const auto interpolated = fit == HeldFit::some_beams
                                ? fit_interpolation(finder.ticks(), lags, ticks_per_turn)
                                : fit_scattered_holds(finder.ticks(), lags, ticks_per_turn);
  for (std::size_t k = 0; k < beams.size(); ++k) {
    beams[k].lag = lags[k];
    beams[k].interpolated = interpolated[k];
  }
}

}  // namespace sweepcast
