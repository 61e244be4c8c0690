// Codecs and tasks on one drive: every codec at every setting, by every task; in parallel, and not
// again what an earlier run has measured.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lab/evaluate/cache.hpp"
#include "lab/evaluate/drive.hpp"
#include "lab/evaluate/measure.hpp"
#include "lab/evaluate/settings.hpp"
#include "lab/evaluate/task.hpp"

namespace sweepcast::lab {

/// A codec at one setting.
struct EvaluationRow {
  std::string codec;
  std::string setting;
  Coding coding;
  Figures figures;  ///< of all tasks, in their order

  /// A figure by its name; NaN where there is none.
  [[nodiscard]] double figure(std::string_view name) const;
};

struct Evaluation {
  std::vector<EvaluationRow> rows;  ///< in the order of the settings; failed ones are missing
  std::vector<Error> failures;      ///< settings and tasks that failed; messages name them
  std::size_t measured = 0;         ///< settings of tasks, and codings, that were measured
  std::size_t kept = 0;             ///< the same, had from an earlier run
  std::size_t damaged = 0;          ///< of those measured: a damaged result was kept
};

struct EvaluateOptions {
  std::string version;  ///< of the program: results of another one are not taken
  int threads = 0;      ///< settings measured at a time; 0: one a core
  bool fresh = false;   ///< takes no earlier result
  /// Called before the first and after each sweep of each setting, by one thread at a time.
  std::function<void(std::size_t done, std::size_t total, std::string_view what)> on_progress;
};

/// Measures. A setting is kept in the cache as soon as it is done; one that fails is told among
/// the failures, and costs the others nothing. Errors: io (a result cannot be kept).
[[nodiscard]] Result<Evaluation> evaluate(const DriveFiles& drive, const Peers& peers,
                                          const Tasks& tasks, const ResultCache& cache,
                                          const EvaluateOptions& options);

}  // namespace sweepcast::lab
