#include "link/fragment.hpp"

#include "codec/damage.hpp"
#include "codec/frame_edit.hpp"
#include "link/support.hpp"

namespace sweepcast::link {
namespace {

using test::Bytes;

TEST(Fragment, HasTheBytesThatTheFormatSays) {
  const Bytes payload{std::byte{0xAA}, std::byte{0xBB}};
  Fragment fragment;
  fragment.stream = 3;
  fragment.layer = 1;
  fragment.layers = 5;
  fragment.sweep = 0x01020304;
  fragment.index = 2;
  fragment.layer_bytes = static_cast<std::uint32_t>(2 * kFragmentPayload + 2);
  fragment.sent_us = 0x0A0B0C0D;
  fragment.remaining_ms = 250;
  fragment.payload = payload;
  EXPECT_EQ(kFragmentPayload, 1271U);
  Bytes plain;
  write_fragment(fragment, plain);
  const std::vector<int> expected{3, 1, 5, 0,  4,  3,  2,  1,   2, 0,    0xF0,
                                  9, 0, 0, 13, 12, 11, 10, 250, 0, 0xAA, 0xBB};
  ASSERT_EQ(plain.size(), expected.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(std::to_integer<int>(plain[i]), expected[i]) << i;
  }
  const auto back = read_fragment(plain);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->sweep, fragment.sweep);
  EXPECT_EQ(back->offset(), 2 * kFragmentPayload);
  EXPECT_EQ(Bytes(back->payload.begin(), back->payload.end()), payload);
}

TEST(Fragment, NumbersOutOfBoundsAreRefused) {
  const Bytes layer = test::bytes_of(3 * kFragmentPayload - 10);
  const auto sound = test::fragments_of(layer, 1, 0, 1);
  ASSERT_EQ(sound.size(), 3U);
  const auto is_read = [&](auto change) {
    Fragment fragment = sound[2];
    change(fragment);
    Bytes plain;
    write_fragment(fragment, plain);
    return read_fragment(plain).has_value();
  };
  EXPECT_TRUE(is_read([](Fragment&) {}));
  EXPECT_FALSE(is_read([](Fragment& f) { f.stream = kMostStreams; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.layer = 1; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.layers = 0; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.layers = kMostLayers + 1; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.sweep = 0; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.index = 3; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.index = 1; }));  // must be full
  EXPECT_FALSE(is_read([](Fragment& f) { f.layer_bytes = 0; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.layer_bytes = kLargestLayer + 1; }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.payload = f.payload.first(5); }));
  EXPECT_FALSE(is_read([](Fragment& f) { f.payload = {}; }));
  Bytes plain;
  write_fragment(sound[2], plain);
  plain[3] = std::byte{1};  // reserved
  EXPECT_FALSE(read_fragment(plain));
}

TEST(Fragment, MutationsGiveSoundFragmentsOrNone) {
  std::mt19937 random(3);
  const Bytes layer = test::bytes_of(2 * kFragmentPayload);
  std::vector<Bytes> plains;
  for (const Fragment& fragment : test::fragments_of(layer, 7, 2, 5)) {
    write_fragment(fragment, plains.emplace_back());
  }
  int read = 0;
  for (int i = 0; i < 20'000; ++i) {
    Bytes plain = plains[test::random_bits(random) % plains.size()];
    test::mutate(random, plains, plain);
    const auto fragment = read_fragment(plain);
    if (!fragment) continue;
    ++read;
    ASSERT_LT(fragment->layer, fragment->layers);
    ASSERT_LE(fragment->layers, kMostLayers);
    ASSERT_LT(fragment->stream, kMostStreams);
    ASSERT_LE(fragment->layer_bytes, kLargestLayer);
    ASSERT_FALSE(fragment->payload.empty());
    ASSERT_LE(fragment->offset() + fragment->payload.size(), fragment->layer_bytes);
  }
  EXPECT_GT(read, 500);
  EXPECT_LT(read, 19'000);
}

TEST(Label, ComesBackAndNamesAreChecked) {
  Bytes bytes;
  write_label({0x11223344, 0x55667788, "roof", "000012"}, bytes);
  const Bytes frame = test::bytes_of(9);
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  std::span<const std::byte> rest;
  const auto label = read_label(bytes, rest);
  ASSERT_TRUE(label);
  EXPECT_EQ(label->captured_us, 0x11223344U);
  EXPECT_EQ(label->model, 0x55667788U);
  EXPECT_EQ(label->sensor, "roof");
  EXPECT_EQ(label->name, "000012");
  EXPECT_EQ(Bytes(rest.begin(), rest.end()), frame);
  for (std::size_t size = 0; size < 20; ++size) {
    EXPECT_FALSE(read_label(std::span(bytes).first(size), rest)) << size;
  }
  for (const SweepLabel& bad : {SweepLabel{0, 0, "../etc", "x"}, SweepLabel{0, 0, "", "x"},
                                SweepLabel{0, 0, "roof", std::string(65, 'x')}}) {
    Bytes out;
    write_label(bad, out);
    EXPECT_FALSE(read_label(out, rest));
  }
}

TEST(CutLayers, TogetherTheyAreLabelAndFrame) {
  const Bytes frame = test::small_frames(1).front();
  const SweepLabel label{1, 2, "roof", "x"};
  const auto layers = cut_layers(frame, label);
  ASSERT_TRUE(layers);
  ASSERT_EQ(layers->size(), 5U);
  Bytes expected;
  write_label(label, expected);
  expected.insert(expected.end(), frame.begin(), frame.end());
  Bytes joined;
  for (const Bytes& layer : *layers) joined.insert(joined.end(), layer.begin(), layer.end());
  EXPECT_EQ(joined, expected);
  const std::size_t label_bytes = expected.size() - frame.size();
  const std::size_t two = (*layers)[0].size() + (*layers)[1].size() - label_bytes;
  EXPECT_EQ(cut_layers(frame, label, two)->size(), 2U);
  EXPECT_EQ(cut_layers(frame, label, two - 1)->size(), 1U);
  EXPECT_EQ(cut_layers(frame, label, 1)->size(), 1U);
  const auto cut = cut_layers(std::span(frame).first(frame.size() - 1), label);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, ErrorCode::truncated);
}

}  // namespace
}  // namespace sweepcast::link
