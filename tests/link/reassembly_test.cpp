#include "link/reassembly.hpp"

#include <algorithm>

#include "core/random.hpp"
#include "link/support.hpp"

namespace sweepcast::link {
namespace {

using test::Bytes;
using test::bytes_of;
using test::fragments_of;

constexpr std::size_t kPlenty = std::size_t{1} << 22;

/// The fragments of a sweep of three layers, of 2, 3 and 1 fragments.
struct MadeSweep {
  explicit MadeSweep(std::uint32_t number, std::uint8_t stream = 0) {
    const std::size_t sizes[] = {kFragmentPayload + 1, 3 * kFragmentPayload, 17};
    for (std::uint8_t k = 0; k < 3; ++k) layers[k] = bytes_of(sizes[k], number + k);
    for (std::uint8_t k = 0; k < 3; ++k) {
      for (const Fragment& f : fragments_of(layers[k], number, k, 3, stream)) {
        fragments.push_back(f);
      }
    }
  }
  [[nodiscard]] Bytes prefix(int count) const {
    Bytes bytes;
    for (int k = 0; k < count; ++k) bytes.insert(bytes.end(), layers[k].begin(), layers[k].end());
    return bytes;
  }
  Bytes layers[3];
  std::vector<Fragment> fragments;
};

class Reassembly : public ::testing::Test {
 protected:
  FragmentFate add(const Fragment& fragment, Microseconds now = 1000) {
    const FragmentFate fate = reassembler_.add(fragment, now, ready_);
    EXPECT_EQ(memory_.used, reassembler_.used());
    return fate;
  }
  void expire(Microseconds now) { reassembler_.expire(now, ready_); }
  void expect_ready(std::size_t i, std::uint32_t sweep, int layers, const Bytes& bytes) {
    ASSERT_GT(ready_.size(), i);
    EXPECT_EQ(ready_[i].sweep, sweep);
    EXPECT_EQ(ready_[i].layers, layers);
    EXPECT_EQ(ready_[i].layers_made, 3);
    EXPECT_EQ(ready_[i].bytes, bytes);
  }

