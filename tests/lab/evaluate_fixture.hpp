// A folder of its own with sweeps of squares, for tests of the evaluation.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace sweepcast::lab {

class EvaluateTest : public testing::Test {
 protected:
  EvaluateTest() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "sweepcast-evaluate-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~EvaluateTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// Writes `count` sweeps, level squares of side x side points; returns their files.
  std::vector<std::filesystem::path> write_squares(int count, int side) const {
    std::vector<std::filesystem::path> sweeps;
    for (int i = 0; i < count; ++i) {
      sweeps.push_back(folder_ / ("00000" + std::to_string(i) + ".bin"));
      std::ofstream file(sweeps.back(), std::ios::binary);
      for (int k = 0; k < side * side; ++k) {
        const std::array<float, 4> point{5.0F + 0.5F * static_cast<float>(k / side),
                                         0.5F * static_cast<float>(k % side),
                                         -1.5F + 0.25F * static_cast<float>(i), 0.0F};
        file.write(reinterpret_cast<const char*>(point.data()), sizeof(point));
      }
    }
    return sweeps;
  }

  void write(const std::filesystem::path& file, const std::string& text) const {
    std::ofstream(folder_ / file, std::ios::binary) << text;
  }

  std::filesystem::path folder_;
};

}  // namespace sweepcast::lab
