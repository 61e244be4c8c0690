// What the tool's commands give on sound input.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::uint64_t sum_of_losses(const nlohmann::json& counts) {
  std::uint64_t sum = 0;
  for (const char* key :
       {"not_finite", "zero_range", "cropped", "out_of_view", "collided", "points_coded"}) {
    sum += counts.at(key).get<std::uint64_t>();
  }
  return sum;
}

/// Distances from each point of `from` to the nearest of `to`, one by one.
std::vector<double> nearest_distances(const std::vector<BinPoint>& from,
                                      const std::vector<BinPoint>& to) {
  std::vector<double> distances;
  for (const BinPoint& a : from) {
    double best = std::numeric_limits<double>::infinity();
    for (const BinPoint& b : to) {
      best =
          std::min(best, std::hypot(double{a[0]} - b[0], double{a[1]} - b[1], double{a[2]} - b[2]));
    }
    distances.push_back(best);
  }
  return distances;
}

TEST_F(ToolTest, EncodeCountsEveryPoint) {
  std::vector<BinPoint> room = make_room(0.0F);
  const std::size_t sound = room.size();
  room.push_back({kNan, 1, 1, 0});
  room.push_back({1, -kInfinity, 1, 0});
  room.push_back({0, 0, 0, 0});
  room.push_back({700, 0, 0, 0});
  write_bin("in/b.bin", room);
  write_bin("in/a.bin", make_room(1.0F));

  const Outcome outcome = run("encode in -o out.sweep --codec rcpcc --level 0 --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto report = outcome.json();
  ASSERT_EQ(report["frames"].size(), 2U);
  EXPECT_EQ(report["file_bytes"], size("out.sweep"));
  EXPECT_EQ(report["frames"][0]["name"], "a");
  EXPECT_EQ(report["frames"][0]["points_in"], sound);

  const auto& frame = report["frames"][1];
  EXPECT_EQ(frame["name"], "b");
  EXPECT_EQ(frame["points_in"], sound + 4);
  EXPECT_EQ(frame["counts"]["points_in"], sound + 4);
  EXPECT_EQ(frame["counts"]["points_coded"], frame["points_coded"]);
  EXPECT_EQ(frame["counts"]["not_finite"], 2);
  EXPECT_EQ(frame["counts"]["zero_range"], 1);
  EXPECT_EQ(frame["counts"]["out_of_view"], 1);
  EXPECT_EQ(sum_of_losses(frame["counts"]), sound + 4);
  EXPECT_GE(frame["encode_ms"].get<double>(), 0.0);
  const auto bytes = frame["bytes"].get<std::uint64_t>();
  EXPECT_LT(bytes, 16 * (sound + 4));
  EXPECT_LE(bytes + report["frames"][0]["bytes"].get<std::uint64_t>(), size("out.sweep"));
}

TEST_F(ToolTest, SummaryShowsWhatWasLost) {
  std::vector<BinPoint> room = make_room(0.0F);
  room.push_back({kNan, 1, 1, 0});
  write_bin("a.bin", room);
  const Outcome outcome = run("encode a.bin -o a.sweep --fields xyz");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("1 not finite"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("(16 B/point, geometry only)"), std::string::npos) << outcome.out;
}

TEST_F(ToolTest, CropLeavesPointsOutAndCountsThem) {
  write_bin("a.bin", {{1, 0, 0, 0}, {5, 0, 0, 0}, {0, 9, 0, 0}, {0, -5, 1, 0}});
  const auto cropped = [&](const std::string& option) {
    const Outcome outcome = run("encode a.bin -o a.sweep --json " + option);
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
    return outcome.json()["frames"][0]["counts"].value("cropped", -1);
  };
  EXPECT_EQ(cropped(""), 0);
  EXPECT_EQ(cropped("--crop-range 2,8"), 2);
  EXPECT_EQ(cropped("--crop-range 2,0"), 1);
  EXPECT_EQ(cropped("--crop-box -2,-10,-1,2,10,0.5"), 2);
  EXPECT_EQ(cropped("--crop-robot -2,-2,-1,2,2,1"), 1);
}

TEST_F(ToolTest, SameInputGivesSameBytes) {
  make_recording(2);
  ASSERT_EQ(run("encode sweeps -o again.sweep").exit_status, 0);
  EXPECT_EQ(read("room.sweep"), read("again.sweep"));
}

TEST_F(ToolTest, DecodeGivesEverySweepBack) {
  make_recording(3);
  const Outcome outcome = run("decode room.sweep -o back/here --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(list("back/here"),
            (std::vector<std::string>{"000000.bin", "000001.bin", "000002.bin"}));
  const auto frames = outcome.json()["frames"];
  ASSERT_EQ(frames.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto decoded = read_bin("back/here/00000" + std::to_string(i) + ".bin");
    EXPECT_EQ(frames[i]["points"], decoded.size());
    ASSERT_FALSE(decoded.empty());
    for (const double d : nearest_distances(decoded, make_room(0.1F * static_cast<float>(i)))) {
      ASSERT_LE(d, 0.05);  // the bound where nothing else is said
    }
    for (const BinPoint& point : decoded) ASSERT_EQ(point[3], 0.25F);
  }
}

TEST_F(ToolTest, DecodeWritesEachFormat) {
  make_recording(1);
  ASSERT_EQ(run("decode room.sweep -o bin").exit_status, 0);
  for (const std::string options :
       {"pcd", "pcd --ascii", "pcd --compressed", "ply", "ply --ascii"}) {
    ASSERT_EQ(run("decode room.sweep -o other --format " + options).exit_status, 0) << options;
    const std::string file = "other/000000." + options.substr(0, 3);
    const Outcome compared = run("compare --json bin/000000.bin " + file);
    ASSERT_EQ(compared.exit_status, 0) << compared.err;
    EXPECT_EQ(compared.json()["points_decoded"], read_bin("bin/000000.bin").size()) << options;
    EXPECT_LT(compared.json()["max_o2d"].get<double>(), 1e-5) << options;
  }
}

TEST_F(ToolTest, InfoTellsWhatIsInTheFile) {
  write_bin("in/a.bin", make_room(0.0F));
  write_bin("in/b.bin", make_room(0.5F));
  const auto encoded = run("encode in -o x.sweep --sensor roof --rate 20 --json").json();
  const Outcome outcome = run("info x.sweep --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const auto report = outcome.json();
  EXPECT_EQ(report["file_bytes"], size("x.sweep"));
  EXPECT_EQ(report["index_rebuilt"], false);
  ASSERT_EQ(report["frames"].size(), 2U);
  for (int i = 0; i < 2; ++i) {
    const auto& frame = report["frames"][i];
    EXPECT_EQ(frame["sequence"], i);
    EXPECT_EQ(frame["stamp_ns"], i * 50'000'000);
    EXPECT_EQ(frame["sensor"], "roof");
    EXPECT_EQ(frame["codec"], "beam");
    EXPECT_EQ(frame["name"], encoded["frames"][i]["name"]);
    EXPECT_EQ(frame["counts"], encoded["frames"][i]["counts"]);
    EXPECT_EQ(frame["bytes"], encoded["frames"][i]["bytes"]);
    std::uint64_t parts = 0;
    for (const auto& [part, bytes] : frame["parts"].items()) parts += bytes.get<std::uint64_t>();
    EXPECT_EQ(parts, frame["bytes"]);
    EXPECT_FALSE(frame["parts"].contains("unknown"));
  }
  const Outcome text = run("info x.sweep --frames");
  EXPECT_EQ(text.exit_status, 0);
  EXPECT_NE(text.out.find("sensor roof"), std::string::npos) << text.out;
}

TEST_F(ToolTest, AppendGoesOnWithARecording) {
  write_bin("a.bin", make_room(0.0F));
  write_bin("b.bin", make_room(0.5F));
  ASSERT_EQ(run("encode a.bin -o x.sweep --append").exit_status, 0);
  const Outcome second = run("encode b.bin -o x.sweep --append --json");
  ASSERT_EQ(second.exit_status, 0) << second.err;
  EXPECT_EQ(second.json()["frames"].size(), 1U);
  EXPECT_EQ(second.json()["file_bytes"], size("x.sweep"));
  const auto frames = run("info x.sweep --json").json()["frames"];
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0]["name"], "a");
  EXPECT_EQ(frames[1]["name"], "b");
  EXPECT_EQ(frames[1]["sequence"], 1);
  EXPECT_EQ(frames[1]["stamp_ns"], 100'000'000);
}

