#include "common/counts.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <nlohmann/json.hpp>

namespace sweepcast::app {

void CountSums::add(const SweepCounts& counts) {
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += counts.*kCountFields[i].value;
}

std::string CountSums::losses() const {
  std::string text;
  for (std::size_t i = 2; i < sums_.size(); ++i) {
    if (sums_[i] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", sums_[i], kCountFields[i].words);
  }
  return text.empty() ? "none" : text;
}

nlohmann::ordered_json CountSums::json() const {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    object[std::string(kCountFields[i].key)] = sums_[i];
  }
  return object;
}

CountSums sums_of(const SweepCounts& counts) {
  CountSums sums;
  sums.add(counts);
  return sums;
}

void LayerSums::add(const LayerCounts& layers) {
  ++frames;
  if (layers.missing() > 0) ++frames_cut;
  made += static_cast<std::uint64_t>(layers.made);
  missing += static_cast<std::uint64_t>(layers.missing());
}

std::string LayerSums::text() const {
  if (missing == 0) return "";
  return fmt::format(
      "{} of {} lack layers, {} of {} in all: a link cut them, and they decode coarser", frames_cut,
      count_of(frames, "frame"), missing, made);
}

bool add_up(const SweepCounts& counts) {
  std::uint64_t gone = 0;
  for (std::size_t i = 1; i < kCountFields.size(); ++i) gone += counts.*kCountFields[i].value;
  return gone == counts.points_in;
}

std::string count_of(std::uint64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

double ratio(std::uint64_t points_in, std::uint64_t bytes) {
  constexpr double kBytesPerPoint = 16.0;
  return bytes == 0 ? 0.0
                    : kBytesPerPoint * static_cast<double>(points_in) / static_cast<double>(bytes);
}

}  // namespace sweepcast::app
