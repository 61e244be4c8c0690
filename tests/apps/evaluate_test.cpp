// `sweepcast evaluate` as a user runs it.
#include <gtest/gtest.h>

#include <csignal>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

/// A room that is walked through: sweeps with poses.
class EvaluateTool : public ToolTest {
 protected:
  void make_drive(int sweeps) const {
    for (int i = 0; i < sweeps; ++i) {
      const std::string name = std::to_string(1000 + i);
      write_bin("drive/sweeps/" + name + ".bin", make_room(0.05F * static_cast<float>(i)));
    }
  }

  [[nodiscard]] nlohmann::json results(const std::string& folder) const {
    return nlohmann::json::parse(read(folder + "/results.json"));
  }

  static constexpr const char* kQuick = " --tasks distortion --codec rcpcc --peers none ";
};

TEST_F(EvaluateTool, WritesResultsTablesAndAPage) {
  make_drive(3);
  const Outcome outcome = run("evaluate drive -o out/report --codec rcpcc --peers zstd");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(list("out/report"), (std::vector<std::string>{"cache", "parts.csv", "report.html",
                                                          "results.csv", "results.json"}));
  EXPECT_NE(outcome.out.find("distortion: 1 of 3 sweeps (every 5th)"), std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.out.find("Left out: odometry"), std::string::npos);
  const auto rows = results("out/report");
  ASSERT_EQ(rows.size(), 1U + 6U + 5U);
  EXPECT_EQ(rows[0]["codec"], "original");
  EXPECT_EQ(rows[0]["ratio"], 1.0);
  EXPECT_TRUE(rows[0]["mesh_f10"].is_null());
  EXPECT_TRUE(rows[0]["step_translation_m"].is_null());
  EXPECT_EQ(rows[0]["f_score"]["0.10"], 100.0);
  EXPECT_EQ(rows[1]["codec"], "rcpcc");
  EXPECT_GT(rows[1]["ratio"].get<double>(), 1.0);
  const std::string page = read("out/report/report.html");
  EXPECT_NE(page.find("drive"), std::string::npos);
  EXPECT_LT(page.size(), 3'000'000U);
}

TEST_F(EvaluateTool, ASecondRunMeasuresNothing) {
  make_drive(2);
  ASSERT_EQ(run(std::string("evaluate drive -o r") + kQuick).exit_status, 0);
  const std::string page = read("r/report.html"), json = read("r/results.json");
  const Outcome again = run(std::string("evaluate drive -o r") + kQuick);
  EXPECT_NE(again.out.find("0 results measured, 14 had from before"), std::string::npos)
      << again.out;
  EXPECT_EQ(read("r/report.html"), page);
  EXPECT_EQ(read("r/results.json"), json);
}

TEST_F(EvaluateTool, AStoppedRunGoesOn) {
  make_drive(60);
  const auto begun = [&] { return exists("r/cache") && !list("r/cache").empty(); };
  const std::vector<std::string> words{"evaluate",   "drive",   "-o",    "r",       "--tasks",
                                       "distortion", "--codec", "rcpcc", "--peers", "none"};
  interrupt(words, SIGTERM, begun);
  std::size_t kept = 0;
  for (const std::string& name : list("r/cache")) {
    if (name.front() != '.') ++kept;
  }
  const Outcome outcome = run(std::string("evaluate drive -o r") + kQuick);
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "") << "nothing that was stopped is damaged";
  EXPECT_NE(outcome.out.find(", " + std::to_string(kept) + " had from before"), std::string::npos)
      << kept << " in " << outcome.out;
  EXPECT_EQ(results("r").size(), 7U);
}

TEST_F(EvaluateTool, NamesWhatIsWrong) {
  make_drive(2);
  expect_failure(run("evaluate nowhere -o r"), 1, {"nowhere", "does not exist"});
  expect_failure(run("evaluate drive -o r --tasks painting"), 2, {"--tasks", "painting"});
  expect_failure(run("evaluate drive -o r --peers gzip"), 2, {"--peers", "gzip"});
  expect_failure(run("evaluate drive -o drive/sweeps/1000.bin"), 1, {"1000.bin", "a folder"});
  expect_failure(run("evaluate drive -o r --weights absent.weights"), 1, {});
  expect_failure(run("detect drive -o r --detector clusters --truth absent"), 1, {"absent"});
  write("drive/sweeps/1001.bin", "not a cloud");
  expect_failure(run(std::string("evaluate drive -o r") + kQuick), 1, {"1001.bin"});
}

}  // namespace
}  // namespace sweepcast::test
