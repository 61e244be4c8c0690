#include "view/recording.hpp"

#include "view/recordings.hpp"

namespace sweepcast::test {
namespace {

namespace fs = std::filesystem;

class Recordings : public RecordingTest {};

TEST_F(Recordings, EachFrameDecodesAloneAsItDoesInTheFile) {
  const auto recording = open();
  ASSERT_EQ(recording->size(), kFrames);
  for (const std::uint32_t i : {4U, 0U, 2U, 3U, 1U, 4U}) {
    const auto sweep = recording->sweep(i);
    ASSERT_TRUE(sweep) << sweep.error().message;
    EXPECT_EQ((*sweep)->index, i);
    EXPECT_EQ((*sweep)->name, "00000" + std::to_string(i));
    EXPECT_EQ((*sweep)->layers.there, 5);
    EXPECT_EQ((*sweep)->layers.made, 5);
    EXPECT_FALSE((*sweep)->has_original);
    expect_same(decoded(*(*sweep)->frame), native_[i]);
  }
  EXPECT_FALSE(recording->sweep(kFrames));
}

TEST_F(Recordings, WhatWasAskedForLatelyIsAtHand) {
  const auto recording = open();
  const auto first = recording->sweep(3);
  const auto again = recording->sweep(3);
  ASSERT_TRUE(first && again);
  EXPECT_EQ(*first, *again);
}

TEST_F(Recordings, ADamagedFrameIsNamedAndHarmsNoOther) {
  damage(2);
  const auto recording = open();
  const auto sweep = recording->sweep(2);
  ASSERT_FALSE(sweep);
  EXPECT_NE(sweep.error().message.find("roof.sweep: frame 2: "), std::string::npos)
      << sweep.error().message;
  const auto next = recording->sweep(3);
  ASSERT_TRUE(next);
  expect_same(decoded(*(*next)->frame), native_[3]);
}

TEST_F(Recordings, FramesWhoseModelIsLostStayAsTheyAre) {
  damage(0);
  const auto recording = open();
  for (const std::uint32_t i : {4U, 1U, 3U}) {
    const auto sweep = recording->sweep(i);
    if (!sweep) continue;  // the damage may have hit the model itself
    PointCloud cloud;
    const Status status = Decoder().decode(*(*sweep)->frame, cloud);
    if (status) {
      expect_same(cloud, native_[i]);
    } else {
      EXPECT_EQ(status.error().code, ErrorCode::unsupported);
    }
  }
}

TEST_F(Recordings, OriginalsAreFoundByName) {
  const auto recording = open({write_original(3), write_original(1)});
  EXPECT_FALSE(recording->has_original(0));
  ASSERT_TRUE(recording->has_original(1));
  EXPECT_TRUE((*recording->sweep(3))->has_original);
  PointCloud cloud;
  ASSERT_TRUE(recording->original(1, cloud));
  EXPECT_EQ(cloud.x, clouds_[1].x);
  EXPECT_FALSE(recording->original(0, cloud));
}

TEST_F(Recordings, FilesFollowEachOtherAsStreamsOfTheirOwn) {
  fs::copy_file(file(), folder_ / "rover" / "side.sweep");
  auto recording = view::open_sweep_files({file(), folder_ / "rover" / "side.sweep"}, {});
  ASSERT_TRUE(recording);
  const auto streams = (*recording)->streams();
  ASSERT_EQ(streams.size(), 2U);
  EXPECT_EQ(streams[0].robot, "rover");
  EXPECT_EQ(streams[1].sensor, "side");
  EXPECT_EQ((*recording)->size(), 2 * kFrames);
  EXPECT_EQ((*recording)->stream_of(kFrames - 1), 0);
  EXPECT_EQ((*recording)->stream_of(kFrames), 1);
  const auto sweep = (*recording)->sweep(kFrames + 4);
  ASSERT_TRUE(sweep);
  EXPECT_EQ((*sweep)->stream, 1);
  expect_same(decoded(*(*sweep)->frame), native_[4]);
}

TEST_F(Recordings, CloudsAreEncodedWithinTheErrorAndAreTheirOwnOriginals) {
  auto recording =
      view::open_clouds({write_original(0), write_original(1)}, beam_options(0.01), 10.0);
  ASSERT_TRUE(recording);
  const auto sweep = (*recording)->sweep(1);  // never asked for the one before
  ASSERT_TRUE(sweep);
  const PointCloud cloud = decoded(*(*sweep)->frame);
  EXPECT_EQ(cloud.size(), clouds_[1].size());
  EXPECT_LE(worst_distance(clouds_[1], cloud, 0.0101), 0.0101);
  EXPECT_TRUE((*sweep)->has_original);
  EXPECT_EQ((*sweep)->name, "000001");
  PointCloud original;
  ASSERT_TRUE((*recording)->original(1, original));
  EXPECT_EQ(original.y, clouds_[1].y);
}

TEST(RecordingErrors, NameTheFile) {
  const auto missing = view::open_sweep_files({"/nonexistent.sweep"}, {});
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("/nonexistent.sweep"), std::string::npos);
}

}  // namespace
}  // namespace sweepcast::test
