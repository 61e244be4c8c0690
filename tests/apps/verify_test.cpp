// `sweepcast verify` and `info` on what a link and a level leave of a recording.
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/tool_fixture.hpp"
#include "codec/frame_edit.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::test {
namespace {

class VerifyTest : public ToolTest {
 protected:
  /// Writes the frames of room.sweep, over and over, as `send --loop` gives them to a receiver:
  /// each with at most so many layers as its place in `layers` says.
  void receive(const std::vector<std::size_t>& layers) const {
    auto reader = SweepReader::open(path("room.sweep"));
    auto writer = SweepWriter::open(path("got.sweep"), SweepWriter::Mode::record);
    ASSERT_TRUE(reader && writer);
    std::vector<std::byte> frame, model, cut;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const std::size_t from = i % reader->entries().size();
      ASSERT_TRUE(reader->read(from, frame));
      FrameHeader header;
      ASSERT_TRUE(parse_frame_header(frame, header));
      const auto part = model_part(frame, header);
      ASSERT_TRUE(part);
      if (!part->empty()) model.assign(part->begin(), part->end());
      const auto ends = layer_ends(header);
      frame.resize(ends[std::min(layers[i], ends.size()) - 1]);
      ASSERT_TRUE(rewrite_frame(frame, ModelPart::put, model, cut));
      ASSERT_TRUE(writer->append(cut, reader->entries()[from].name));
    }
    ASSERT_TRUE(writer->close());
  }
};

