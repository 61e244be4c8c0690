// What the tests of files share.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::test {

/// A fresh folder, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("sweepcast_") + test->name() + "_" + std::to_string(::getpid());
    for (char& c : name) c = c == '/' ? '_' : c;
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const {
    return path_ / name;
  }
  /// Names of what is in the folder, sorted.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  std::filesystem::path path_;
};

inline std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

inline void write_bytes(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  ASSERT_TRUE(out.good()) << path;
}

inline void write_text(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::create_directories(path.parent_path());
  write_bytes(path, std::as_bytes(std::span(text)));
}

inline std::vector<std::byte> read_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return bytes_of(text);
}

/// A cloud with every column, its first time 0.
inline PointCloud random_cloud(std::size_t count, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> metres(-80.0F, 80.0F);
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.x.push_back(metres(random));
    cloud.y.push_back(metres(random));
    cloud.z.push_back(metres(random) * 0.1F);
    cloud.intensity.push_back(static_cast<float>(random() % 256) / 255.0F);
    cloud.ring.push_back(static_cast<std::uint16_t>(random() % 128));
    cloud.time_ns.push_back(i == 0 ? 0 : static_cast<std::int64_t>(random() % 100'000'000));
  }
  return cloud;
}

inline void expect_equal(const PointCloud& a, const PointCloud& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.ring, b.ring);
  EXPECT_EQ(a.time_ns, b.time_ns);
}

/// The error must be of this code, and its message must contain `part`.
inline void expect_error(const Status& status, ErrorCode code, std::string_view part) {
  ASSERT_FALSE(status.has_value()) << "expected an error with: " << part;
  EXPECT_EQ(name(status.error().code), name(code)) << status.error().message;
  EXPECT_NE(status.error().message.find(part), std::string::npos) << status.error().message;
}

template <class T>
Status status_of(const Result<T>& result) {
  if (result) return {};
  return tl::unexpected<Error>(result.error());
}

}  // namespace sweepcast::test
