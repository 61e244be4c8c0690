// Results for programs: JSON and CSV. docs/evaluate.md has the keys.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "lab/evaluate/evaluate.hpp"

namespace sweepcast::lab {

/// An array with an object a row: codec, setting, ratio, bytes, encode_ms, decode_ms, and every
/// figure; null where a task was left out or a number is not finite.
[[nodiscard]] nlohmann::ordered_json results_json(std::span<const EvaluationRow> rows);

/// The same as a table; cells are empty where the JSON has null.
[[nodiscard]] std::string results_csv(std::span<const EvaluationRow> rows);

/// Mean bytes of each part of our codecs' frames: codec, setting, part, bytes.
[[nodiscard]] std::string parts_csv(std::span<const EvaluationRow> rows);

}  // namespace sweepcast::lab
