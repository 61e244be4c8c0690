// The detectors by name, with the weights that come with the program.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "lab/detect/detector.hpp"

namespace sweepcast::app {

/// The weights that the project ships: beside this program, in the build tree as where installed.
[[nodiscard]] std::filesystem::path shipped_weights();

/// Makes "pillars" or "clusters"; `weights` are for the former, and where empty, those
/// shipped are taken. Errors: those of the detectors' own makers.
[[nodiscard]] Result<std::unique_ptr<lab::Detector>> make_detector(
    const std::string& name, const std::filesystem::path& weights);

}  // namespace sweepcast::app