TEST_F(VerifyTest, ComparesWhatCameAndTellsWhatIsMissing) {
  make_recording(2);
  receive({9, 2, 1});
  const Outcome outcome = run("verify got.sweep --original sweeps --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const auto report = outcome.json();
  const auto& frames = report["frames"];
  ASSERT_EQ(frames.size(), 3U);
  const int made = frames[0]["layers"].get<int>();
  ASSERT_GT(made, 2);
  EXPECT_EQ(frames[0]["layers_missing"], 0);
  EXPECT_EQ(frames[1]["layers"], 2);
  EXPECT_EQ(frames[1]["layers_missing"], made - 2);
  EXPECT_EQ(frames[2]["layers_missing"], made - 1);
  EXPECT_EQ(report["frames_cut"], 2);
  EXPECT_EQ(report["layers_missing"], 2 * made - 3);
  EXPECT_EQ(frames[0]["points_decoded"], frames[0]["counts"]["points_coded"]);
  EXPECT_LT(frames[2]["points_decoded"], frames[1]["points_decoded"]);
  EXPECT_LE(frames[0]["max_error"].get<double>(), 0.05);
  EXPECT_GT(frames[2]["max_error"].get<double>(), 0.05);

  ASSERT_EQ(run("decode got.sweep -o back").exit_status, 0);
  EXPECT_EQ(frames[1]["points_decoded"], read_bin("back/000001.bin").size());
  const Outcome compared = run("compare sweeps/000001.bin back/000001.bin --json");
  EXPECT_EQ(frames[1]["max_error"], compared.json()["max_o2d"]);

  const Outcome text = run("verify got.sweep --original sweeps");
  EXPECT_NE(text.out.find("2 of 3 frames lack layers"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find(" in layers that are missing"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("--fill"), std::string::npos) << text.out;
}

TEST_F(VerifyTest, LoopedNamesAreThoseOfTheirOriginals) {
  make_recording(2);
  receive({9, 9, 9, 9});
  const Outcome outcome = run("verify got.sweep --original sweeps --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const auto frames = outcome.json()["frames"];
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[3]["name"], "000001-2");
  EXPECT_EQ(frames[3]["max_error"], frames[1]["max_error"]);

  // Decoded, such names are the files', and encoded again the frames'.
  ASSERT_EQ(run("decode got.sweep -o back").exit_status, 0);
  ASSERT_EQ(run("encode back -o again.sweep").exit_status, 0);
  EXPECT_EQ(run("verify again.sweep --original back").exit_status, 0);
  EXPECT_EQ(run("verify again.sweep --original sweeps").exit_status, 0);
}

TEST_F(VerifyTest, ANameThatOnlyLooksLoopedIsItsOwn) {
  write_bin("in/a.bin", make_room(0.0F));
  write_bin("in/a-2.bin", make_room(3.0F));
  ASSERT_EQ(run("encode in -o x.sweep").exit_status, 0);
  const Outcome outcome = run("verify x.sweep --original in --json");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_LE(outcome.json()["max_error"].get<double>(), 0.05);
}

TEST_F(VerifyTest, InfoTellsMissingLayers) {
  make_recording(1);
  receive({9, 1});
  const auto report = run("info got.sweep --json").json();
  const int made = report["frames"][0]["layers"].get<int>();
  EXPECT_EQ(report["frames"][0]["layers_missing"], 0);
  EXPECT_EQ(report["frames"][1]["layers"], 1);
  EXPECT_EQ(report["frames"][1]["layers_missing"], made - 1);
  EXPECT_EQ(report["frames_cut"], 1);
  EXPECT_EQ(report["layers_missing"], made - 1);
  const Outcome text = run("info got.sweep --frames");
  EXPECT_NE(text.out.find("1 of 2 frames lack layers"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find(" 1/" + std::to_string(made) + " "), std::string::npos) << text.out;
  EXPECT_EQ(run("info room.sweep").out.find("lack layers"), std::string::npos);
}

TEST_F(VerifyTest, FillMeasuresWithWhatWasLeftOut) {
  write_bin("sweeps/000000.bin", make_room(0.0F));
  ASSERT_EQ(run("encode sweeps -o room.sweep --level 5").exit_status, 0);
  const Outcome bare = run("verify room.sweep --original sweeps --json");
  const Outcome filled = run("verify room.sweep --original sweeps --fill --json");
  ASSERT_EQ(filled.exit_status, 0) << filled.err;
  ASSERT_GT(filled.json()["points_filled"], 0);
  EXPECT_EQ(bare.json()["points_filled"], 0);
  EXPECT_EQ(filled.json()["points_decoded"], bare.json()["points_decoded"]);
  EXPECT_LT(filled.json()["mean_error"], bare.json()["mean_error"]);
  const std::string hint = "points that were left out count too";
  EXPECT_NE(run("verify room.sweep --original sweeps").out.find(hint), std::string::npos);
  const Outcome text = run("verify room.sweep --original sweeps --fill");
  EXPECT_NE(text.out.find("points interpolated in place"), std::string::npos) << text.out;
  make_recording(1);
  EXPECT_EQ(run("verify room.sweep --original sweeps").out.find(hint), std::string::npos);
}

TEST_F(VerifyTest, NoFrameIsAFailure) {
  make_recording(1);
  receive({});
  const Outcome outcome = run("verify got.sweep --original sweeps --json");
  expect_failure(outcome, 1, {"got.sweep: holds no frame"});
  EXPECT_EQ(outcome.json()["ok"], false);
  EXPECT_EQ(outcome.json()["problems"].size(), 1U);
  EXPECT_EQ(run("info got.sweep").exit_status, 0);
}

TEST_F(VerifyTest, LayersAndFillMeanNothingToRcpcc) {
  make_recording(1);
  ASSERT_EQ(run("encode sweeps -o r.sweep --codec rcpcc").exit_status, 0);
  for (const std::string option : {"--fill", "--layers 2"}) {
    expect_failure(run("decode r.sweep -o back " + option), 1, {"r.sweep", "rcpcc", "leave"});
    EXPECT_FALSE(exists("back"));
    EXPECT_EQ(run("decode room.sweep -o back " + option).exit_status, 0);
    std::filesystem::remove_all(path("back"));
  }
  expect_failure(run("verify r.sweep --original sweeps --fill"), 1, {"r.sweep", "rcpcc", "leave"});
}

}  // namespace
}  // namespace sweepcast::test