TEST_F(ToolTest, EqualNamesAreToldApart) {
  write_bin("a.bin", make_room(0.0F));
  ASSERT_EQ(run("encode a.bin -o x.sweep --append").exit_status, 0);
  ASSERT_EQ(run("encode a.bin -o x.sweep --append").exit_status, 0);
  ASSERT_EQ(run("decode x.sweep -o back").exit_status, 0);
  EXPECT_EQ(list("back"), (std::vector<std::string>{"a-2.bin", "a.bin"}));
  EXPECT_EQ(read("back/a.bin"), read("back/a-2.bin"));
}

TEST_F(ToolTest, VerifyMeasuresEveryOriginalPoint) {
  make_recording(2);
  ASSERT_EQ(run("decode room.sweep -o back").exit_status, 0);
  const Outcome outcome = run("verify room.sweep --original sweeps --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const auto report = outcome.json();
  EXPECT_EQ(report["ok"], true);
  double largest = 0.0;
  for (int i = 0; i < 2; ++i) {
    const std::string file = "00000" + std::to_string(i) + ".bin";
    const auto distances = nearest_distances(read_bin("sweeps/" + file), read_bin("back/" + file));
    const double max = *std::max_element(distances.begin(), distances.end());
    const double mean = std::accumulate(distances.begin(), distances.end(), 0.0) /
                        static_cast<double>(distances.size());
    EXPECT_NEAR(report["frames"][i]["max_error"].get<double>(), max, 1e-6);
    EXPECT_NEAR(report["frames"][i]["mean_error"].get<double>(), mean, 1e-6);
    EXPECT_EQ(sum_of_losses(report["frames"][i]["counts"]), distances.size());
    largest = std::max(largest, max);
  }
  EXPECT_NEAR(report["max_error"].get<double>(), largest, 1e-6);
}

TEST_F(ToolTest, VerifyTellsTheWorstAttributeDifference) {
  auto room = make_room(0.0F);
  for (std::size_t i = 0; i < room.size(); ++i) room[i][3] = static_cast<float>(i % 50);
  write_bin("sweeps/000000.bin", room);
  const std::string encode = "encode sweeps --codec beam --max-error 0.01 --keep-order -o ";
  ASSERT_EQ(run(encode + "room.sweep").exit_status, 0);
  ASSERT_EQ(run(encode + "rounded.sweep --intensity-step 4").exit_status, 0);
  const auto worst = [&](const std::string& file) {
    const Outcome outcome = run("verify " + file + " --original sweeps --json");
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
    const auto report = outcome.json();
    EXPECT_EQ(report["worst_attributes"], report["frames"][0]["worst_attributes"]);
    return report["worst_attributes"];
  };
  EXPECT_EQ(worst("room.sweep"), nlohmann::json({{"intensity", 0.0}}));
  EXPECT_EQ(worst("rounded.sweep"), nlohmann::json({{"intensity", 2.0}}));
}

TEST_F(ToolTest, VerifyFindsWhatDoesNotFit) {
  make_recording(2);
  std::filesystem::remove(path("sweeps/000001.bin"));
  expect_failure(run("verify room.sweep --original sweeps"), 1, {"room.sweep", "000001"});

  auto changed = make_room(0.1F);
  changed.pop_back();
  write_bin("sweeps/000001.bin", changed);
  const Outcome outcome = run("verify room.sweep --original sweeps --json");
  expect_failure(outcome, 1, {"frame 1 (000001)", std::to_string(changed.size())});
  EXPECT_EQ(outcome.json()["ok"], false);
  EXPECT_EQ(outcome.json()["frames"].size(), 1U);
}

TEST_F(ToolTest, CompareWithItselfIsPerfect) {
  write_bin("a.bin", make_room(0.0F));
  const Outcome outcome = run("compare a.bin a.bin --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const auto report = outcome.json();
  EXPECT_EQ(report["points_original"], make_room(0.0F).size());
  EXPECT_EQ(report["max_o2d"], 0.0);
  for (const char* distance : {"0.02", "0.05", "0.10", "0.20"}) {
    EXPECT_EQ(report["f_score"][distance], 100.0);
  }
}

}  // namespace
}  // namespace sweepcast::test
