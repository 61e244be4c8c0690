// What an arrival meter makes of trains of packets over links whose rate is known.
#include "link/arrival_meter.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace sweepcast::link {
namespace {

/// Sends trains of packets of 1000 bytes over a queue of one rate, 20 ms long. The receiver's clock
/// is ahead by what `offset_us_` says.
class ArrivalMeterTest : public ::testing::Test {
 protected:
  /// A train a tenth of a second: so many packets, sent so far apart.
  void train(int packets, Microseconds apart_us, double bytes_per_s) {
    for (int i = 0; i < packets; ++i) {
      const Microseconds sent = now_us_ + i * apart_us;
      const auto takes = static_cast<Microseconds>(1000.0 / bytes_per_s * 1e6);
      free_us_ = std::max(free_us_, sent) + takes;
      meter_.add(++counter_, static_cast<std::uint32_t>(sent), 1000,
                 free_us_ + 20'000 + offset_us_);
    }
    now_us_ += 100'000;
  }
  /// What was measured since the last time, bytes a second.
  double rate() {
    const double seconds = static_cast<double>(meter_.busy_us() - busy_us_) * 1e-6;
    const std::uint32_t bytes = meter_.busy_bytes() - bytes_;
    busy_us_ = meter_.busy_us();
    bytes_ = meter_.busy_bytes();
    return seconds > 0.0 ? bytes / seconds : 0.0;
  }

  ArrivalMeter meter_;
  Microseconds now_us_ = 1'000'000, free_us_ = 0;
  Microseconds offset_us_ = 4'000'000'000;  // almost the 2^32 at which times wrap
  std::uint64_t counter_ = 0;
  std::uint32_t busy_us_ = 0, bytes_ = 0;
};

TEST_F(ArrivalMeterTest, FindsTheRateOfALinkThatIsSlowerThanWeSend) {
  for (int i = 0; i < 200; ++i) train(8, 2'000, 150e3);
  EXPECT_NEAR(rate(), 150e3, 1e3);
}

TEST_F(ArrivalMeterTest, ElseThePaceAtWhichWeSend) {
  for (int i = 0; i < 20; ++i) train(8, 5'000, 10e6);
  EXPECT_NEAR(rate(), 200e3, 4e3);
}

TEST_F(ArrivalMeterTest, AnOutageIsTimeInWhichNothingCame) {
  for (int i = 0; i < 10; ++i) train(4, 2'000, 1e6);
  static_cast<void>(rate());
  const std::uint32_t before = meter_.busy_us();
  free_us_ = now_us_ + 250'000;
  train(4, 2'000, 1e6);
  EXPECT_NEAR(static_cast<double>(meter_.busy_us() - before), 253e3, 4e3);
}

TEST_F(ArrivalMeterTest, RepeatedPacketsTellNothing) {
  train(8, 2'000, 150e3);
  const std::uint32_t busy = meter_.busy_us();
  meter_.add(3, static_cast<std::uint32_t>(now_us_), 1000, now_us_ + 900'000 + offset_us_);
  EXPECT_EQ(meter_.busy_us(), busy);
  EXPECT_EQ(meter_.busy_bytes(), 7'000U);
}

TEST_F(ArrivalMeterTest, ClocksMayJump) {
  for (const Microseconds jump : std::initializer_list<Microseconds>{
           3'600'000'000, -3'600'000'000, 1'500'000, -200'000, 200'000}) {
    for (int i = 0; i < 30; ++i) train(8, 2'000, 150e3);
    offset_us_ += jump;
    train(8, 2'000, 150e3);
    for (int i = 0; i < 20; ++i) train(8, 2'000, 150e3);  // two seconds later all is forgotten
    static_cast<void>(rate());
    for (int i = 0; i < 5; ++i) train(8, 2'000, 150e3);
    EXPECT_NEAR(rate(), 150e3, 5e3) << jump;
  }
}

}  // namespace
}  // namespace sweepcast::link
