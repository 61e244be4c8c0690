// The budget strategy behind a live sender, over links in virtual time.
#include "link/rate_control.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "link/arrival_meter.hpp"
#include "link/link_model.hpp"
#include "link/support.hpp"

namespace sweepcast::link {
namespace {

/// A sender, a link and a receiver: each tenth of a second a sweep as large as its budget leaves at
/// the pace, and the receiver's reports tell what came.
class Stream {
 public:
  Stream() { control_.begin(0); }

  /// Returns what the strategy chose for each sweep.
  std::vector<std::size_t> run(const Trace& trace, const LinkOptions& options, int sweeps) {
    LinkModel link(trace, options);
    const Microseconds began = now_us_;
    std::vector<std::size_t> choices;
    for (int i = 0; i < sweeps; ++i, now_us_ += 100'000) {
      control_.add(observer_.take_sample());
      RateControl::Situation situation;
      situation.connected = true;
      const Choice choice = control_.decide(observer_.state(now_us_), situation);
      choices.push_back(choice.bytes);
      Microseconds leaves = now_us_;
      for (std::size_t sent = 0; sent < choice.bytes; sent += 1300) {
        const auto fate = link.send(leaves - began, 1344);
        ++counter_;
        if (fate && fate->arrives_us) arrives(leaves, began + *fate->arrives_us + clock_us_);
        leaves += static_cast<Microseconds>(1344e6 / control_.pace());
      }
      report(now_us_ + 95'000, options.delay_us);
    }
    return choices;
  }

  void jump(Microseconds by_us) { clock_us_ += by_us; }
  RateControl& control() { return control_; }

 private:
  void arrives(Microseconds sent, Microseconds at) {
    meter_.add(counter_, static_cast<std::uint32_t>(sent), 1300, at);
    bytes_ += 1300;
  }
  void report(Microseconds now, Microseconds delay_us) {
    Report report;
    report.number = ++number_;
    report.now_us = static_cast<std::uint32_t>(now + clock_us_);
    report.echo_us = static_cast<std::uint32_t>(now - 2 * delay_us);
    report.fragments = 1;
    report.bytes = bytes_;
    report.busy_us = meter_.busy_us();
    report.busy_bytes = meter_.busy_bytes();
    observer_.add(report, now);
  }

  RateControl control_{make_budget(), CodecId::beam, 0.1};
  LinkObserver observer_;
  ArrivalMeter meter_;
  Microseconds now_us_ = 0, clock_us_ = 5'000'000;
  std::uint64_t counter_ = 0, bytes_ = 0;
  std::uint32_t number_ = 0;
};

/// Mean of the last ten.
double settled(const std::vector<std::size_t>& choices) {
  double sum = 0.0;
  for (std::size_t i = choices.size() - 10; i < choices.size(); ++i) {
    sum += static_cast<double>(choices[i]);
  }
  return sum / 10.0;
}

constexpr LinkOptions kNear{.delay_us = 5'000};

TEST(RateControl, BudgetTakesItsShareOfWhatALinkCarries) {
  // 0.8 of the rate, for two thirds of 150 ms less the delay.
  for (const double rate : {100e3, 200e3, 400e3}) {
    Stream stream;
    const auto choices = stream.run(test::steady_trace(rate), kNear, 100);
    EXPECT_NEAR(settled(choices), 0.8 * rate * (0.145 * 2.0 / 3.0), 0.12 * rate * 0.1) << rate;
  }
}

TEST(RateControl, AFastLinkIsFoundToBeFastAndASlowOneSlow) {
  Stream stream;
  EXPECT_EQ(stream.run(test::steady_trace(10e6), kNear, 60).back(), 45'000U);
  EXPECT_EQ(stream.run(test::steady_trace(20e3), kNear, 40).back(), 3'600U);
  EXPECT_EQ(stream.run(test::steady_trace(10e6), kNear, 40).back(), 45'000U);
}

TEST(RateControl, LossAndJitterCostLittle) {
  Stream stream;
  const LinkOptions bad{.delay_us = 30'000, .jitter_us = 10'000, .loss = 0.02};
  const auto choices = stream.run(test::steady_trace(300e3), bad, 200);
  const double ideal = 0.8 * 300e3 * (0.12 * 2.0 / 3.0);
  EXPECT_GT(settled(choices), 0.65 * ideal);
  EXPECT_LT(settled(choices), 1.2 * ideal);
}

TEST(RateControl, AClockThatJumpsIsForgottenWithinTwoSeconds) {
  Stream stream;
  const double before = settled(stream.run(test::steady_trace(200e3), kNear, 60));
  for (const Microseconds by :
       std::initializer_list<Microseconds>{3'600'000'000, -3'600'000'000, 200'000, -200'000}) {
    stream.jump(by);
    static_cast<void>(stream.run(test::steady_trace(200e3), kNear, 20));
    EXPECT_NEAR(settled(stream.run(test::steady_trace(200e3), kNear, 10)), before, 0.2 * before)
        << by;
  }
}

TEST(RateControl, WhatPilesUpOnTheLinkIsTakenOffTheBudget) {
  // 200 kB/s hold 6 kB over a round trip of 10 ms and SRT's 20 ms; what is more is ahead of a
  // sweep.
  const auto choose = [](std::size_t under_way) {
    Stream stream;
    static_cast<void>(stream.run(test::steady_trace(200e3), kNear, 60));
    LinkState link;
    link.time_s = 6.0;
    link.least_round_trip_s = 0.01;
    const RateControl::Situation situation{.bytes_under_way = under_way, .connected = true};
    return static_cast<double>(stream.control().decide(link, situation).bytes);
  };
  EXPECT_EQ(choose(5'000), choose(0));
  EXPECT_NEAR(choose(5'000) - choose(11'000), 5'000, 600);
  EXPECT_EQ(choose(100'000), 3'600);
}

TEST(RateControl, SilenceIsAnOutageAndIsNotCountedTwice) {
  Stream stream;
  static_cast<void>(stream.run(test::steady_trace(200e3), kNear, 60));
  RateControl& control = stream.control();
  const double pace = control.pace();
  RateControl::Situation situation{.bytes_under_way = 10'000, .connected = true};
  LinkState link;
  link.report_age_s = 1.0;
  std::size_t bytes = 0;
  for (int i = 0; i < 5; ++i) {
    link.time_s = 6.0 + 0.1 * i;
    bytes = control.decide(link, situation).bytes;
  }
  EXPECT_LT(bytes, 5'000U);
  const double low = control.pace();
  EXPECT_LT(low, 0.5 * pace);
  control.add({0, 0.4});  // the receiver tells of the same time
  EXPECT_NEAR(control.pace(), low, 0.01 * low);
}

/// Remembers what it was told.
class Witness : public Strategy {
 public:
  Witness(LinkView& seen, std::vector<std::size_t>& levels) : seen_(seen), levels_(levels) {}
  Choice decide(const LinkView& view) override {
    seen_ = view;
    levels_.assign(view.level_bytes.begin(), view.level_bytes.end());
    return {};
  }

 private:
  LinkView& seen_;
  std::vector<std::size_t>& levels_;
};

TEST(RateControl, TellsWhatIsUnderWayAndWhatLevelsTake) {
  LinkView seen;
  std::vector<std::size_t> levels;
  RateControl control(std::make_unique<Witness>(seen, levels), CodecId::rcpcc, 0.05);
  control.begin(0);
  control.add({3'000, 0.02});
  control.add({1'000, 0.01});
  LinkState link;
  link.least_round_trip_s = 0.08;
  static_cast<void>(control.decide(link, {2, 500, 4'000, true, 1}));
  EXPECT_EQ(seen.period_s, 0.05);
  EXPECT_EQ(seen.delay_s, 0.04);
  EXPECT_EQ(seen.queued_frames, 2U);
  EXPECT_EQ(seen.queued_bytes, 4'500U);
  EXPECT_EQ(seen.sent_bytes, 4'000U);
  EXPECT_NEAR(seen.busy_s, 0.03, 1e-12);
  const std::vector<std::size_t> guess = levels;
  ASSERT_EQ(guess.size(), kLevels);

  control.learn(0, guess[0] / 2);
  static_cast<void>(control.decide(link, {.connected = true, .sensors = 2}));
  EXPECT_EQ(seen.sent_bytes, 0U);
  for (std::size_t i = 0; i < kLevels; ++i) {  // half, for each of two sensors
    EXPECT_NEAR(static_cast<double>(levels[i]), static_cast<double>(guess[i]), 2.0);
  }
}

}  // namespace
}  // namespace sweepcast::link
