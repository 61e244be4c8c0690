#include "lab/detect/boxes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "io/file.hpp"
#include "io/text.hpp"

namespace sweepcast::lab {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 26U;

std::optional<Box> parse_box(std::string_view line) {
  const std::vector<std::string_view> words = words_of(line);
  if (words.size() != 9 && words.size() != 10) return {};
  std::array<double, 7> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = number_of<double>(words[i + 1]);
    if (!number || !(std::abs(*number) <= 1e4)) return {};
    numbers[i] = *number;
  }
  const auto points = number_of<int>(words[8]);
  const auto score = words.size() == 10 ? number_of<double>(words[9]) : 1.0;
  if (!points || !score || !std::isfinite(*score)) return {};
  Box box;
  box.label = words[0];
  box.centre = {numbers[0], numbers[1], numbers[2]};
  box.length = numbers[3];
  box.width = numbers[4];
  box.height = numbers[5];
  box.yaw = numbers[6];
  box.points = *points;
  box.score = *score;
  const bool has_size = box.length > 0.0 && box.width > 0.0 && box.height > 0.0;
  return has_size ? std::optional(box) : std::nullopt;
}

}  // namespace

Result<std::vector<Box>> parse_boxes(std::string_view text, const std::string& name) {
  std::vector<Box> boxes;
  LineReader lines(text);
  while (const auto line = lines.next()) {
    if (words_of(*line).empty()) continue;
    auto box = parse_box(*line);
    if (!box) {
      return fail(ErrorCode::corrupt,
                  fmt::format("{}: line {} is no box; give label, x, y, z, length, width, height, "
                              "yaw, points, and a score where there is one",
                              name, lines.line()));
    }
    boxes.push_back(std::move(*box));
  }
  return boxes;
}

Result<std::vector<Box>> read_boxes(const std::filesystem::path& file) {
  std::vector<std::byte> bytes;
  if (Status read = read_file(file, kMostBytes, bytes); !read) return tl::unexpected(read.error());
  return parse_boxes(as_text(bytes), file.string());
}

Status write_boxes(const std::filesystem::path& file, std::span<const Box> boxes) {
  std::string text;
  for (const Box& box : boxes) {
    fmt::format_to(std::back_inserter(text),
                   "{} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {} {:.4f}\n", box.label,
                   box.centre.x(), box.centre.y(), box.centre.z(), box.length, box.width,
                   box.height, box.yaw, box.points, box.score);
  }
  return write_file(file, std::as_bytes(std::span(text)));
}

void count_points(const PointCloud& cloud, std::span<Box> boxes) {
  constexpr double kGround = 0.1;  // metres
  for (Box& box : boxes) {
    const double cosine = std::cos(box.yaw), sine = std::sin(box.yaw);
    const double floor = -0.5 * box.height + std::min(kGround, 0.5 * box.height);
    box.points = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double x = static_cast<double>(cloud.x[i]) - box.centre.x();
      const double y = static_cast<double>(cloud.y[i]) - box.centre.y();
      const double z = static_cast<double>(cloud.z[i]) - box.centre.z();
      const bool inside = std::abs(cosine * x + sine * y) <= 0.5 * box.length &&
                          std::abs(cosine * y - sine * x) <= 0.5 * box.width && z >= floor &&
                          z <= 0.5 * box.height;
      box.points += inside ? 1 : 0;
    }
  }
}

}  // namespace sweepcast::lab
