// A recording in a fresh folder, for tests of the viewer.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "codec/beam/sensor.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/sweep_file.hpp"
#include "view/recording.hpp"

namespace sweepcast::test {

inline PointCloud decoded(std::span<const std::byte> frame) {
  Decoder decoder;
  PointCloud cloud;
  const Status status = decoder.decode(frame, cloud);
  EXPECT_TRUE(status) << status.error().message;
  return cloud;
}

inline void expect_same(const PointCloud& a, const PointCloud& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.ring, b.ring);
}

class RecordingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "sweepcast-view-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    std::filesystem::create_directories(folder_ / "rover");
    auto writer = SweepWriter::open(file(), SweepWriter::Mode::convert);
    ASSERT_TRUE(writer);
    // Only the first frame has the sensor's model.
    auto encoder = Encoder::create(beam_options(0.05, 100));
    Decoder decoder;
    for (std::uint32_t i = 0; i < kFrames; ++i) {
      clouds_.push_back(spinning_sweep(16, 360, i + 1));
      for (std::size_t k = 0; k < clouds_.back().size(); ++k) {
        clouds_.back().intensity.push_back(static_cast<float>(k % 100));
      }
      const auto frame = encoder->encode(clouds_.back(), {i, i * 100'000'000LL, "roof"});
      ASSERT_TRUE(frame);
      ASSERT_TRUE(writer->append(*frame, "00000" + std::to_string(i)));
      ASSERT_TRUE(decoder.decode(*frame, native_.emplace_back()));
    }
    ASSERT_TRUE(writer->close());
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  [[nodiscard]] std::filesystem::path file() const { return folder_ / "rover" / "roof.sweep"; }

  /// Writes cloud `i` as the original of frame `i`.
  [[nodiscard]] std::filesystem::path write_original(std::size_t i) const {
    auto path = folder_ / ("00000" + std::to_string(i) + ".bin");
    EXPECT_TRUE(write_cloud(path, clouds_[i], CloudFormat::bin));
    return path;
  }

  [[nodiscard]] std::unique_ptr<view::Recording> open(
      const std::vector<std::filesystem::path>& originals = {}) const {
    auto recording = view::open_sweep_files({file()}, originals);
    EXPECT_TRUE(recording) << recording.error().message;
    return recording ? std::move(*recording) : nullptr;
  }

  /// Flips a byte in the middle of a frame.
  void damage(std::size_t frame) const {
    const auto entry = SweepReader::open(file())->entries()[frame];
    const auto at = static_cast<std::streamoff>(entry.offset + entry.size / 2);
    std::fstream stream(file(), std::ios::binary | std::ios::in | std::ios::out);
    stream.seekg(at);
    const char byte = static_cast<char>(stream.get() ^ 0x55);
    stream.seekp(at);
    stream.put(byte);
  }

  static constexpr std::uint32_t kFrames = 5;
  std::filesystem::path folder_;
  std::vector<PointCloud> clouds_;  ///< as they were
  std::vector<PointCloud> native_;  ///< as decoding the file in order gives them
};

}  // namespace sweepcast::test
