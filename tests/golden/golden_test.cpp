// Frames that earlier versions wrote decode to the very same clouds, on every machine.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "golden/frames.hpp"

namespace sweepcast {
namespace {

std::vector<std::filesystem::path> golden_frames() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(SWEEPCAST_GOLDEN)) {
    if (entry.path().extension() == ".frame") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

test::Bytes read_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

TEST(Golden, FramesDecodeToTheSameClouds) {
  const auto paths = golden_frames();
  EXPECT_GE(paths.size(), 9U);
  Decoder decoder;
  PointCloud cloud;
  for (const auto& path : paths) {
    const test::Bytes frame = read_bytes(path);
    const Status decoded = decoder.decode(frame, cloud);
    ASSERT_TRUE(decoded) << path << ": " << decoded.error().message;
    std::ifstream text(std::filesystem::path(path).replace_extension(".txt"));
    std::string label;
    std::size_t points = 0;
    std::uint32_t checksum = 0;
    text >> label >> points >> label >> checksum;
    ASSERT_TRUE(text) << path;
    EXPECT_EQ(cloud.size(), points) << path;
    EXPECT_EQ(test::checksum_of(cloud), checksum) << path;
    std::uint32_t attributes = 0;  // the first frames had none
    if (text >> label >> attributes) {
      EXPECT_EQ(test::attributes_checksum_of(cloud), attributes) << path;
    }
    EXPECT_EQ(decoder.last_header().sequence, 42U);
    EXPECT_EQ(decoder.last_header().stamp_ns, 1'700'000'000'000'000'000);
    EXPECT_EQ(decoder.last_header().sensor, path.stem().string());
    EXPECT_LT(frame.size(), 4096U) << path << " is too large to keep";
  }
}

TEST(Golden, EverySourceHasItsFrame) {
  for (const test::GoldenSource& source : test::golden_sources()) {
    EXPECT_TRUE(
        std::filesystem::exists(std::filesystem::path(SWEEPCAST_GOLDEN) / (source.name + ".frame")))
        << source.name << ": run make_golden";
  }
}

}  // namespace
}  // namespace sweepcast
