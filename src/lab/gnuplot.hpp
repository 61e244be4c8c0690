// Plots are drawn by the gnuplot program.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Text between double quotes as gnuplot reads it.
[[nodiscard]] std::string gnuplot_string(std::string_view text);

/// The lines that make gnuplot draw what this file will be, a .png or .svg, of a size in pixels.
[[nodiscard]] std::string plot_output(const std::filesystem::path& output, int width, int height);

/// Whether a plot can be drawn into this file. Errors: invalid_argument (extension other than .png
/// or .svg), not_found (no gnuplot on this machine), io (the file cannot be written).
[[nodiscard]] Status check_plot(const std::filesystem::path& output);

/// Runs a script that begins with `plot_output`; the file is there whole or not at all. Errors:
/// those of `check_plot`, io (gnuplot failed).
[[nodiscard]] Status draw_plot(const std::string& script, const std::filesystem::path& output);

}  // namespace sweepcast::lab
