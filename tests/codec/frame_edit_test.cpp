#include "codec/frame_edit.hpp"

#include <gtest/gtest.h>

#include "codec/beam/sensor.hpp"
#include "sweepcast/decoder.hpp"

namespace sweepcast::test {
namespace {

using Bytes = std::vector<std::byte>;

class FrameEdit : public ::testing::Test {
 protected:
  void SetUp() override {
    auto encoder = Encoder::create(beam_options(0.05));
    for (auto* frame : {&first_, &second_}) {
      const PointCloud cloud = spinning_sweep(16, 360, frame == &first_ ? 1 : 2);
      const auto bytes = encoder->encode(cloud, {3, 4, "roof"});
      ASSERT_TRUE(bytes);
      frame->assign(bytes->begin(), bytes->end());
    }
    ASSERT_TRUE(parse_frame_header(first_, header_));
  }

  static PointCloud decoded(Decoder decoder, std::span<const std::byte> frame) {
    PointCloud cloud;
    const Status status = decoder.decode(frame, cloud);
    EXPECT_TRUE(status) << status.error().message;
    return cloud;
  }

  Bytes first_, second_;  ///< the first has the sensor's model, the second has not
  FrameHeader header_;
};

TEST_F(FrameEdit, EveryCutDecodesAsSoManyLayers) {
  const auto ends = layer_ends(header_);
  ASSERT_EQ(ends.size(), 5U);
  EXPECT_EQ(ends.back(), first_.size());
  for (std::size_t k = 0; k < ends.size(); ++k) {
    DecoderOptions options;
    options.max_layers = static_cast<int>(k) + 1;
    const PointCloud truth = decoded(Decoder(options), first_);
    for (const std::size_t more : {0, 3}) {  // also with a part of the next layer
      Bytes cut;
      const auto prefix = std::span(first_).first(std::min(ends[k] + more, first_.size()));
      ASSERT_TRUE(rewrite_frame(prefix, ModelPart::keep, {}, cut));
      const PointCloud cloud = decoded(Decoder(), cut);
      EXPECT_EQ(cloud.x, truth.x) << k;
      EXPECT_EQ(cloud.z, truth.z) << k;
    }
  }
}

TEST_F(FrameEdit, AWholeFrameStaysAsItIs) {
  Bytes same;
  ASSERT_TRUE(rewrite_frame(first_, ModelPart::keep, {}, same));
  EXPECT_EQ(same, first_);
}

TEST_F(FrameEdit, TheModelGoesAndComes) {
  const auto model = model_part(first_, header_);
  ASSERT_TRUE(model);
  ASSERT_FALSE(model->empty());
  FrameHeader second_header;
  ASSERT_TRUE(parse_frame_header(second_, second_header));
  EXPECT_TRUE(model_part(second_, second_header)->empty());

  Bytes without, with;
  ASSERT_TRUE(rewrite_frame(first_, ModelPart::drop, {}, without));
  EXPECT_LT(without.size() + model->size(), first_.size());
  ASSERT_TRUE(rewrite_frame(without, ModelPart::put, *model, with));
  EXPECT_EQ(with, first_);

  Decoder in_order;
  PointCloud truth;
  ASSERT_TRUE(in_order.decode(first_, truth));
  ASSERT_TRUE(in_order.decode(second_, truth));
  Bytes alone;
  ASSERT_TRUE(rewrite_frame(second_, ModelPart::put, *model, alone));
  EXPECT_EQ(decoded(Decoder(), alone).x, truth.x);
}

TEST_F(FrameEdit, DamageIsSeen) {
  Bytes out;
  const auto ends = layer_ends(header_);
  const auto cut = rewrite_frame(std::span(first_).first(ends[0] - 1), ModelPart::keep, {}, out);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, ErrorCode::truncated);
  Bytes damaged = first_;
  damaged[ends[1] + 2] ^= std::byte{1};
  const auto refused = rewrite_frame(damaged, ModelPart::keep, {}, out);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::corrupt);
}

TEST_F(FrameEdit, CodecRcpccHasOneLayer) {
  EncoderOptions options;
  options.codec = CodecId::rcpcc;
  const PointCloud cloud = spinning_sweep(16, 360, 3);
  auto encoder = Encoder::create(options);
  const auto frame = encoder->encode(cloud, {});
  ASSERT_TRUE(frame);
  ASSERT_TRUE(parse_frame_header(*frame, header_));
  EXPECT_EQ(layer_ends(header_), std::vector<std::size_t>{frame->size()});
  EXPECT_TRUE(model_part(*frame, header_)->empty());
  Bytes same;
  ASSERT_TRUE(rewrite_frame(*frame, ModelPart::drop, {}, same));
  EXPECT_EQ(same, Bytes(frame->begin(), frame->end()));
}

}  // namespace
}  // namespace sweepcast::test
