// Finds the quality at which a sweep fits a number of bytes.
#pragma once

#include <cstddef>
#include <optional>

namespace sweepcast {

/// Tries levels until one lands under the budget by little. Sizes fall with the level, about
/// exponentially; what one sweep needed is where the next begins. Use:
///   for (double level = budget.begin(); ; level = *next) {
///     encode at `level`
///     next = budget.next(size)
///     if (!next) break;
///   }
///   and encode once more at `best()` where that is not the level tried last.
class ByteBudget {
 public:
  explicit ByteBudget(std::size_t bytes) : target_(static_cast<double>(bytes)) {}

  /// Changes the budget, from the next sweep on.
  void set_bytes(std::size_t bytes) { target_ = static_cast<double>(bytes); }

  /// Begins a sweep. Returns the first level to try.
  [[nodiscard]] double begin();

  /// The next level to try, given the size at the one before; none where that one is good enough,
  /// or trying goes on for too long.
  [[nodiscard]] std::optional<double> next(std::size_t bytes);

  /// The finest level that fits, of those tried; none where none does.
  [[nodiscard]] std::optional<double> best() const { return fits_; }

 private:
  static constexpr double kLeast = 0.97;  ///< of the budget: used well enough
  static constexpr double kAim = 0.985;
  static constexpr int kMostTries = 7;

  double target_;
  double level_ = 1.0;   ///< tried last
  double slope_ = -0.3;  ///< change of the logarithm of sizes with the level
  int tries_ = 0;
  std::optional<double> fits_, exceeds_;  ///< nearest levels on both sides of the budget
  double log_fits_ = 0.0, log_exceeds_ = 0.0;
};

}  // namespace sweepcast
