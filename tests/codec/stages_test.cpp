#include "sweepcast/stages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "codec/scene.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast {
namespace {

using std::chrono::nanoseconds;

nanoseconds sum(const StageClock& clock) {
  nanoseconds sum{0};
  for (const StageTime& stage : clock.stages()) sum += stage.time;
  return sum;
}

bool has(const StageClock& clock, std::string_view name) {
  return std::any_of(clock.stages().begin(), clock.stages().end(),
                     [&](const StageTime& stage) { return stage.stage == name; });
}

TEST(StageClock, AddsUpWhatAStageTakes) {
  StageClock clock;
  clock.add("fit", nanoseconds(5));
  clock.add("code", nanoseconds(7));
  clock.add("fit", nanoseconds(11));
  ASSERT_EQ(clock.stages().size(), 2U);
  EXPECT_EQ(clock.stages()[0].stage, "fit");
  EXPECT_EQ(clock.stages()[0].time, nanoseconds(16));
  EXPECT_EQ(clock.stages()[1].time, nanoseconds(7));
  clock.clear();
  EXPECT_TRUE(clock.stages().empty());
}

class CodecStages : public ::testing::TestWithParam<CodecId> {};

TEST_P(CodecStages, AreMostOfTheTimeAndChangeNoBit) {
  const PointCloud cloud = test::street(32, 900);
  StageClock encoding, decoding;
  EncoderOptions options;
  options.codec = GetParam();
  auto plain = Encoder::create(options);
  options.stages = &encoding;
  auto measured = Encoder::create(options);
  ASSERT_TRUE(plain && measured);
  const auto expected = plain->encode(cloud, {});
  const auto began = std::chrono::steady_clock::now();
  const auto frame = measured->encode(cloud, {});
  const nanoseconds encoded = std::chrono::steady_clock::now() - began;
  ASSERT_TRUE(expected && frame);
  EXPECT_TRUE(std::equal(frame->begin(), frame->end(), expected->begin(), expected->end()));
  EXPECT_LE(sum(encoding), encoded);
  EXPECT_GT(sum(encoding), nanoseconds(0));

  DecoderOptions decoder_options;
  decoder_options.stages = &decoding;
  Decoder decoder(decoder_options);
  PointCloud decoded;
  ASSERT_TRUE(decoder.decode(*frame, decoded));
  EXPECT_GT(sum(decoding), nanoseconds(0));
  const bool is_beam = GetParam() == CodecId::beam;
  EXPECT_TRUE(has(encoding, is_beam ? "ranges" : "SA-DCT"));
  EXPECT_TRUE(has(decoding, is_beam ? "points to their places" : "inverse SA-DCT"));
}

INSTANTIATE_TEST_SUITE_P(Codecs, CodecStages, ::testing::Values(CodecId::rcpcc, CodecId::beam));

}  // namespace
}  // namespace sweepcast
