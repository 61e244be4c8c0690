// keygen, send and receive, run as a user runs them.
#include <gtest/gtest.h>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

class LiveTool : public ToolTest {
 protected:
  /// Starts a receiver on a free port; sets `PORT` for the rest of the line.
  static std::string receiving(const std::string& output, const std::string& more = "") {
    return "\"$SWEEPCAST\" receive --listen 0 --keys k -o " + output + " " + more +
           " 2>note & R=$!; until grep -q listening note; do kill -0 $R || exit 9; done; "
           "PORT=$(sed -n 's/.*listening at .*:\\([0-9]*\\)$/\\1/p' note); ";
  }
  void SetUp() override {
    ToolTest::SetUp();
    make_recording(3);
    ASSERT_EQ(run("keygen k --robot rover").exit_status, 0);
  }
};

TEST_F(LiveTool, ARecordingArrivesWhole) {
  const Outcome outcome =
      shell(receiving("got", "--json >report") +
            "\"$SWEEPCAST\" send room.sweep --to 127.0.0.1:$PORT --key k --sensor roof "
            "--deadline 10000 --rate 2 --strategy fixed:0 --json; echo $?; kill -TERM $R; "
            "wait $R; echo $?");
  EXPECT_NE(outcome.out.find("\"sent\": 3"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("}\n0\n0\n"), std::string::npos) << outcome.out << read("note");
  const auto told = nlohmann::json::parse(read("report"), nullptr, false)["robots"]["rover"];
  EXPECT_EQ(told["sent"], 3) << read("report");
  EXPECT_EQ(told["queue_frames"], 0);
  EXPECT_TRUE(told["level"].is_null());  // its frames are made already, at whatever level
  EXPECT_TRUE(told["qoe"].is_null());
  EXPECT_EQ(list("got/rover"), (std::vector<std::string>{"roof.sweep"}));
  const auto info = run("info got/rover/roof.sweep --json").json();
  ASSERT_EQ(info["frames"].size(), 3U);
  EXPECT_EQ(info["frames"][2]["name"], "000002");
  EXPECT_EQ(run("decode got/rover/roof.sweep -o a").exit_status, 0);
  EXPECT_EQ(run("decode room.sweep -o b").exit_status, 0);
  EXPECT_EQ(read("a/000002.bin"), read("b/000002.bin"));
}

TEST_F(LiveTool, CloudsAreEncodedStreamedAndRecorded) {
  const Outcome outcome =
      shell(receiving("got.sweep", "--json >report") +
            "\"$SWEEPCAST\" send sweeps --to 127.0.0.1:$PORT --key k --deadline 10000 --rate 2 "
            "--record kept.sweep >/dev/null; cat room.sweep | \"$SWEEPCAST\" send - --to "
            "127.0.0.1:$PORT --key k --deadline 10000 --rate 2 --json; kill -TERM $R; wait $R; "
            "echo $?");
  EXPECT_NE(outcome.out.find("\"sweeps\": 3"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_EQ(run("info kept.sweep --json").json()["frames"].size(), 3U);
  EXPECT_EQ(run("decode kept.sweep -o kept").exit_status, 0);
  EXPECT_EQ(run("info got.sweep --json").json()["frames"].size(), 6U) << read("report");
  EXPECT_EQ(run("decode got.sweep -o got").exit_status, 0);
}

TEST_F(LiveTool, AReceiverEndsCleanlyWithoutAnySweep) {
  const Outcome outcome = shell(receiving("-", ">out.sweep") + "kill -TERM $R; wait $R; echo $?");
  EXPECT_EQ(outcome.out, "0\n");
  EXPECT_EQ(run("info out.sweep --json").json()["frames"].size(), 0U);
}

/// A script's shell makes what it starts with & ignore SIGINT.
TEST_F(LiveTool, AnInterruptEndsAReceiverThatAScriptStarted) {
  const Outcome outcome = shell(receiving("-", ">out.sweep") + "kill -INT $R; wait $R; echo $?");
  EXPECT_EQ(outcome.out, "0\n");
}

TEST_F(LiveTool, ASenderEndsCleanlyWithoutAReceiver) {
  const Outcome outcome = shell(
      "\"$SWEEPCAST\" send sweeps --to 127.0.0.1:9 --key k --loop --record kept.sweep & "
      "until [ -s kept.sweep ]; do kill -0 $! || exit 9; done; kill -TERM $!; wait $!; echo $?");
  EXPECT_NE(outcome.out.find("\n0\n"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_EQ(run("decode kept.sweep -o kept").exit_status, 0);
}

TEST_F(LiveTool, WhatHasAnEndWaitsForTheReceiver) {
  // The port of a receiver that is not there yet: it was, a moment ago.
  const Outcome outcome = shell(
      receiving("first") +
      "kill -TERM $R; wait $R; \"$SWEEPCAST\" send sweeps --to 127.0.0.1:$PORT --key k --rate 20 "
      "--deadline 10000 --wait 60 --strategy fixed:1 --json >sent & S=$!; "
      "\"$SWEEPCAST\" receive --listen $PORT --keys k -o got 2>/dev/null & R=$!; "
      "wait $S; echo $?; kill -TERM $R; wait $R; echo $?");
  EXPECT_EQ(outcome.out, "0\n0\n") << outcome.err;
  EXPECT_NE(read("sent").find("\"sent\": 3"), std::string::npos) << read("sent");
  EXPECT_EQ(run("info got/rover/lidar.sweep --json").json()["frames"].size(), 3U);
  expect_failure(run("send sweeps --to 127.0.0.1:9 --key k --wait 0"), 1,
                 {"127.0.0.1:9", "never connected"});
}

TEST_F(LiveTool, LevelsAreChosenForClouds) {
  const Outcome outcome = shell(
      receiving("got") +
      "for s in paper mpc; do \"$SWEEPCAST\" send sweeps --to 127.0.0.1:$PORT --key k "
      "--deadline 10000 --sensor $s --strategy $s >/dev/null; done; \"$SWEEPCAST\" send sweeps "
      "--to 127.0.0.1:$PORT --key k --deadline 10000 --sensor plan --codec rcpcc >/dev/null; "
      "kill -TERM $R; wait $R; echo $?");
  EXPECT_EQ(outcome.out, "0\n") << outcome.err;
  for (const char* sensor : {"paper", "mpc", "plan"}) {
    const std::string file = std::string("got/rover/") + sensor + ".sweep";
    EXPECT_EQ(run("info " + file + " --json").json()["frames"].size(), 3U) << sensor;
    EXPECT_EQ(run("decode " + file + " -o " + sensor).exit_status, 0);
  }
  expect_failure(run("send room.sweep --to 127.0.0.1:9 --key k --strategy mpc"), 1,
                 {"room.sweep", "budget"});
}

TEST_F(LiveTool, SignalsThatWereIgnoredOrComeTwiceStillCloseRecordings) {
  // What a shell starts in the background ignores SIGINT; timeout sends SIGTERM twice.
  const Outcome outcome = shell(
      "(trap '' INT; exec \"$SWEEPCAST\" receive --listen 0 --keys k -o got.sweep 2>note) & "
      "R=$!; until grep -q listening note; do kill -0 $R || exit 9; done; "
      "PORT=$(sed -n 's/.*listening at .*:\\([0-9]*\\)$/\\1/p' note); "
      "(trap '' INT; exec \"$SWEEPCAST\" send sweeps --to 127.0.0.1:$PORT --key k --loop "
      "--record kept.sweep >/dev/null) & S=$!; "
      "until [ $(wc -c <kept.sweep) -gt 200 ] && [ $(wc -c <got.sweep) -gt 200 ]; "  // a frame
      "do kill -0 $S || exit 9; done; "
      "kill -INT $S; wait $S; echo $?; kill -INT $R; wait $R; echo $?; "
      "timeout 2 \"$SWEEPCAST\" send sweeps --to 127.0.0.1:9 --key k --loop --record "
      "timed.sweep >/dev/null; echo $?");
  EXPECT_EQ(outcome.out, "0\n0\n124\n") << outcome.err;
  for (const char* file : {"kept.sweep", "got.sweep", "timed.sweep"}) {
    const auto info = run(std::string("info ") + file + " --json").json();
    EXPECT_EQ(info["index_rebuilt"], false) << file;
    EXPECT_GE(info["frames"].size(), 1U) << file;
  }
}

TEST_F(LiveTool, AFullDiskLosesSweepsAndNothingElse) {
  // Recordings may have 8 KiB here: a few sweeps. Receiving goes on, and the sender sees nothing.
  const Outcome outcome = shell(
      "ulimit -f 8; " + receiving("got", "--json >report") +
      "\"$SWEEPCAST\" send sweeps --to 127.0.0.1:$PORT --key k --loop --rate 50 --strategy fixed:0 "
      "--json >sent & S=$!; until grep -q 'receiving goes on' note; do kill -0 $R || exit 9; done; "
      "kill -TERM $S; wait $S; echo $?; kill -TERM $R; wait $R; echo $?");
  EXPECT_EQ(outcome.out, "0\n1\n") << outcome.err << read("note");
  EXPECT_NE(read("note").find("could not be written; those that were are whole"), std::string::npos)
      << read("note");
  const Outcome decoded = run("decode got/rover/lidar.sweep -o clouds");
  EXPECT_GE(list("clouds").size(), 1U) << decoded.err;
}

TEST_F(LiveTool, AStuckReaderDoesNotHoldUpTheNetwork) {
  // Nobody reads from the pipe: writing stands still, receiving does not.
  const Outcome outcome = shell(
      "mkfifo pipe; sleep 600 <pipe & P=$!; \"$SWEEPCAST\" receive --listen 0 --keys k -o - --json "
      "2>note >pipe & R=$!; until grep -q listening note; do kill -0 $R || exit 9; done; "
      "PORT=$(sed -n 's/.*listening at .*:\\([0-9]*\\)$/\\1/p' note); "
      "head -c 60000 /dev/zero >pipe; for i in 1 2 3 4; do \"$SWEEPCAST\" send sweeps --to "
      "127.0.0.1:$PORT --key k --rate 50 "
      "--deadline 10000 --strategy fixed:0 --json; done; kill -KILL $R; kill $P");
  std::size_t whole = 0;
  for (std::size_t at = 0; (at = outcome.out.find("\"sent\": 3", at)) != std::string::npos; ++at) {
    ++whole;
  }
  EXPECT_EQ(whole, 4U) << outcome.out << outcome.err;
}

TEST_F(LiveTool, MistakesAreNamed) {
  expect_failure(run("keygen k --robot rover"), 1, {"k: ", "exists already"});
  expect_failure(run("keygen x --robot ../up"), 1, {"robot's name"});
  expect_failure(run("send sweeps --to 127.0.0.1 --key k"), 1, {"HOST:PORT"});
  expect_failure(run("send sweeps --to 127.0.0.1:9 --key none"), 1, {"none: no such key"});
  expect_failure(run("send sweeps --to 127.0.0.1:9 --key k --strategy best"), 2, {"--strategy"});
  expect_failure(run("send room.sweep --to 127.0.0.1:9 --key k --allow-override"), 1,
                 {"room.sweep", "--allow-override"});
  expect_failure(run("send sweeps sweeps --to 127.0.0.1:9 --key k"), 2, {"--sensor"});
  expect_failure(run("receive --listen 70000 --keys k -o x"), 2, {"--listen"});
  expect_failure(shell("chmod 644 k; \"$SWEEPCAST\" receive --listen 0 --keys k -o x"), 1,
                 {"chmod 600"});
  expect_failure(run("emulate-link --listen 0 --to 9 --trace none"), 1, {"none"});
}

}  // namespace
}  // namespace sweepcast::test
