// Lines, words and numbers of text, whatever the locale.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <vector>

namespace sweepcast {

/// Bytes as characters.
[[nodiscard]] inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Takes lines off the front of a text. Lines end with LF or CR LF.
class LineReader {
 public:
  /// `line` is the number of the line before the first one here.
  explicit LineReader(std::string_view text, std::size_t line = 0) : rest_(text), line_(line) {}

  /// The next line without its end; none at the end of the text.
  [[nodiscard]] std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++line_;
    return line;
  }

  /// Number of the line that `next` gave last, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }
  /// What follows that line.
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t line_;
};

/// Takes the next word off the front of a line; empty at its end. Blanks and tabs part words.
[[nodiscard]] inline std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\v\f\r";
  const std::size_t begin = line.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  line.remove_prefix(begin);
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

/// All words of a line.
[[nodiscard]] inline std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto word = next_word(line); !word.empty(); word = next_word(line)) words.push_back(word);
  return words;
}

/// A whole word as a number; none where it is not one, or does not fit the type.
template <class T>
[[nodiscard]] std::optional<T> number_of(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace sweepcast
