// The context-mixing model: both directions agree, and it learns.
#include "codec/entropy/mixer.hpp"

#include <gtest/gtest.h>

#include "core/random.hpp"

namespace sweepcast {
namespace {

using test::random_bits;

using Mixer = BitMixer<3>;

struct Event {
  Mixer::Contexts contexts;
  std::size_t weight_set;
  bool bit;
};

std::vector<std::byte> encode(Mixer& mixer, const std::vector<Event>& events) {
  std::vector<std::byte> bytes;
  RangeEncoder coder(bytes);
  for (const Event& e : events) (void)mixer.code(coder, e.contexts, e.weight_set, e.bit);
  coder.finish();
  return bytes;
}

void expect_round_trip(const std::vector<Event>& events) {
  Mixer writer(10, 4);
  const std::vector<std::byte> bytes = encode(writer, events);
  Mixer reader(10, 4);
  RangeDecoder coder(bytes);
  std::size_t wrong = 0;
  for (const Event& e : events) {
    wrong += reader.code(coder, e.contexts, e.weight_set, false) == e.bit ? 0U : 1U;
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_FALSE(coder.overran());
}

TEST(BitMixer, DecoderFollowsTheEncoder) {
  std::mt19937 random(1);
  for (int run = 0; run < 20; ++run) {
    std::vector<Event> events;
    for (int i = 0; i < 5000; ++i) {
      const std::uint32_t spread = 1U << (run % 20);
      events.push_back({{random_bits(random) % spread, random_bits(random), 7U},
                        random_bits(random) % 4,
                        random_bits(random) % 100 < static_cast<std::uint32_t>(run) * 5U});
    }
    expect_round_trip(events);
  }
}

TEST(BitMixer, SurvivesASourceThatTurnsAgainstIt) {
  std::vector<Event> events;
  for (int i = 0; i < 60'000; ++i) {
    const auto context = static_cast<std::uint32_t>(i % 3);
    events.push_back({{context, context, context}, 0, i / 10'000 % 2 == 0});
  }
  expect_round_trip(events);
}

TEST(BitMixer, LearnsASkewedSource) {
  std::mt19937 random(2);
  std::vector<Event> events;
  for (int i = 0; i < 100'000; ++i) {
    events.push_back({{random_bits(random) % 4, 1U, 2U}, 0, random_bits(random) % 100 == 0});
  }
  Mixer mixer(10, 4);
  // The entropy of one in a hundred is 0.0808 bits.
  EXPECT_LT(encode(mixer, events).size(), 100'000 * 0.090 / 8);
  expect_round_trip(events);
}

TEST(BitMixer, LearnsWhichContextToTrust) {
  std::mt19937 random(3);
  std::vector<Event> events;
  for (int i = 0; i < 50'000; ++i) {
    const std::uint32_t telling = random_bits(random) % 8;
    events.push_back({{random_bits(random) % 64, telling, 0U}, 0, telling % 2 == 1});
  }
  Mixer mixer(10, 4);
  EXPECT_LT(encode(mixer, events).size(), 50'000 * 0.02 / 8);
}

TEST(BitMixer, ResetForgetsEverything) {
  std::mt19937 random(4);
  std::vector<Event> events;
  for (int i = 0; i < 3000; ++i) {
    events.push_back({{random_bits(random) % 50, 3U, 4U}, 1, random_bits(random) % 5 == 0});
  }
  Mixer mixer(10, 4);
  const std::vector<std::byte> first = encode(mixer, events);
  EXPECT_NE(encode(mixer, events), first);
  mixer.reset();
  EXPECT_EQ(encode(mixer, events), first);
}

}  // namespace
}  // namespace sweepcast
