#include "link/feedback.hpp"

#include "codec/damage.hpp"
#include "link/support.hpp"

namespace sweepcast::link {
namespace {

using test::Bytes;

Report made_report() {
  Report report;
  report.number = 7;
  report.now_us = 1000;
  report.echo_us = 2000;
  report.held_us = 30;
  report.least_delay_us = 0xFFFFFFF0;
  report.fragments = 12;
  report.bytes = std::uint64_t{1} << 40;
  report.busy_us = 40'000;
  report.busy_bytes = 0xFFFFFFFF;
  report.streams = {{0, 5, 99, 0xABCDEF01}, {15, 1, 3, 0}};
  return report;
}

TEST(Report, ComesBackAndMutationsAreSoundOrNone) {
  Bytes plain;
  write_report(made_report(), plain);
  EXPECT_EQ(plain.size(), 41U + 2 * 10U);
  const auto back = read_report(plain);
  ASSERT_TRUE(back);
  Bytes again;
  write_report(*back, again);
  EXPECT_EQ(again, plain);
  EXPECT_EQ(back->streams[1].sweep, 3U);
  EXPECT_FALSE(back->wish);

  std::mt19937 random(2);
  const std::vector<Bytes> others{plain};
  for (int i = 0; i < 20'000; ++i) {
    Bytes mutated = plain;
    test::mutate(random, others, mutated);
    const auto report = read_report(mutated);
    if (!report) continue;
    ASSERT_LE(report->streams.size(), kMostStreams);
    for (const StreamReport& stream : report->streams) ASSERT_LT(stream.stream, kMostStreams);
  }
}

// Who does not obey, as senders before there were wishes, never gets one: see Peer::report.
TEST(Report, CarriesAWishWhereThereIsOne) {
  for (const std::optional<std::size_t> level : {std::optional<std::size_t>(3), {}}) {
    Report report = made_report();
    report.wish = LevelWish{level};
    Bytes plain;
    write_report(report, plain);
    ASSERT_EQ(plain.size(), 41U + 2 * 10U + 1U);
    EXPECT_EQ(std::to_integer<unsigned>(plain.back()), level ? 3U : 255U);
    const auto back = read_report(plain);
    ASSERT_TRUE(back && back->wish);
    EXPECT_EQ(back->wish->level, level);
    plain.back() = std::byte{6};
    EXPECT_FALSE(read_report(plain));
    plain.back() = std::byte{0};
    plain.push_back(std::byte{0});
    EXPECT_FALSE(read_report(plain));
  }
}

/// Reports every 50 ms of a receiver whose clock is 3,000 s ahead, 10 ms away.
class Observer : public ::testing::Test {
 protected:
  static constexpr std::int64_t kOffset = 3'000'000'000;
  bool report(Microseconds sent, std::int64_t delay_us, std::uint64_t bytes) {
    Report report;
    report.number = ++number_;
    report.echo_us = static_cast<std::uint32_t>(sent);
    report.held_us = 5'000;
    report.least_delay_us = static_cast<std::uint32_t>(delay_us + kOffset);
    report.now_us = static_cast<std::uint32_t>(sent + delay_us + 5'000 + kOffset);
    report.fragments = 1;
    report.bytes = bytes;
    return observer_.add(report, sent + delay_us + 5'000 + 10'000);
  }
  LinkObserver observer_;
  std::uint32_t number_ = 0;
};

TEST_F(Observer, MeasuresRateQueueAndRoundTrip) {
  for (int i = 0; i < 100; ++i) report(i * 50'000, 10'000, 5'000U * i);
  LinkState state = observer_.state(100 * 50'000);
  EXPECT_NEAR(state.receive_rate, 100e3, 1.0);
  EXPECT_NEAR(state.queue_delay_s, 0.0, 1e-9);
  EXPECT_NEAR(state.round_trip_s, 0.020, 1e-9);
  report(100 * 50'000, 95'000, 5'000U * 100);
  state = observer_.state(100 * 50'000 + 110'000 + 40'000);
  EXPECT_NEAR(state.queue_delay_s, 0.085, 1e-9);
  EXPECT_NEAR(state.round_trip_s, 0.105, 1e-9);
  EXPECT_NEAR(state.report_age_s, 0.040, 1e-9);
}

TEST_F(Observer, ALongerWayIsTakenForGrantedAfterAWhile) {
  for (int i = 0; i < 100; ++i) report(i * 50'000, 10'000, 0);
  for (int i = 100; i < 600; ++i) report(i * 50'000, 60'000, 0);
  EXPECT_NEAR(observer_.state(0).queue_delay_s, 0.0, 1e-9);
}

TEST_F(Observer, OldReportsAreLeftOut) {
  EXPECT_TRUE(report(0, 10'000, 0));
  EXPECT_TRUE(report(50'000, 10'000, 0));
  number_ -= 2;
  EXPECT_FALSE(report(0, 90'000, 0));
  EXPECT_NEAR(observer_.state(0).queue_delay_s, 0.0, 1e-9);
}

}  // namespace
}  // namespace sweepcast::link
