// `sweepcast simulate-link`, as a user runs it.
#include <gtest/gtest.h>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

class SimulateLinkTest : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write_bin("sweeps/0.bin", make_room(0.0F));
    write_bin("sweeps/1.bin", make_room(0.05F));
    write("narrow.schedule", "0 40\n3 4\n5 40\n8 end\n");
  }
};

TEST_F(SimulateLinkTest, JsonHasAnObjectAStrategy) {
  const Outcome outcome = run("simulate-link --trace narrow.schedule --sweeps sweeps --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto report = outcome.json();
  ASSERT_EQ(report.size(), 6U);
  double limit = 0.0;
  for (const auto& entry : report) {
    EXPECT_EQ(entry["codec"], "beam");
    EXPECT_EQ(entry["trace"], "narrow.schedule");
    EXPECT_EQ(entry["sweeps"], 80);
    EXPECT_DOUBLE_EQ(entry["outage_share"].get<double>(), 0.25);  // 4 KB/s for 2 s of 8
    for (const char* key : {"mean_qoe", "age_p50_ms", "age_p95_ms", "age_p99_ms", "delivered_150ms",
                            "dropped", "bytes_sent", "mean_f10", "mean_d2"}) {
      EXPECT_TRUE(entry[key].is_number()) << key;
    }
    EXPECT_LE(entry["delivered_150ms"].get<double>(), 1.0);
    EXPECT_LE(entry["mean_f10"].get<double>(), 100.0);
    if (entry["strategy"] == "offline") limit = entry["mean_qoe"].get<double>();
  }
  for (const auto& entry : report) {
    EXPECT_LE(entry["mean_qoe"].get<double>(), limit + 1e-9) << entry["strategy"];
  }
}

TEST_F(SimulateLinkTest, IsTheSameEveryTime) {
  const std::string arguments =
      "simulate-link --trace narrow.schedule --sweeps sweeps --strategy budget,paper --delay 20 "
      "--jitter 15 --loss 3 --reorder 2 --seed 9 --queue-limit 50000 --json";
  const Outcome first = run(arguments);
  ASSERT_EQ(first.exit_status, 0) << first.err;
  EXPECT_EQ(first.out, run(arguments).out);
}

TEST_F(SimulateLinkTest, CsvHasALineASweepAndTheTableALineAStrategy) {
  const Outcome outcome =
      run("simulate-link --codec rcpcc --strategy paper,fixed:5 --duration 3 --sweeps sweeps "
          "--csv fates.csv");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const std::string csv = read("fates.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 30);
  EXPECT_EQ(csv.substr(0, 16), "strategy,time_s,");
  EXPECT_NE(outcome.out.find("\npaper "), std::string::npos);
  EXPECT_NE(outcome.out.find("\nfixed:5 "), std::string::npos);
}

TEST_F(SimulateLinkTest, ErrorsNameWhatIsWrong) {
  const Outcome strategy = run("simulate-link --strategy best --sweeps sweeps");
  EXPECT_EQ(strategy.exit_status, 2);
  EXPECT_NE(strategy.err.find("--strategy: \"best\" is not one of budget, paper, bola, mpc"),
            std::string::npos)
      << strategy.err;
  const Outcome trace = run("simulate-link --trace none.up --sweeps sweeps");
  EXPECT_EQ(trace.exit_status, 1);
  EXPECT_NE(trace.err.find("none.up"), std::string::npos);
  write("damaged.up", "10\nten\n");
  const Outcome damaged = run("simulate-link --trace damaged.up --sweeps sweeps");
  EXPECT_EQ(damaged.exit_status, 1);
  EXPECT_NE(damaged.err.find("damaged.up: line 2"), std::string::npos);
  EXPECT_EQ(run("simulate-link --sweeps sweeps --loss 200").exit_status, 2);
  EXPECT_EQ(run("simulate-link --trace paper").exit_status, 2);
}

}  // namespace
}  // namespace sweepcast::test
