// What the tool does when something is wrong: it says what and where, and nothing is lost.
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/tool_fixture.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::test {
namespace {

/// Where frame `i` of a .sweep file begins, and its bytes.
std::pair<std::size_t, std::size_t> place_of(const nlohmann::json& info, std::size_t i) {
  const auto& frame = info["frames"][i];
  return {frame["offset"].get<std::size_t>(), frame["bytes"].get<std::size_t>()};
}

TEST_F(ToolTest, BareCommandsPrintTheirHelp) {
  for (const std::string command : {"", "encode", "decode", "info", "verify", "compare"}) {
    const Outcome outcome = run(command);
    expect_failure(outcome, 2, {"Usage: sweepcast " + command, "Example: sweepcast"});
    EXPECT_EQ(outcome.out, "");
  }
}

TEST_F(ToolTest, HelpHasAnExample) {
  for (const std::string command : {"encode", "decode", "info", "verify", "compare"}) {
    const Outcome outcome = run(command + " --help");
    EXPECT_EQ(outcome.exit_status, 0);
    EXPECT_NE(outcome.out.find("Example: sweepcast " + command), std::string::npos) << outcome.out;
  }
  const Outcome all = run("--help");
  for (const char* command : {"encode", "decode", "simulate", "bench", "ablate"}) {
    EXPECT_NE(all.out.find("\n  " + std::string(command) + " "), std::string::npos) << command;
  }
}

TEST_F(ToolTest, VersionListsTheParts) {
  const Outcome outcome = run("--version");
  EXPECT_EQ(outcome.exit_status, 0);
  EXPECT_EQ(outcome.out.rfind("sweepcast " SWEEPCAST_VERSION "\n", 0), 0U) << outcome.out;
  for (const char* word : {"embree", "draco", "zstd: 1."}) {
    EXPECT_NE(outcome.out.find(word), std::string::npos) << outcome.out;
  }
}

TEST_F(ToolTest, WrongCommandLinesAreRefused) {
  write_bin("a.bin", make_room(0.0F));
  for (const std::string options : {"--bogus",
                                    "-o",
                                    "--level 6",
                                    "--level x",
                                    "--params 1,1,1",
                                    "--params 1,1,1,1,1",
                                    "--params 1,,1,1",
                                    "--params nan,1,1,1",
                                    "--params 0,1,1,1",
                                    "--params 99,1,1,1",
                                    "--level 1 --params 1,1,1,1",
                                    "--block 5",
                                    "--region 7",
                                    "--zstd 23",
                                    "--codec mp3",
                                    "--crop-box 1,1,1,0,0,0",
                                    "--crop-range 5",
                                    "--fov-elevation 10,-10",
                                    "--rate 0",
                                    "--rate nan",
                                    "--codec rcpcc --max-error 0.05",
                                    "--max-error 0.05 --max-range 20",
                                    "--level 1 --max-error 0.05",
                                    "--level 1 --target-bytes 5000",
                                    "--target-bytes 0",
                                    "--effort slow",
                                    "--fields rgb",
                                    "--lossless --max-error 0.02",
                                    "--lossless --intensity-step 1",
                                    "--lossless --level 1",
                                    "--lossless --target-bytes 900",
                                    "--fields xyz --intensity-step 1",
                                    "--crop-range 8,2",
                                    "--crop-range -1,2",
                                    "--max-error 0",
                                    "--max-error nan"}) {
    expect_failure(run("encode a.bin -o x.sweep " + options), 2, {"see `sweepcast encode --help`"});
  }
  expect_failure(run("decode x.sweep -o back --format obj"), 2, {"obj"});
  expect_failure(run("decode x.sweep -o back --format bin --ascii"), 2, {"--ascii"});
  expect_failure(run("frobnicate"), 2, {"frobnicate", "sweepcast --help"});
  EXPECT_EQ(list("."), std::vector<std::string>{"a.bin"});
}

TEST_F(ToolTest, WrongCommandLinesOfTheLabAreRefused) {
  for (const std::string options :
       {"simulate -o drive --noise nan", "simulate -o drive --noise -1",
        "simulate -o drive --seed -1", "simulate -o drive --seed 18446744073709551616",
        "simulate -o drive --seed 1.5", "bench in --max-error nan", "bench in --max-error 0.05,0",
        "bench in --params nan,1,1,1", "bench in --codec mp3", "bench in --levels 0 --codec",
        "ablate in --threshold nan", "ablate in --params 0.5", "ablate in --params 0,1",
        "ablate in --max-error 0.1", "ablate in --codec beam --threshold 0.1",
        "bench in --levels 0:1", "simulate-link --sweeps in --strategy all,best"}) {
    const std::string command = options.substr(0, options.find(' '));
    expect_failure(run(options), 2, {"see `sweepcast " + command + " --help`"});
  }
  EXPECT_TRUE(list(".").empty());
}

TEST_F(ToolTest, EmptyWordsAreRefused) {
  write_bin("a.bin", make_room(0.0F));
  for (const std::string options :
       {"encode '' -o x.sweep", "encode a.bin '' -o x.sweep", "encode a.bin -o ''",
        "encode a.bin -o x.sweep --sensor ''", "decode '' -o back", "decode x.sweep -o ''",
        "info ''", "verify x.sweep --original ''", "compare '' a.bin", "calibrate a.bin -o ''",
        "simulate -o ''", "bench a.bin --csv ''", "ablate ''"}) {
    expect_failure(run(options), 2, {"is empty"});
  }
  EXPECT_EQ(list("."), std::vector<std::string>{"a.bin"});
}

TEST_F(ToolTest, ListsTakeCommasOrWordsButNoInputs) {
  write_bin("in/a.bin", make_room(0.0F));
  const auto settings = [&](const std::string& options) {
    const Outcome outcome = run("bench --json --runs 1 " + options);
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
    const auto report = outcome.json();
    std::string text;
    for (const auto& row : report.at("rows")) text += row["setting"].get<std::string>() + ";";
    return text;
  };
  for (const std::string options :
       {"in --levels 0,5 --codec rcpcc,beam --max-error 0.1,0.2",
        "--codec rcpcc beam --levels 0 5 --max-error 0.1 0.2 in",
        "--levels 0 5 in --codec rcpcc --codec beam --max-error 0.1 0.2"}) {
    EXPECT_EQ(settings(options), "L0;L5;E 0.1 m;E 0.2 m;L0;L5;") << options;
  }
  EXPECT_EQ(settings("--levels 5 ./in"), "L5;L5;");
  EXPECT_EQ(
      settings("--codec beam --levels 1 3 --target-bytes 900 --effort fast,default --fill in"),
      "L1 fast;L1;L3 fast;L3 fast fill;L3;L3 fill;"
      "900 bytes fast;900 bytes fast fill;900 bytes;900 bytes fill;");
}

TEST_F(ToolTest, FailedBenchLeavesNoFile) {
  write_bin("in/a.bin", make_room(0.0F));
  write("in/b.bin", "seventeen bytes..");
  expect_failure(run("bench in --levels 5 --runs 1 --csv rows.csv"), 1, {"in/b.bin"});
  EXPECT_EQ(list("."), std::vector<std::string>{"in"});
}

TEST_F(ToolTest, FilesOfTheSameSweepAreNamed) {
  make_recording(2);
  ASSERT_EQ(run("decode room.sweep -o back").exit_status, 0);
  ASSERT_EQ(run("decode room.sweep -o back --format pcd").exit_status, 0);
  expect_failure(run("compare sweeps back"), 1,
                 {"back: holds 000000.bin and 000000.pcd", "the same sweep; remove one kind"});
}

TEST_F(ToolTest, MessagesSpeakOfTheOptionsAsTheyAreTyped) {
  write_bin("a.bin", make_room(0.0F));
  const auto refused = [&](const std::string& options, const std::vector<std::string>& words) {
    const Outcome outcome = run("encode a.bin -o x.sweep " + options);
    expect_failure(outcome, 2, words);
    EXPECT_EQ(outcome.err.find('_'), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find(".000000"), std::string::npos) << outcome.err;
  };
  refused("--max-error 0", {"--max-error: 0 is not a number from 0.001 to 2"});
  refused("--intensity-step -1", {"--intensity-step: -1 is not a number from 0 to 1000000"});
  refused("--lossless --target-bytes 900", {"--lossless: cannot go with --target-bytes"});
  refused("--level 1 --max-error 1", {"--level: cannot go with --max-error"});
  refused("--params 1,1,1,1 --level 2", {"--level: cannot go with --params"});
  refused("--crop-range 8,2", {"--crop-range: MIN"});
  refused("--level", {"--level: needs a value, 0..5"});
  refused("--level 7", {"--level: 7 is not a whole number from 0 to 5"});
  refused("--level 1 --level 2", {"--level: is given 2 times"});
  refused("--codec rcpcc --block 5", {"--block: 5 is not one of 4,8,16"});
  refused("--keep-order=maybe", {"--keep-order: maybe is not a value"});
  refused("--lvl 3", {"not expected: --lvl; check the spelling"});
  expect_failure(run("encode a.bin"), 2, {"--output is missing; add it"});
}

TEST_F(ToolTest, AnIntensityStepThatLeavesNothingIsRefused) {
  auto room = make_room(0.0F);  // intensities as KITTI has them
  for (std::size_t i = 0; i < room.size(); ++i) room[i][3] = 0.01F * static_cast<float>(i % 100);
  write_bin("in/a.bin", room);
  expect_failure(run("encode in -o x.sweep --intensity-step 2"), 1,
                 {"in/a.bin: --intensity-step 2", "0 to 0.99", "choose a smaller step"});
  EXPECT_EQ(list("."), std::vector<std::string>{"in"});
  EXPECT_EQ(run("encode in -o x.sweep --intensity-step 0.1").exit_status, 0);
}

TEST_F(ToolTest, FieldsThatAreNotKeptAreNamedOnce) {
  for (const std::string name : {"a", "b"}) {
    write("in/" + name + ".pcd",
          "VERSION 0.7\nFIELDS x y z rgb _ label\nSIZE 4 4 4 4 1 2\nTYPE F F F F U U\n"
          "COUNT 1 1 1 1 4 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n"
          "5 1 0 0 0 0 0 0 7\n6 1 0 0 0 0 0 0 7\n");
  }
  const Outcome outcome = run("encode in -o x.sweep --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["dropped_fields"], nlohmann::json({"rgb", "label"}));
  EXPECT_EQ(outcome.err.find("sweepcast: warning: "), 0U) << outcome.err;
  EXPECT_NE(outcome.err.find("rgb, label"), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

TEST_F(ToolTest, InputsThatAreNotThereOrNotClouds) {
  std::filesystem::create_directory(path("empty"));
  write("nothing.bin", "");
  write_bin("mixed/a.bin", make_room(0.0F));
  write("mixed/b.ply", "ply\n");
  write("text.txt", "hello");
  expect_failure(run("encode missing.bin -o x.sweep"), 1, {"missing.bin", ";"});
  expect_failure(run("encode empty -o x.sweep"), 1, {"empty", ";"});
  expect_failure(run("encode nothing.bin -o x.sweep"), 1, {"nothing.bin", ";"});
  expect_failure(run("encode mixed -o x.sweep"), 1, {"mixed", ";"});
  expect_failure(run("encode text.txt -o x.sweep"), 1, {"text.txt", ";"});
  EXPECT_EQ(list("."), (std::vector<std::string>{"empty", "mixed", "nothing.bin", "text.txt"}));
}

TEST_F(ToolTest, OutputsThatCannotBeWritten) {
  write_bin("a.bin", make_room(0.0F));
  expect_failure(run("encode a.bin -o a.bin/x.sweep"), 1, {"a.bin/x.sweep"});
  expect_failure(run("encode a.bin -o no/folder/x.sweep"), 1, {"no/folder/x.sweep"});
  expect_failure(run("encode a.bin -o a.bin"), 1, {"a.bin", ".sweep"});
  write("notes.txt", "not to be lost");
  expect_failure(run("encode a.bin -o notes.txt"), 1, {"notes.txt", "another name"});
  EXPECT_EQ(read("notes.txt"), "not to be lost");
  expect_failure(run("encode a.bin -o /dev/full"), 1, {"/dev/full", "space"});
  expect_failure(run("encode a.bin --append -o /dev/full"), 1, {"/dev/full", "space"});
  EXPECT_EQ(read_bin("a.bin").size(), make_room(0.0F).size());
  ASSERT_EQ(run("encode a.bin -o x.sweep").exit_status, 0);
  expect_failure(run("decode x.sweep -o a.bin"), 1, {"a.bin"});
  expect_failure(run("decode x.sweep -o a.bin/below"), 1, {"a.bin/below"});
}

TEST_F(ToolTest, FullDiskKeepsWhatIsThere) {
  make_recording(6);  // of about 1 kB a frame; the limit is 512 bytes
  const std::string before = read("room.sweep");
  ASSERT_GT(before.size(), 512U);
  expect_failure(shell("ulimit -f 1; \"$SWEEPCAST\" encode sweeps -o room.sweep --level 0"), 1,
                 {"room.sweep"});
  EXPECT_EQ(read("room.sweep"), before);
  EXPECT_EQ(list("."), (std::vector<std::string>{"room.sweep", "sweeps"}));
  expect_failure(shell("ulimit -f 1; \"$SWEEPCAST\" decode room.sweep -o back"), 1,
                 {"back/000000"});
  EXPECT_TRUE(list("back").empty());
}

TEST_F(ToolTest, StandardOutputThatTakesNothing) {
  make_recording(1);
  expect_failure(run("info room.sweep >/dev/full"), 1, {"standard output"});
  expect_failure(run("--help >/dev/full"), 1, {"standard output"});
  // The file must not take standard output's place.
  expect_failure(run("encode sweeps -o other.sweep >&-"), 1, {"standard output"});
  EXPECT_EQ(read("other.sweep"), read("room.sweep"));
}

TEST_F(ToolTest, FailedEncodeKeepsTheOldFile) {
  make_recording(2);
  const std::string before = read("room.sweep");
  write("sweeps/000001.bin", "seventeen bytes..");
  expect_failure(run("encode sweeps -o room.sweep"), 1, {"sweeps/000001.bin", ";"});
  EXPECT_EQ(read("room.sweep"), before);
  EXPECT_EQ(list("."), (std::vector<std::string>{"room.sweep", "sweeps"}));
}

TEST_F(ToolTest, FilesThatAreNotSweepFiles) {
  write_bin("a.bin", make_room(0.0F));
  write("nothing.sweep", "");
  for (const std::string file : {"a.bin", "nothing.sweep", "missing.sweep"}) {
    expect_failure(run("decode " + file + " -o back"), 1, {file, ";"});
    expect_failure(run("info " + file), 1, {file, ";"});
    expect_failure(run("verify " + file + " --original ."), 1, {file, ";"});
  }
  EXPECT_FALSE(exists("back"));
}

TEST_F(ToolTest, TruncatedFileGivesItsWholeFrames) {
  make_recording(3);
  const auto [offset, bytes] = place_of(run("info room.sweep --json").json(), 2);
  const std::string whole = read("room.sweep");

  write("cut.sweep", whole.substr(0, offset + bytes / 2));
  expect_failure(run("decode cut.sweep -o back"), 1, {"cut.sweep", "2 whole frames"});
  EXPECT_EQ(list("back"), (std::vector<std::string>{"000000.bin", "000001.bin"}));
  EXPECT_EQ(run("info cut.sweep --json").json()["index_rebuilt"], true);

  // A recording that ends behind a whole frame has lost nothing but its index.
  write("open.sweep", whole.substr(0, offset + bytes));
  EXPECT_EQ(run("decode open.sweep -o all").exit_status, 0);
  EXPECT_EQ(list("all").size(), 3U);
}

TEST_F(ToolTest, DamagedFrameIsNamedAndTheOthersDecode) {
  make_recording(3);
  const auto [offset, bytes] = place_of(run("info room.sweep --json").json(), 1);
  const std::string whole = read("room.sweep");
  ASSERT_EQ(run("decode room.sweep -o whole").exit_status, 0);
  for (const std::size_t at : {std::size_t{0}, std::size_t{9}, bytes / 2, bytes - 1}) {
    std::string damaged = whole;
    damaged[offset + at] = static_cast<char>(damaged[offset + at] ^ 0x10);
    write("bad.sweep", damaged);
    const Outcome outcome = run("decode bad.sweep -o back --json");
    expect_failure(outcome, 1, {"bad.sweep", "frame 1 (000001)", "1 of 3 frames"});
    EXPECT_EQ(outcome.json()["frames"].size(), 2U);
    EXPECT_EQ(outcome.json()["errors"].size(), 1U);
    EXPECT_EQ(list("back"), (std::vector<std::string>{"000000.bin", "000002.bin"}));
    for (const std::string file : {"000000.bin", "000002.bin"}) {
      EXPECT_EQ(read("back/" + file), read("whole/" + file));
    }
    expect_failure(run("verify bad.sweep --original sweeps"), 1, {"frame 1 (000001)"});
  }
}

TEST_F(ToolTest, NamesCannotLeadOutOfTheFolder) {
  auto encoder = Encoder::create({});
  ASSERT_TRUE(encoder);
  const std::array<float, 3> x{5, 6, 7}, y{1, 2, 3}, z{0, 0, 0};
  const auto frame = encoder->encode(CloudView::columns(x, y, z), {});
  ASSERT_TRUE(frame);
  auto writer = SweepWriter::open(path("evil.sweep"), SweepWriter::Mode::convert);
  ASSERT_TRUE(writer);
  for (const std::string name :
       {"../escaped", "..", "/tmp/escaped", "bell\a", "sub/file", "good"}) {
    ASSERT_TRUE(writer->append(*frame, name)) << name;
  }
  ASSERT_TRUE(writer->close());
  const Outcome outcome = run("decode evil.sweep -o back");
  expect_failure(outcome, 1, {"evil.sweep", "frame 0", "5 of 6 frames"});
  EXPECT_EQ((outcome.err + run("info evil.sweep --frames").out).find('\a'), std::string::npos);
  EXPECT_EQ(list("back"), std::vector<std::string>{"good.bin"});
  EXPECT_EQ(list("."), (std::vector<std::string>{"back", "evil.sweep"}));
}

TEST_F(ToolTest, EncodeRefusesNamesThatDecodeWouldRefuse) {
  write_bin("new\nline.bin", make_room(0.0F));
  const Outcome outcome = run("encode . -o ../x.sweep");
  expect_failure(outcome, 1, {"new?line.bin", "rename it"});
  EXPECT_EQ(list(".").size(), 1U);
}

TEST_F(ToolTest, LabCommandsArePassedThroughUntouched) {
  const std::string copy = "cp \"$SWEEPCAST\" here; PATH=/nowhere ./here ";
  expect_failure(shell(copy + "bench --help"), 1, {"bench", "sweepcast-lab", "install"});
  write("sweepcast-lab", "#!/bin/sh\nfor word; do echo \"[$word]\"; done; exit 7\n");
  std::filesystem::permissions(path("sweepcast-lab"), std::filesystem::perms::owner_all);
  const Outcome outcome = shell(copy + "bench --help 'two words' -- --version");
  EXPECT_EQ(outcome.exit_status, 7);
  EXPECT_EQ(outcome.out, "[bench]\n[--help]\n[two words]\n[--]\n[--version]\n");
}

}  // namespace
}  // namespace sweepcast::test