  MemoryBudget memory_{kPlenty, 0};
  Reassembler reassembler_{kPlenty, memory_};
  std::vector<ReadySweep> ready_;
};

TEST_F(Reassembly, AnyOrderGivesTheSweep) {
  std::mt19937 random(1);
  for (std::uint32_t number = 1; number <= 50; ++number) {
    MadeSweep sweep(number);
    for (std::size_t i = sweep.fragments.size(); i > 1; --i) {
      std::swap(sweep.fragments[i - 1], sweep.fragments[test::random_bits(random) % i]);
    }
    for (const Fragment& fragment : sweep.fragments) {
      EXPECT_EQ(add(fragment), FragmentFate::taken);
    }
    expect_ready(number - 1, number, 3, sweep.prefix(3));
    EXPECT_EQ(add(sweep.fragments[0]), FragmentFate::late);
  }
  EXPECT_EQ(memory_.used, 0U);
}

TEST_F(Reassembly, TheDeadlineGivesTheLongestWholePrefix) {
  // Of six fragments one is missing: layers 0 (first two) or 1 (next three) or 2 (the last).
  const int whole[] = {0, 0, 1, 1, 1, 2};
  for (std::uint32_t number = 1; number <= 6; ++number) {
    const MadeSweep sweep(number);
    for (std::size_t i = 0; i < 6; ++i) {
      if (i == number - 1) continue;
      EXPECT_EQ(add(sweep.fragments[i], 500'000), FragmentFate::taken);
    }
    expire(599'999);
    EXPECT_EQ(ready_.size(), number - 1);
    expire(600'000);
    expect_ready(number - 1, number, whole[number - 1], sweep.prefix(whole[number - 1]));
    EXPECT_EQ(add(sweep.fragments[number - 1], 600'001), FragmentFate::late);
  }
  EXPECT_EQ(memory_.used, 0U);
}

TEST_F(Reassembly, ANewerWholeSweepEndsOlderOnesOfItsStream) {
  const MadeSweep one(1), two(2), other(1, 5);
  for (std::size_t i = 0; i < 5; ++i) add(one.fragments[i]);
  for (std::size_t i = 0; i < 5; ++i) add(other.fragments[i]);
  for (const Fragment& fragment : two.fragments) add(fragment);
  ASSERT_EQ(ready_.size(), 2U);
  expect_ready(0, 1, 2, one.prefix(2));
  expect_ready(1, 2, 3, two.prefix(3));
  EXPECT_EQ(add(one.fragments[5]), FragmentFate::late);
  EXPECT_EQ(add(other.fragments[5]), FragmentFate::taken);
  expect_ready(2, 1, 3, other.prefix(3));
  EXPECT_EQ(ready_[2].stream, 5);
}

TEST_F(Reassembly, ANewerWholeSweepWaitsForTheRepairOfAFirstLayer) {
  constexpr Microseconds kRepaired = 1000 + Reassembler::kRepair;
  const MadeSweep one(1), two(2), three(3), four(4);
  for (const std::size_t i : {0, 2, 3, 4, 5}) add(one.fragments[i]);
  for (const Fragment& fragment : two.fragments) add(fragment);
  EXPECT_TRUE(ready_.empty());
  add(one.fragments[1], kRepaired - 1);
  ASSERT_EQ(ready_.size(), 2U);
  expect_ready(0, 1, 3, one.prefix(3));
  expect_ready(1, 2, 3, two.prefix(3));

  // One that is not repaired: the newer one waits no longer than that.
  add(three.fragments[0]);
  for (const Fragment& fragment : four.fragments) add(fragment);
  expire(kRepaired - 1);
  EXPECT_EQ(ready_.size(), 2U);
  expire(kRepaired);
  ASSERT_EQ(ready_.size(), 4U);
  expect_ready(2, 3, 0, {});
  expect_ready(3, 4, 3, four.prefix(3));
  EXPECT_EQ(add(three.fragments[1], kRepaired), FragmentFate::late);
  EXPECT_EQ(memory_.used, 0U);
}

TEST_F(Reassembly, RepetitionAndContradictionChangeNothing) {
  const MadeSweep sweep(4);
  add(sweep.fragments[0]);
  EXPECT_EQ(add(sweep.fragments[0]), FragmentFate::repeated);
  const Bytes longer = bytes_of(5 * kFragmentPayload);
  EXPECT_EQ(add(fragments_of(longer, 4, 0, 3)[2]), FragmentFate::malformed);
  EXPECT_EQ(add(fragments_of(longer, 4, 0, 2)[2]), FragmentFate::malformed);
  for (const Fragment& fragment : sweep.fragments) add(fragment);
  expect_ready(0, 4, 3, sweep.prefix(3));
}

TEST_F(Reassembly, OpenSweepsAreFew) {
  for (std::uint32_t number = 1; number <= 100; ++number) {
    add(MadeSweep(number).fragments[0]);
  }
  EXPECT_EQ(ready_.size(), 100 - Reassembler::kMostOpen);
  expire(1'000'000);
  EXPECT_EQ(ready_.size(), 100U);
  EXPECT_EQ(memory_.used, 0U);
}

TEST(ReassemblyMemory, LimitsHoldForOnePeerAndForAll) {
  const Bytes large = bytes_of(100'000);
  MemoryBudget memory{250'000, 0};
  std::vector<ReadySweep> ready;
  {
    Reassembler one(150'000, memory), two(150'000, memory);
    EXPECT_EQ(one.add(fragments_of(large, 1, 0, 1)[0], 0, ready), FragmentFate::taken);
    EXPECT_EQ(one.add(fragments_of(large, 2, 0, 1)[0], 0, ready), FragmentFate::over_limit);
    EXPECT_EQ(two.add(fragments_of(large, 1, 0, 1)[0], 0, ready), FragmentFate::taken);
    EXPECT_GE(memory.used, 200'000U);
    EXPECT_LE(memory.used, 250'000U);
    Reassembler three(150'000, memory);
    EXPECT_EQ(three.add(fragments_of(large, 1, 0, 1)[0], 0, ready), FragmentFate::over_limit);
    one.expire(100'000, ready);
    EXPECT_EQ(three.add(fragments_of(large, 1, 0, 1)[0], 0, ready), FragmentFate::taken);
  }
  EXPECT_EQ(memory.used, 0U);
}

}  // namespace
}  // namespace sweepcast::link
