// Results of earlier runs, by what they depend on.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// A folder with a file a result. Several threads and programs may use one folder at a time.
class ResultCache {
 public:
  /// Makes the folder where there is none. Errors: io.
  [[nodiscard]] static Result<ResultCache> open(std::filesystem::path folder);

  enum class State { absent, damaged, found };

  /// What was kept under a key; `value` is empty unless it was found. A file that is cut, changed
  /// or another key's is no result.
  State load(std::string_view key, nlohmann::ordered_json& value) const;

  /// Keeps a result: whole, or not at all. Numbers must be finite. Errors: io.
  [[nodiscard]] Status store(std::string_view key, const nlohmann::ordered_json& value) const;

  /// The file of a key.
  [[nodiscard]] std::filesystem::path file_of(std::string_view key) const;

 private:
  explicit ResultCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path folder_;
};

}  // namespace sweepcast::lab
