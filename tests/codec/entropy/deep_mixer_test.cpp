// The deep context-mixing model: both directions agree, it learns, and it uses what it is given.
#include "codec/entropy/deep_mixer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "codec/entropy/range_coder.hpp"
#include "core/random.hpp"

namespace sweepcast {
namespace {

using test::random_bits;
using Mixer = DeepMixer<1, 2>;

struct Event {
  Mixer::Bit at;
  bool bit;
};

std::vector<std::byte> encode(const std::vector<Event>& events) {
  Mixer mixer(10, 4, 4, 4);
  std::vector<std::byte> bytes;
  RangeEncoder coder(bytes);
  for (const Event& e : events) (void)mixer.code(coder, e.at, e.bit);
  coder.finish();
  return bytes;
}

TEST(DeepMixer, DecoderFollowsTheEncoder) {
  std::mt19937 random(1);
  for (std::uint32_t per_cent = 0; per_cent <= 100; per_cent += 10) {
    std::vector<Event> events;
    for (int i = 0; i < 5000; ++i) {
      const auto given = static_cast<std::int32_t>(random_bits(random) % 4095) - 2047;
      events.push_back({{{given},
                         {random_bits(random) % 64, random_bits(random)},
                         random_bits(random) % 4,
                         random_bits(random) % 4,
                         random_bits(random) % 4},
                        random_bits(random) % 100 < per_cent});
    }
    const std::vector<std::byte> bytes = encode(events);
    Mixer reader(10, 4, 4, 4);
    RangeDecoder coder(bytes);
    std::size_t wrong = 0;
    for (const Event& e : events) wrong += reader.code(coder, e.at, false) == e.bit ? 0U : 1U;
    EXPECT_EQ(wrong, 0U) << per_cent;
    EXPECT_FALSE(coder.overran());
  }
}

TEST(DeepMixer, LearnsWhatAContextTells) {
  std::mt19937 random(2);
  std::vector<Event> events;
  for (int i = 0; i < 20'000; ++i) {
    const std::uint32_t context = random_bits(random) % 16;
    events.push_back({{{0}, {context, 0}, 0, 0, 0}, context % 3 == 0});
  }
  EXPECT_LT(encode(events).size(), 100U);  // of 2500
}

TEST(DeepMixer, TrustsWhatItIsGivenWhereThatIsRight) {
  std::mt19937 random(3);
  std::vector<Event> events;
  double entropy = 0.0;
  for (int i = 0; i < 40'000; ++i) {
    const auto given = static_cast<std::int32_t>(random_bits(random) % 2'049) - 1024;
    const double p = 1.0 / (1.0 + std::exp(-given / 256.0));
    const bool bit = (random_bits(random) % 65'536) < p * 65'536;
    entropy -= std::log2(bit ? p : 1.0 - p);
    events.push_back({{{given}, {0, random_bits(random)}, 0, 0, 0}, bit});
  }
  const double bits = 8.0 * static_cast<double>(encode(events).size());
  EXPECT_LT(bits, 1.03 * entropy);
  EXPECT_LT(entropy, 0.75 * 40'000);
}

TEST(Logistic, SoftplusAndItsInverse) {
  for (int x = -3000; x <= 3000; x += 7) {
    const double expected = 256.0 * std::log1p(std::exp(x / 256.0));
    EXPECT_NEAR(softplus(x), expected, 1.6) << x;
  }
  for (int y = 8; y <= 4000; y += 3) {  // below, the inverse is as steep as 1 / y
    const double expected = 256.0 * std::log(std::expm1(y / 256.0));
    EXPECT_NEAR(softplus_inverse(y), expected, y < 64 ? 24.0 : 3.0) << y;
  }
  EXPECT_EQ(softplus_inverse(0), -2048);
}

}  // namespace
}  // namespace sweepcast
