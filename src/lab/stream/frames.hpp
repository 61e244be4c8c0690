// The frames that a simulated stream sends: sizes of their layers, and what each prefix is worth.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include "sweepcast/frame.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// One frame, or a prefix of its layers. The settings of a set of frames are those of the ladder,
/// finest first, then those of byte budgets, largest first.
struct FrameKey {
  std::size_t sweep = 0;
  std::size_t setting = 0;
  std::size_t layers = 0;  ///< at least 1

  // clang-tidy 14 mistakes the comparison with 0 for one with a pointer.
  [[nodiscard]] auto operator<=>(const FrameKey&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// How near a decoded sweep is to the original, what was left out filled in.
struct SweepQuality {
  double f10 = 0.0;  ///< F-score at 10 cm, per cent
  double d2 = 0.0;   ///< D2 PSNR, dB
};

/// The sizes of one frame, bytes.
struct FrameSize {
  std::vector<std::size_t> layer_ends;  ///< what comes before the layers counts to the first
  std::size_t model = 0;                ///< what is more where the frame carries the sensor's model
};

/// Sizes of all sweeps at all settings, and measured qualities.
struct FrameSet {
  CodecId codec = CodecId::beam;
  std::size_t ladder = 0;  ///< settings of the ladder
  /// [setting]: bytes aimed at; 0 for settings of the ladder.
  std::vector<std::size_t> target_bytes;
  std::vector<std::vector<FrameSize>> sizes;  ///< [sweep][setting]
  std::map<FrameKey, SweepQuality> qualities;

  [[nodiscard]] std::size_t sweeps() const { return sizes.size(); }
  [[nodiscard]] std::size_t settings() const { return target_bytes.size(); }
  /// What a frame of each level of the ladder takes, mean over the sweeps.
  [[nodiscard]] std::vector<std::size_t> level_bytes() const;
  /// The finest level whose F-score this one reaches, of the same sweep; none where none.
  [[nodiscard]] std::size_t level_reached(const FrameKey& key) const;
};

/// Called after each sweep.
using OnSweep = std::function<void(std::string_view)>;

/// Encodes sweeps and measures them; the same files must be there throughout.
class FrameMaker {
 public:
  FrameMaker(CodecId codec, std::vector<std::filesystem::path> sweeps)
      : codec_(codec), paths_(std::move(sweeps)) {}

  /// Encodes every sweep at every level of the codec's ladder and, where asked for and the codec
  /// has them, at `budgets` sizes, each `kBudgetStep` times smaller than the one before, from
  /// `kLargestBudget` on; those that some sweep does not fit are left out.
  /// Geometry alone is coded. Errors: those of `read_cloud` and the encoder.
  [[nodiscard]] Result<FrameSet> encode(bool with_budgets, const OnSweep& on_sweep);

  /// Measures what is not measured yet. Errors: those of `read_cloud` and the decoder.
  [[nodiscard]] Status measure(const std::set<FrameKey>& keys, FrameSet& frames,
                               const OnSweep& on_sweep) const;

  static constexpr std::size_t kLargestBudget = 45'000;
  static constexpr std::size_t kBudgets = 18;
  static constexpr double kBudgetStep = 1.2;

 private:
  CodecId codec_;
  std::vector<std::filesystem::path> paths_;
  std::vector<std::vector<std::vector<std::byte>>> bytes_;  ///< [sweep][setting]
};

}  // namespace sweepcast::lab
