#include "link/sender_report.hpp"

#include "codec/damage.hpp"
#include "link/qoe_meter.hpp"
#include "link/support.hpp"

namespace sweepcast::link {
namespace {

using test::Bytes;
using test::hex;

SenderReport made_report() {
  SenderReport report;
  report.level = 2;
  report.queued_frames = 3;
  report.queued_bytes = 70'000;
  report.sweeps = std::uint64_t{1} << 40;
  report.sent = 900;
  report.cut = 20;
  report.dropped = 7;
  report.qoe = -12.345;
  report.can_override = true;
  report.override_level = 5;
  return report;
}

TEST(SenderReport, IsWrittenAsTheFormatSays) {
  Bytes plain;
  write_sender_report(258, made_report(), plain);
  EXPECT_EQ(hex(plain),
            "02010000"          // number
            "01"                // obeys
            "0205"              // level, level that was asked for
            "030070110100"      // queue
            "0000000000010000"  // sweeps
            "8403000000000000"  // sent
            "1400000000000000"  // cut
            "0700000000000000"  // dropped
            "c7cfffff");        // -12,345
  const auto back = read_sender_report(plain);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->number, 258U);
  EXPECT_EQ(back->report.queued_bytes, 70'000U);
  EXPECT_EQ(back->report.sweeps, std::uint64_t{1} << 40);
  EXPECT_EQ(back->report.qoe, -12.345);
}

TEST(SenderReport, WhatIsNotKnownStaysSo) {
  Bytes plain;
  write_sender_report(1, {}, plain);
  const auto back = read_sender_report(plain);
  ASSERT_TRUE(back);
  EXPECT_FALSE(back->report.level);
  EXPECT_FALSE(back->report.override_level);
  EXPECT_FALSE(back->report.qoe);
  EXPECT_FALSE(back->report.can_override);
}

TEST(SenderReport, WhatIsTooLargeIsAsLargeAsCanBeTold) {
  SenderReport report;
  report.queued_frames = 1'000'000;
  report.queued_bytes = std::size_t{1} << 40;
  report.qoe = -1e300;
  Bytes plain;
  write_sender_report(1, report, plain);
  const auto back = read_sender_report(plain);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->report.queued_frames, 0xFFFFU);
  EXPECT_EQ(back->report.queued_bytes, 0xFFFFFFFFU);
  EXPECT_EQ(back->report.qoe, -1e6);
}

TEST(SenderReport, WhatCannotBeIsRefused) {
  Bytes sound;
  write_sender_report(1, made_report(), sound);
  const auto refused = [&](std::size_t at, int value) {
    Bytes changed = sound;
    changed[at] = static_cast<std::byte>(value);
    return !read_sender_report(changed);
  };
  EXPECT_TRUE(refused(0, 0));  // the number
  EXPECT_TRUE(refused(4, 2));  // a flag of tomorrow
  EXPECT_TRUE(refused(4, 0));  // it sends what was asked for, and does not obey
  EXPECT_TRUE(refused(5, 6));  // levels
  EXPECT_TRUE(refused(6, 254));
  EXPECT_FALSE(refused(6, 255));
  for (std::size_t size = 0; size < sound.size(); ++size) {
    EXPECT_FALSE(read_sender_report(std::span(sound).first(size))) << size;
  }
  sound.push_back(std::byte{0});
  EXPECT_FALSE(read_sender_report(sound));
}

TEST(SenderReport, MutationsAreSoundOrNone) {
  Bytes plain;
  write_sender_report(9, made_report(), plain);
  std::mt19937 random(3);
  const std::vector<Bytes> others{plain};
  int sound = 0;
  for (int i = 0; i < 20'000; ++i) {
    Bytes mutated = plain;
    test::mutate(random, others, mutated);
    const auto told = read_sender_report(mutated);
    if (!told) continue;
    ++sound;
    ASSERT_LT(told->report.level.value_or(0), kLevels);
    ASSERT_LT(told->report.override_level.value_or(0), kLevels);
  }
  EXPECT_GT(sound, 100);
}

TEST(QoeMeter, IsEquationFiveOverTheLastSweeps) {
  QoeMeter meter;
  EXPECT_FALSE(meter.mean());
  meter.add(1, 0, true);   // 20
  meter.add(1, 2, true);   // 20, less 1 for the queue
  meter.add(3, 0, true);   // 10, less 10 for the change
  meter.add(0, 0, false);  // 0, less 10
  EXPECT_NEAR(*meter.mean(), (20.0 + 19.0 + 0.0 - 10.0) / 4.0, 1e-12);
  for (std::size_t i = 0; i < QoeMeter::kSweeps; ++i) meter.add(2, 0, true);
  EXPECT_NEAR(*meter.mean(), 15.0, 1e-12);  // those before are forgotten
  meter.add(std::nullopt, 0, true);
  EXPECT_FALSE(meter.mean());
}

}  // namespace
}  // namespace sweepcast::link
