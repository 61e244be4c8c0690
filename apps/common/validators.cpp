#include "common/validators.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>

namespace sweepcast::app {
namespace {

/// Whether all of `text` is a number of this type, which is then in `value`.
template <class Number>
bool parse(const std::string& text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && rest == end;
}

}  // namespace

CLI::Validator number_between(double min, double max) {
  const auto check = [min, max](const std::string& text) {
    double value = 0.0;
    const bool in_range = parse(text, value) && value >= min && value <= max;
    return in_range ? std::string()
                    : fmt::format("{} is not a number from {:.10g} to {:.10g}", text, min, max);
  };
  return {check, ""};
}

CLI::Validator whole_number() {
  const auto check = [](const std::string& text) {
    std::uint64_t value = 0;
    return parse(text, value) ? std::string()
                              : fmt::format("{} is not a whole number from 0 to 2^64 - 1", text);
  };
  return {check, ""};
}

CLI::Validator items_of(const std::vector<std::string>& words) {
  const auto check = [words](const std::string& text) {
    const bool is_known = std::find(words.begin(), words.end(), text) != words.end();
    return is_known ? std::string()
                    : fmt::format("\"{}\" is not one of {}; commas separate several", text,
                                  fmt::join(words, ", "));
  };
  return {check, ""};
}

}  // namespace sweepcast::app
