// The sections of the report's page.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lab/evaluate/evaluate.hpp"

namespace sweepcast::lab {

/// Which colour and marker each codec has in every figure: beam 0, the others from 1 on.
class CodecStyles {
 public:
  explicit CodecStyles(std::span<const EvaluationRow> rows);
  [[nodiscard]] std::size_t of(const std::string& codec) const;

 private:
  std::vector<std::string> codecs_;
};

/// Whether beam is ahead of every other codec, by task and ratio.
[[nodiscard]] std::string standing_section(std::span<const EvaluationRow> rows);

/// Each figure over the ratio.
[[nodiscard]] std::string figure_section(std::span<const EvaluationRow> rows,
                                         const CodecStyles& styles);

/// The middle sweep from above, as it was and as each codec gives it back at about a hundredth.
[[nodiscard]] std::string picture_section(std::span<const EvaluationRow> rows);

/// Times of each codec at about a hundredth.
[[nodiscard]] std::string time_section(std::span<const EvaluationRow> rows);

/// Of what our frames are made.
[[nodiscard]] std::string part_section(std::span<const EvaluationRow> rows);

/// Everything, in numbers.
[[nodiscard]] std::string table_section(std::span<const EvaluationRow> rows);

}  // namespace sweepcast::lab
