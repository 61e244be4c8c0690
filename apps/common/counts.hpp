// Where the points of sweeps went, for people and for programs.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "codec/frame_edit.hpp"
#include "sweepcast/frame.hpp"

namespace sweepcast::app {

/// A field of `SweepCounts`: its key in JSON, and the words that follow its number in a sentence.
struct CountField {
  std::string_view key;
  std::string_view words;
  std::uint32_t SweepCounts::*value;
};

/// Every field; the first two are the points that came in and that were coded, the others say why
/// the rest was not.
inline constexpr std::array<CountField, 8> kCountFields{{
    {"points_in", "points in", &SweepCounts::points_in},
    {"points_coded", "coded", &SweepCounts::points_coded},
    {"not_finite", "not finite", &SweepCounts::not_finite},
    {"zero_range", "at range zero", &SweepCounts::zero_range},
    {"cropped", "cropped", &SweepCounts::cropped},
    {"out_of_view", "out of view", &SweepCounts::out_of_view},
    {"collided", "in a cell that another point won", &SweepCounts::collided},
    {"thinned", "thinned", &SweepCounts::thinned},
}};

/// Sums over sweeps, in the order of `kCountFields`.
class CountSums {
 public:
  void add(const SweepCounts& counts);
  [[nodiscard]] std::uint64_t points_in() const { return sums_[0]; }
  [[nodiscard]] std::uint64_t points_coded() const { return sums_[1]; }
  [[nodiscard]] std::uint64_t thinned() const { return sums_.back(); }

  /// Why points are missing, as in "3 not finite, 12 out of view"; "none" where nothing is missing.
  [[nodiscard]] std::string losses() const;
  /// An object with every field's key.
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  std::array<std::uint64_t, kCountFields.size()> sums_{};
};

/// The sums of a single sweep.
[[nodiscard]] CountSums sums_of(const SweepCounts& counts);

/// Layers that a link cut off, over the frames of a file.
struct LayerSums {
  std::uint64_t frames = 0;
  std::uint64_t frames_cut = 0;  ///< of these, with fewer layers than the encoder made
  std::uint64_t made = 0;        ///< layers, by the encoder
  std::uint64_t missing = 0;     ///< of these

  void add(const LayerCounts& layers);
  /// "3 of 10 frames lack layers, 7 of 50 in all: ..."; empty where none is missing.
  [[nodiscard]] std::string text() const;
};

/// True where `points_in` is the sum of all the others, as it must be.
[[nodiscard]] bool add_up(const SweepCounts& counts);

/// "1 frame", "2 frames".
[[nodiscard]] std::string count_of(std::uint64_t count, std::string_view noun);

/// Compression as the paper counts it: 16 bytes for each point that came in, over `bytes`.
/// 0 where there are no bytes.
[[nodiscard]] double ratio(std::uint64_t points_in, std::uint64_t bytes);

}  // namespace sweepcast::app
