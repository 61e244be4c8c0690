// `sweepcast detect`, as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

class Detect : public ToolTest {};

TEST_F(Detect, FindsAndScoresCarsOfADrive) {
  ASSERT_EQ(run("simulate -o drive --sweeps 3").exit_status, 0);
  const Outcome outcome =
      run("detect drive -o found --detector clusters --truth drive/boxes "
          "--json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_TRUE(outcome.err.empty());
  const auto report = outcome.json();
  EXPECT_EQ(report["sweeps"], 3);
  EXPECT_GT(report["boxes"], 10);
  EXPECT_GT(report["bev_ap50"], 40.0);
  EXPECT_GE(report["bev_ap50"], report["bev_ap70"]);
  EXPECT_GE(report["ap50_3d"], report["ap70_3d"]);
  EXPECT_GE(report["bev_ap50"], report["ap50_3d"]);
  EXPECT_TRUE(exists("found/000002.txt"));
  // What was found, as the truth of itself: all of it is right.
  const Outcome self =
      run("detect drive -o again --detector clusters --truth found --json --min-points 0");
  ASSERT_EQ(self.exit_status, 0) << self.err;
  EXPECT_NEAR(self.json()["ap70_3d"].get<double>(), 100.0, 1e-9);
}

TEST_F(Detect, NamesWhatIsWrong) {
  write_bin("sweep.bin", make_room(0.0F));
  const std::string detect = "detect sweep.bin -o out --detector clusters ";
  expect_failure(run(detect + "--truth no"), 1, {"no: is no folder"});
  write("bare/other.txt", "");
  expect_failure(run(detect + "--truth bare"), 1, {"bare/sweep.txt"});
  write("bad/sweep.txt", "Car 1 2\n");
  expect_failure(run(detect + "--truth bad"), 1, {"bad/sweep.txt: line 1"});
  expect_failure(run("detect sweep.bin -o bad/. --detector clusters --truth bad"), 1,
                 {"another output"});
  EXPECT_EQ(read("bad/sweep.txt"), "Car 1 2\n");
  expect_failure(run("detect sweep.bin -o out --weights absent"), 1, {"sweepcast"});
  expect_failure(run("detect sweep.bin -o out --detector eyes"), 2, {"eyes"});
  expect_failure(run("train-detector absent -o w"), 1, {"absent"});
  EXPECT_FALSE(exists("w"));
}

}  // namespace
}  // namespace sweepcast::test
