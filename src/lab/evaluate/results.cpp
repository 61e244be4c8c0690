#include "lab/evaluate/results.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace sweepcast::lab {
namespace {

using nlohmann::ordered_json;

/// Keys that are always there.
constexpr std::array<std::string_view, 10> kKeys{"translation_error_percent",
                                                 "rotation_error_deg_per_m",
                                                 "step_translation_m",
                                                 "mesh_f10",
                                                 "mesh_f10_truth",
                                                 "bev_ap50",
                                                 "bev_ap70",
                                                 "f_score",
                                                 "d1_psnr",
                                                 "d2_psnr"};

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

/// Under its name; one with a dot under two.
void put(ordered_json& row, const Figure& figure) {
  const std::size_t dot = figure.name.find('.');
  if (dot == std::string::npos) {
    row[figure.name] = number(figure.value);
  } else {
    row[figure.name.substr(0, dot)][figure.name.substr(dot + 1)] = number(figure.value);
  }
}

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : std::string();
}

std::string in_quotes(std::string_view text) {
  std::string cell = "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c;
  }
  return cell + '"';
}

/// The names of all figures, in the order in which they come first.
std::vector<std::string> figure_names(std::span<const EvaluationRow> rows) {
  std::vector<std::string> names;
  for (const EvaluationRow& row : rows) {
    for (const Figure& figure : row.figures) {
      if (std::find(names.begin(), names.end(), figure.name) == names.end()) {
        names.push_back(figure.name);
      }
    }
  }
  return names;
}

}  // namespace

ordered_json results_json(std::span<const EvaluationRow> rows) {
  ordered_json results = ordered_json::array();
  for (const EvaluationRow& row : rows) {
    ordered_json object{{"codec", row.codec},
                        {"setting", row.setting},
                        {"ratio", number(row.coding.ratio)},
                        {"bytes", number(row.coding.bytes)},
                        {"encode_ms", number(row.coding.encode_ms)},
                        {"decode_ms", number(row.coding.decode_ms)}};
    for (const std::string_view key : kKeys) object[std::string(key)] = nullptr;
    for (const Figure& figure : row.figures) put(object, figure);
    results.push_back(std::move(object));
  }
  return results;
}

std::string results_csv(std::span<const EvaluationRow> rows) {
  const std::vector<std::string> names = figure_names(rows);
  std::string text = "codec,setting,ratio,bytes,encode_ms,decode_ms";
  for (const std::string& name : names) text += "," + name;
  text += "\n";
  for (const EvaluationRow& row : rows) {
    const Coding& coding = row.coding;
    text += fmt::format("{},{},{},{},{},{}", in_quotes(row.codec), in_quotes(row.setting),
                        cell(coding.ratio), cell(coding.bytes), cell(coding.encode_ms),
                        cell(coding.decode_ms));
    for (const std::string& name : names) text += "," + cell(row.figure(name));
    text += "\n";
  }
  return text;
}

std::string parts_csv(std::span<const EvaluationRow> rows) {
  std::string text = "codec,setting,part,bytes\n";
  for (const EvaluationRow& row : rows) {
    for (const auto& [part, bytes] : row.coding.parts) {
      text += fmt::format("{},{},{},{}\n", in_quotes(row.codec), in_quotes(row.setting),
                          in_quotes(part), cell(bytes));
    }
  }
  return text;
}

}  // namespace sweepcast::lab
