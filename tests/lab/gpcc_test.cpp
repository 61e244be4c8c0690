// The program is played by shell scripts that the tests write.
#include "lab/peers/gpcc.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/points.hpp"
#include "core/random.hpp"
#include "lab/distortion.hpp"
#include "lab/peers/run_program.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

/// Reads the options of either mode into variables of the shell: in, out, mode.
constexpr const char* kOptions = R"(#!/bin/sh
for word in "$@"; do
  case $word in
    --mode=*) mode=${word#*=} ;;
    --uncompressedDataPath=*) in=${word#*=} ;;
    --compressedStreamPath=*) stream=${word#*=} ;;
    --reconstructedDataPath=*) out=${word#*=} ;;
  esac
done
[ "$mode" = 0 ] && out=$stream || in=${in:-$stream}
)";

class Gpcc : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "sweepcast-gpcc-test-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    const char* old = std::getenv("TMPDIR");
    old_ = old != nullptr ? old : "";
    fs::create_directory(folder_ / "tmp");
    setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
  }
  void TearDown() override {
    EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));  // nothing is left behind
    old_.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", old_.c_str(), 1);
    fs::remove_all(folder_);
  }

  std::unique_ptr<Peer> peer(const std::string& script, double step_m = 0.05) {
    const fs::path program = folder_ / "tmc3";
    std::ofstream(program) << kOptions << script << '\n';
    fs::permissions(program, fs::perms::owner_all);
    auto made = make_gpcc_peer({.step_m = step_m, .program = program.string()});
    EXPECT_TRUE(made) << made.error().message;
    return made ? std::move(*made) : nullptr;
  }

  static PointCloud noise() {
    std::mt19937 random(2);
    PointCloud cloud;
    for (int i = 0; i < 500; ++i) {
      test::add_point(cloud, test::uniform(random, -50, 50), test::uniform(random, -50, 50),
                      test::uniform(random, -2, 2));
    }
    return cloud;
  }

  fs::path folder_;
  std::string old_;
};

TEST_F(Gpcc, WhatTheProgramCopiesComesBackWithinHalfADiagonal) {
  const auto copies = peer("i=0; while [ $i -lt 3000 ]; do i=$((i+1)); done; cp \"$in\" \"$out\"");
  PointCloud cloud = noise();
  cloud.x[7] = std::nanf("");
  const auto bytes = copies->encode(cloud);
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_GT(copies->child_ms(), 0.0);
  PointCloud decoded;
  const Status status = copies->decode(*bytes, decoded);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_GT(copies->child_ms(), 0.0);
  EXPECT_EQ(decoded.size(), cloud.size() - 1);
  EXPECT_LE(compare(cloud, decoded).max_o2d, std::sqrt(3.0) / 2 * 0.05 + 1e-5);
  EXPECT_GT(compare(cloud, decoded).max_o2d, 0.02);
  EXPECT_EQ(copies->codec(), "gpcc-octree");
  EXPECT_EQ(copies->setting(), "step 0.05 m");
}

TEST_F(Gpcc, SweepsWithoutPointsDoNotRunIt) {
  const auto fails = peer("exit 1");
  const auto bytes = fails->encode(PointCloud{});
  ASSERT_TRUE(bytes);
  PointCloud decoded = noise();
  EXPECT_TRUE(fails->decode(*bytes, decoded));
  EXPECT_TRUE(decoded.empty());
  EXPECT_EQ(fails->child_ms(), 0.0);
}

TEST_F(Gpcc, AProgramThatFailsIsAnErrorWithItsLastWords) {
  const auto fails = peer("echo first; echo 'no such profile' >&2; exit 3");
  const auto bytes = fails->encode(noise());
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().code, ErrorCode::io);
  EXPECT_NE(bytes.error().message.find("exit status 3: no such profile"), std::string::npos)
      << bytes.error().message;
  const auto dies = peer("kill -SEGV $$");
  const auto none = dies->encode(noise());
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("signal 11"), std::string::npos) << none.error().message;
  const auto idle = peer("exit 0");  // success, but no file
  EXPECT_FALSE(idle->encode(noise()));
}

TEST_F(Gpcc, DamagedOutputIsAnErrorAndNoCloud) {
  const auto copies = peer("cp \"$in\" \"$out\"");
  const auto bytes = copies->encode(noise());
  ASSERT_TRUE(bytes) << bytes.error().message;
  const std::vector<std::byte> frame(bytes->begin(), bytes->end());
  const std::string header =
      "ply\\nformat ascii 1.0\\nelement vertex 1\\nproperty float x\\nproperty float y\\nproperty "
      "float z\\nend_header\\n";
  for (const std::string place : {"1 2", "1 2 nan", "-1 0 0", "1 1 1e30"}) {
    const auto damaged = peer("printf '" + header + place + "\\n' > \"$out\"");
    PointCloud decoded = noise();
    EXPECT_FALSE(damaged->decode(frame, decoded)) << place;
    EXPECT_TRUE(decoded.empty());
  }
  for (const std::string script :
       {"echo noise > \"$out\"", "head -c 200 \"$in\" > \"$out\"", "exit 0", ": > \"$out\""}) {
    const auto damaged = peer(script);
    PointCloud decoded;
    EXPECT_FALSE(damaged->decode(frame, decoded)) << script;
    EXPECT_TRUE(decoded.empty());
  }
  PointCloud decoded;
  for (std::size_t size = 1; size < 30; ++size) {
    EXPECT_FALSE(copies->decode(std::span(frame).first(size), decoded)) << size;
  }
}

TEST_F(Gpcc, AnAbsentProgramAndWrongStepsAreRefused) {
  const auto absent = make_gpcc_peer({.program = "sweepcast-no-such-program"});
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::not_found);
  EXPECT_NE(absent.error().message.find("PATH"), std::string::npos);
  EXPECT_FALSE(make_gpcc_peer({.step_m = 0.0, .program = "sh"}));
  EXPECT_TRUE(has_program("sh"));
  EXPECT_FALSE(
      has_program("/"
                  "nowhere/sh"));
  const auto gone = run_program({"sweepcast-no-such-program"}, folder_ / "log");
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace sweepcast::lab
