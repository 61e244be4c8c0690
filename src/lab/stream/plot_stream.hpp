// A stream over time, drawn by the gnuplot program: the paper's Fig. 6.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "lab/gnuplot.hpp"
#include "lab/stream/compare.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// What gnuplot is told, data included: four panels over time, each second's mean: the bandwidth,
/// the quality q of equation 5, the frames in the queue (logarithmic) and the QoE of a sweep; one
/// curve a strategy.
[[nodiscard]] std::string stream_script(std::span<const Stream> streams, const Trace& trace,
                                        const std::filesystem::path& output);

/// Runs the script. Errors: those of `draw_plot`.
[[nodiscard]] Status plot_streams(std::span<const Stream> streams, const Trace& trace,
                                  const std::filesystem::path& output);

}  // namespace sweepcast::lab
