#include "link/trace.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

namespace sweepcast {
namespace {

using Times = std::vector<std::int64_t>;

TEST(Trace, MahimahiHasAnOpportunityALineAndRepeatsAtItsLast) {
  const auto trace = parse_mahimahi("0\n3\n3\r\n\n10\n", "car");
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->opportunities_us, (Times{0, 3000, 3000, 10000}));
  EXPECT_EQ(trace->period_us, 10000);
  EXPECT_EQ(trace->name, "car");
}

TEST(Trace, MahimahiErrorsNameTheLine) {
  const auto code = [](std::string_view text) { return parse_mahimahi(text, "").error().code; };
  EXPECT_EQ(code(""), ErrorCode::truncated);
  EXPECT_EQ(code("0\n0\n"), ErrorCode::truncated);
  EXPECT_EQ(code("5\n4\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("5 6\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("-5\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("5.5\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("99999999999999999999\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("86400001\n"), ErrorCode::limit);
  EXPECT_NE(parse_mahimahi("5\n4\n", "").error().message.find("line 2"), std::string::npos);
}

TEST(Trace, ScheduleSendsWhereBytesHaveComeTogether) {
  // 3 KB/s: every 500 ms; from 1.25 s on 6 KB/s: half an opportunity is left over.
  const auto trace = parse_schedule("# test\n0 3\n1.25 6 # faster\n2 end\n", "s");
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->opportunities_us, (Times{500'000, 1'000'000, 1'375'000, 1'625'000, 1'875'000}));
  EXPECT_EQ(trace->period_us, 2'000'000);
}

TEST(Trace, ScheduleErrors) {
  const auto code = [](std::string_view text) { return parse_schedule(text, "").error().code; };
  EXPECT_EQ(code(""), ErrorCode::truncated);
  EXPECT_EQ(code("0 100\n"), ErrorCode::truncated);
  EXPECT_EQ(code("0 0\n9 end\n"), ErrorCode::truncated);
  EXPECT_EQ(code("0 end\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("1 100\n2 end\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("0 100\n0 end\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("0 100\n2 end\n3 end\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("0 -1\n2 end\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("0 nan\n2 end\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("0 100 5\n2 end\n"), ErrorCode::corrupt);
  EXPECT_EQ(code("0 inf\n2 end\n"), ErrorCode::limit);
  EXPECT_EQ(code("0 1e6\n80000 end\n"), ErrorCode::limit);
}

TEST(Trace, PaperOffersWhatItsExperimentTells) {
  const Trace trace = paper_trace();
  EXPECT_EQ(trace.period_us, 300'000'000);
  const auto seconds = bytes_per_second(trace, 301);
  const auto sum = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    return std::accumulate(seconds.begin() + from, seconds.begin() + to, std::int64_t{0});
  };
  EXPECT_NEAR(static_cast<double>(sum(0, 55)), 55 * 300e3, 3000);
  EXPECT_NEAR(static_cast<double>(sum(55, 120)), 65 * 100e3, 3000);
  EXPECT_NEAR(static_cast<double>(sum(120, 245)), 125 * 130e3, 3000);
  EXPECT_NEAR(static_cast<double>(sum(245, 300)), 55 * 160e3, 3000);
  EXPECT_NEAR(static_cast<double>(seconds[300]), 300e3, 3000);  // it repeats
}

TEST(Trace, ReadsFilesByTheirExtension) {
  const auto folder = std::filesystem::temp_directory_path() / "sweepcast_trace_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "a.schedule") << "0 15\n1 end\n";
  std::ofstream(folder / "a.up") << "0 15\n";
  const auto schedule = read_trace(folder / "a.schedule");
  ASSERT_TRUE(schedule);
  EXPECT_EQ(schedule->name, "a.schedule");
  EXPECT_EQ(schedule->opportunities_us.size(), 10U);
  const auto damaged = read_trace(folder / "a.up");
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().message.find("a.up"), std::string::npos);
  EXPECT_EQ(read_trace(folder / "b").error().code, ErrorCode::not_found);
  EXPECT_EQ(read_trace("paper")->name, "paper");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace sweepcast
