// `sweepcast odometry`, as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

class OdometryTool : public ToolTest {};

// Where fine cubes held on to the ground, or the first sweep stayed askew, fine maps were worse.
TEST_F(OdometryTool, FinerMapsFollowMoreClosely) {
  ASSERT_EQ(run("simulate -o drive --sweeps 8 --seed 1").exit_status, 0);
  double coarser = 0.05;  // of a metre a sweep
  for (const char* voxel : {"1.0", "0.5", "0.3"}) {
    const Outcome outcome = run(
        std::string("odometry drive -o poses.txt --truth drive/poses.txt --json --voxel ") + voxel);
    ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
    const auto report = outcome.json();
    EXPECT_EQ(report["sweeps"], 8);
    EXPECT_NEAR(report["length_m"].get<double>(), 7.0, 0.1);
    EXPECT_TRUE(report["translation_error_percent"].is_null()) << "no stretch of 100 m";
    EXPECT_LT(report["step_translation_m"].get<double>(), coarser) << "cubes of " << voxel;
    coarser = report["step_translation_m"];
  }
}

TEST_F(OdometryTool, NamesWhatIsWrong) {
  write_bin("sweep.bin", make_room(0.0F));
  expect_failure(run("odometry absent -o p.txt"), 1, {"absent"});
  expect_failure(run("odometry sweep.bin -o p.txt --voxel 0"), 2, {"--voxel"});
  expect_failure(run("odometry sweep.bin -o p.txt --truth no.txt"), 1, {"no.txt"});
  write("few.txt", "");
  expect_failure(run("odometry sweep.bin -o p.txt --truth few.txt"), 1, {"few.txt", "0 poses"});
  write("text.txt", "1 0 0 0 0 1 0 0 0 0 1\n");
  expect_failure(run("odometry sweep.bin -o p.txt --truth text.txt"), 1, {"text.txt"});
  expect_failure(run("odometry sweep.bin -o p.txt --min-range 50 --max-range 10"), 1,
                 {"sweep.bin", "--min-range"});
  EXPECT_FALSE(exists("p.txt"));
  expect_failure(run("odometry sweep.bin -o ./sweep.bin"), 1, {"sweep.bin", "another output"});
  expect_failure(run("odometry sweep.bin -o few.txt --truth few.txt"), 1, {"another output"});
  expect_failure(run("mesh sweep.bin --poses few.txt -o few.txt"), 1, {"another output"});
  write_bin("raw/sweep.bin", make_room(0.0F));
  expect_failure(run("mesh sweep.bin --poses few.txt --originals raw -o raw/sweep.bin"), 1,
                 {"another output"});
  EXPECT_EQ(read("few.txt"), "");
  expect_failure(run("odometry sweep.bin -o no/p.txt"), 1, {"no/p.txt"});
}

}  // namespace
}  // namespace sweepcast::test
