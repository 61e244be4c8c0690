// Rate-distortion plots, drawn by the gnuplot program.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "lab/bench.hpp"
#include "lab/gnuplot.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// What gnuplot is told, data included: three panels, D2 PSNR and the F-scores at 5 and 10 cm over
/// the ratio (logarithmic), one curve a codec with its settings marked. Rows without a finite
/// figure are left out of that panel.
[[nodiscard]] std::string rate_distortion_script(std::span<const BenchRow> rows,
                                                 const std::filesystem::path& output);

/// Runs the script. Errors: those of `check_plot`, invalid_argument (no rows), io (gnuplot failed).
[[nodiscard]] Status plot_rate_distortion(std::span<const BenchRow> rows,
                                          const std::filesystem::path& output);

}  // namespace sweepcast::lab
