// Sensor models in files, and the command that makes them.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/sensor_file.hpp"
#include "sensor/spinning_lidar.hpp"

namespace sweepcast::app {
namespace {

namespace fs = std::filesystem;

class SensorFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("sweepcast-sensor-" + std::to_string(std::random_device{}()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Result<SensorModel> load(const std::string& text) {
    std::ofstream(path()) << text;
    return load_sensor_model(path());
  }
  [[nodiscard]] fs::path path() const { return folder_ / "sensor.json"; }

  fs::path folder_;
};

TEST_F(SensorFile, GivesTheIntegersBack) {
  std::mt19937 random(1);
  SensorModel model = test::made_up_model();
  model.direction = -1;
  model.jitter = 7;
  model.mount = {{-3'001, 61'002, -187'003}, {-900'001, 150'002, 90'000'000}};
  for (Beam& beam : model.beams) {
    beam.height = test::uniform_int(random, -1'000'000, 1'000'000);
    beam.azimuth_offset = test::uniform_int(random, -360'000'000, 360'000'000);
    beam.time_offset = test::uniform_int(random, -360'000'000, 360'000'000);
    beam.tan_elevation += test::uniform_int(random, 0, 1000);
  }
  const auto back = load(sensor_json(model).dump(1));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*back, model);
}

TEST_F(SensorFile, SaysWhatIsWrong) {
  const auto message = [this](const std::string& text) {
    const auto model = load(text);
    EXPECT_FALSE(model) << text;
    return model ? std::string() : model.error().message;
  };
  EXPECT_NE(message("{").find("not a JSON object"), std::string::npos);
  EXPECT_NE(message("[]").find("not a JSON object"), std::string::npos);
  EXPECT_NE(message("{}").find("\"ticks_per_turn\""), std::string::npos);
  EXPECT_NE(message(R"({"ticks_per_turn": 1e300})").find("out of bounds"), std::string::npos);
  EXPECT_NE(message(R"({"ticks_per_turn": 100})").find("\"beams\""), std::string::npos);
  EXPECT_NE(message(R"({"ticks_per_turn": 100, "beams": []})").find("0 beams"), std::string::npos);
  EXPECT_NE(message(R"({"ticks_per_turn": 100, "beams": [5]})").find("sensor.json"),
            std::string::npos);
  const auto absent = load_sensor_model(folder_ / "absent.json");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace sweepcast::app
