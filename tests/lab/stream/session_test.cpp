#include "lab/stream/session.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "lab/stream/frame_sets.hpp"
#include "lab/stream/summary.hpp"

namespace sweepcast::lab {
namespace {

/// 15 KB/s: 1500 bytes every 100 ms, at the sweeps' own instants.
Trace slow_trace() {
  return {"slow", {100'000, 200'000, 300'000, 400'000, 500'000}, 500'000};
}

SessionOptions sweeps(std::size_t count) {
  SessionOptions options;
  options.sweeps = count;
  return options;
}

TEST(Session, OldestFirstIsAQueue) {
  // Frames of two opportunities each, one opportunity a sweep: each waits as long as all before.
  const FrameSet frames = ladder_of({3000, 2500, 2000, 1500, 1000, 500});
  const auto strategy = make_fixed(0);
  const auto fates = run_session(frames, slow_trace(), sweeps(6), *strategy);
  ASSERT_EQ(fates.size(), 6U);
  for (std::size_t i = 0; i < fates.size(); ++i) {
    const auto n = static_cast<std::int64_t>(i);
    EXPECT_EQ(fates[i].ready_us, 100'000 * (n + 1));
    // Opportunities 2 n and 2 n + 1 are its own; the first is at 100 ms.
    EXPECT_EQ(fates[i].decoded_us, 100'000 * (2 * n + 2));
    EXPECT_EQ(fates[i].bytes, 3000U);
    EXPECT_EQ(fates[i].sent.layers, 1U);
    EXPECT_EQ(fates[i].queued_frames, (i + 1) / 2);
  }
}

TEST(Session, ModelsComeEveryTenthSweep) {
  FrameSet frames = ladder_of({1000, 900, 800, 700, 600, 500});
  for (FrameSize& size : frames.sizes[0]) size.model = 100;
  const auto strategy = make_fixed(5);
  const auto fates = run_session(frames, slow_trace(), sweeps(21), *strategy);
  for (std::size_t i = 0; i < fates.size(); ++i) {
    EXPECT_EQ(fates[i].bytes, i % 10 == 0 ? 600U : 500U);
  }
}

TEST(Session, WhatFindsNoRoomInTheQueueIsDropped) {
  const FrameSet frames = ladder_of({3000, 2500, 2000, 1500, 1000, 500});
  SessionOptions options = sweeps(40);
  options.link.queue_limit = 6000;
  const auto strategy = make_fixed(0);
  const auto fates = run_session(frames, slow_trace(), options, *strategy);
  std::size_t skipped = 0;
  for (const SweepFate& fate : fates) {
    EXPECT_LE(fate.queued_bytes, 6000U);
    EXPECT_EQ(fate.skipped, fate.sent.layers == 0);
    if (fate.skipped) ++skipped;
  }
  EXPECT_NEAR(static_cast<double>(skipped), 20.0, 2.0);  // half of them fit the link
}

TEST(Session, LostPacketsAreSentAgain) {
  const FrameSet frames = ladder_of({3000, 2500, 2000, 1500, 1000, 900});
  SessionOptions options = sweeps(2000);
  options.link.loss = 0.1;
  options.link.delay_us = 20'000;
  const auto strategy = make_fixed(5);
  const auto fates = run_session(frames, slow_trace(), options, *strategy);
  std::size_t twice = 0;
  for (const SweepFate& fate : fates) {
    EXPECT_EQ(fate.sent.layers, 1U);
    if (fate.bytes > 900) ++twice;
    const std::int64_t latency_us = fate.decoded_us - fate.ready_us;
    EXPECT_GE(latency_us, 20'000);
    if (fate.bytes > 900) {
      EXPECT_GE(latency_us, 100'000);
    }
  }
  EXPECT_NEAR(static_cast<double>(twice), 200.0, 45.0);
}

TEST(Session, SameSeedSameFates) {
  const FrameSet frames = ladder_of({9000, 7000, 5000, 3000, 1500, 700});
  SessionOptions options = sweeps(300);
  options.link = {.delay_us = 10'000, .jitter_us = 30'000, .loss = 0.05, .reordering = 0.1};
  const auto first = make_paper();
  const auto second = make_paper();
  const auto a = run_session(frames, paper_trace(), options, *first);
  const auto b = run_session(frames, paper_trace(), options, *second);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].decoded_us, b[i].decoded_us);
    EXPECT_EQ(a[i].sent, b[i].sent);
    EXPECT_EQ(a[i].bytes, b[i].bytes);
  }
}

/// Three sweeps: decoded after 60 ms; never; after 260 ms.
TEST(Summary, IsAsReckonedByHand) {
  const FrameSet frames = ladder_of({3000, 2500, 2000, 1500, 1000, 500});
  std::vector<SweepFate> fates(3);
  fates[0] = {100'000, {0, 0, 1}, false, 0, 0, 3000, 160'000};
  fates[1] = {200'000, {0, 1, 0}, true, 1, 0, 0, 0};
  fates[2] = {300'000, {0, 2, 1}, false, 2, 0, 2000, 560'000};
  StreamSummary summary;
  const Trace trace{"steady", {5'000, 10'000}, 10'000};
  summarise(fates, frames, trace, SendOrder::oldest_first, summary);
  EXPECT_EQ(summary.sweeps, 3U);
  // q: 25, 0, 15; K: 0, 1, 2; changes: 25, 15.
  EXPECT_DOUBLE_EQ(summary.mean_qoe, (40.0 - 1.5 - 40.0) / 3.0);
  EXPECT_DOUBLE_EQ(summary.mean_f10, (90.0 + 70.0) / 3.0);
  EXPECT_DOUBLE_EQ(summary.mean_d2, (45.0 + 35.0) / 3.0);
  EXPECT_EQ(summary.dropped, 1U);
  EXPECT_EQ(summary.bytes_sent, 5000U);
  EXPECT_DOUBLE_EQ(summary.delivered_150ms, 1.0 / 3.0);
  // Samples at 0, 10, ... 150 ms: as old as the drive; at 160 ... 290: less 100. Thirty in all; the
  // middle one of 0 to 150 and 60 to 190 is the 15th.
  EXPECT_EQ(summary.age_p50_ms, 100.0);
  EXPECT_EQ(summary.age_p99_ms, 190.0);
  EXPECT_EQ(summary.outage_share, 0.0);
}

TEST(Summary, LeavesOutagesOut) {
  const FrameSet frames = ladder_of({3000, 2500, 2000, 1500, 1000, 500});
  // The first second carries 16,500 bytes, the next one nothing, and so on.
  Trace trace{"gaps", {}, 2'000'000};
  for (std::int64_t k = 1; k <= 11; ++k) trace.opportunities_us.push_back(k * 80'000);
  const auto strategy = make_fixed(5);
  const auto fates = run_session(frames, trace, sweeps(40), *strategy);
  StreamSummary summary;
  summarise(fates, frames, trace, SendOrder::oldest_first, summary);
  EXPECT_DOUBLE_EQ(summary.outage_share, 0.5);
  // In the seconds that count, sweeps are ready at 100 ... 900 ms and at 2000, 2100 ... 2900, 4000.
  // Those at 900 and 2900 ms miss the last opportunity; that at 2000 waits for those in between,
  // but all of them are through at 2240 ms.
  EXPECT_NEAR(summary.delivered_150ms, 16.0 / 21.0, 0.1);
  EXPECT_LE(summary.age_p95_ms, 1200.0);
}

}  // namespace
}  // namespace sweepcast::lab
