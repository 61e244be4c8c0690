// The options that choose and tune a codec, the same for every command that encodes.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "sweepcast/encoder.hpp"

namespace sweepcast::app {

/// The words that --effort takes.
[[nodiscard]] const std::map<std::string, Effort>& effort_words();

/// Adds --codec, --level, --params and what else tunes the coding. Parsing fills `options`, which
/// must outlive the program's parsing.
void add_codec_options(CLI::App& app, EncoderOptions& options);

/// Adds --crop-range, --crop-box and --crop-robot.
void add_crop_options(CLI::App& app, Crop& crop);

/// To be called when parsing is over: throws CLI::ValidationError where an option was given that
/// the chosen codec does not have.
void require_matching(const CLI::App& app, const EncoderOptions& options);

/// To be called when parsing is over: throws CLI::ValidationError where an encoder cannot be made
/// with these options, so that the command line is refused before any work begins.
void require_valid(const EncoderOptions& options);

}  // namespace sweepcast::app
