// Files of boxes, ours and others'.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "lab/detect/boxes.hpp"
#include "lab/detect/labels.hpp"
#include "lab/random.hpp"
#include "lab/real_sweeps.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

constexpr double kQuarter = std::numbers::pi / 2;

class DetectBoxes : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("sweepcast_boxes_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  fs::path folder_;
};

TEST_F(DetectBoxes, ReadsWhatSimulateWrites) {
  const auto boxes = parse_boxes(
      "Car -43.5544 -2.7193 -1.1383 4.3401 1.6907 1.5856 -0.0004 53\r\n\n"
      "Pedestrian 1 2 3 0.5 0.56 1.7 3.1 4\n",
      "here");
  ASSERT_TRUE(boxes) << boxes.error().message;
  ASSERT_EQ(boxes->size(), 2U);
  EXPECT_EQ((*boxes)[0].label, "Car");
  EXPECT_DOUBLE_EQ((*boxes)[0].centre.y(), -2.7193);
  EXPECT_DOUBLE_EQ((*boxes)[0].length, 4.3401);
  EXPECT_DOUBLE_EQ((*boxes)[0].width, 1.6907);
  EXPECT_DOUBLE_EQ((*boxes)[0].height, 1.5856);
  EXPECT_DOUBLE_EQ((*boxes)[0].yaw, -0.0004);
  EXPECT_EQ((*boxes)[0].points, 53);
  EXPECT_EQ((*boxes)[0].score, 1.0);
  EXPECT_EQ((*boxes)[1].label, "Pedestrian");
}

TEST_F(DetectBoxes, WrittenOnesComeBack) {
  Box box;
  box.label = "Van";
  box.centre = {1.25, -2.5, 0.125};
  box.length = 5.0;
  box.width = 2.0;
  box.height = 2.25;
  box.yaw = -1.5;
  box.points = 17;
  box.score = 0.75;
  ASSERT_TRUE(write_boxes(folder_ / "a.txt", std::span(&box, 1)));
  const auto read = read_boxes(folder_ / "a.txt");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 1U);
  const Box& same = read->front();
  EXPECT_EQ(same.label, box.label);
  EXPECT_EQ(same.centre, box.centre);
  EXPECT_EQ(same.length, box.length);
  EXPECT_EQ(same.yaw, box.yaw);
  EXPECT_EQ(same.points, box.points);
  EXPECT_EQ(same.score, box.score);
}

TEST_F(DetectBoxes, RefusesWhatIsNoBox) {
  for (const char* text : {"Car 1 2 3 4 5 6 7", "Car 1 2 3 4 5 6 7 8 9 10", "Car 1 2 x 4 5 6 7 8",
                           "Car 1 2 3 0 5 6 7 8", "Car 1 2 3 4 -5 6 7 8", "Car nan 2 3 4 5 6 7 8",
                           "Car 1 2 inf 4 5 6 7 8", "Car 1e5 2 3 4 5 6 7 8",
                           "Car 1 2 3 4 5 6 7 8.5", "Car 1 2 3 4 5 6 7 8 nan"}) {
    const auto boxes = parse_boxes(text, "file.txt");
    ASSERT_FALSE(boxes) << text;
    EXPECT_EQ(boxes.error().code, ErrorCode::corrupt);
    EXPECT_NE(boxes.error().message.find("file.txt: line 1"), std::string::npos);
  }
  EXPECT_EQ(read_boxes(folder_ / "absent.txt").error().code, ErrorCode::not_found);
}

TEST_F(DetectBoxes, CountsThePointsInside) {
  Box box;
  box.centre = {10.0, 0.0, 0.0};
  box.length = 4.0;
  box.width = 2.0;
  box.height = 1.5;
  box.yaw = kQuarter;
  PointCloud cloud;
  cloud.x = {10.0F, 10.9F, 11.1F, 10.0F, 10.0F, 10.0F, std::nanf("")};
  cloud.y = {0.0F, 1.9F, 0.0F, 2.1F, 0.0F, 0.0F, 0.0F};
  cloud.z = {0.0F, 0.7F, 0.0F, 0.0F, 0.8F, -0.7F, 0.0F};  // the sixth is on the ground
  count_points(cloud, std::span(&box, 1));
  EXPECT_EQ(box.points, 2);
}

// A camera that looks along the LiDAR's x axis from 0.3 m in front of it.
const std::string kCalibration =
    "P0: 1 2 3\nP2: 700 0 600 0 0 700 180 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
    "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 -0.3\n";

TEST_F(DetectBoxes, KittiLabelsComeIntoTheLidarsFrame) {
  const auto calibration = parse_kitti_calibration(kCalibration, "calib");
  ASSERT_TRUE(calibration) << calibration.error().message;
  const auto labels = parse_kitti_labels(
      "Car 0.00 0 1.85 387.63 181.54 423.81 203.12 1.6 1.8 4.0 -5.0 1.7 20.0 -1.5707963\n"
      "DontCare -1 -1 -10 500 150 590 190 -1 -1 -1 -1000 -1000 -1000 -10\n",
      *calibration, "labels");
  ASSERT_TRUE(labels) << labels.error().message;
  ASSERT_EQ(labels->boxes.size(), 1U);
  const Box& car = labels->boxes[0];
  EXPECT_NEAR(car.centre.x(), 20.3, 1e-9);
  EXPECT_NEAR(car.centre.y(), 5.0, 1e-9);
  EXPECT_NEAR(car.centre.z(), -1.7 + 0.8, 1e-9);
  EXPECT_EQ(car.length, 4.0);
  EXPECT_EQ(car.width, 1.8);
  EXPECT_EQ(car.height, 1.6);
  EXPECT_NEAR(car.yaw, 0.0, 1e-6) << "turned by a quarter from the camera's x axis: straight ahead";
  EXPECT_EQ(car.points, -1);
  EXPECT_TRUE(labels->is_labelled(car.centre));
  EXPECT_FALSE(labels->is_labelled({-20.0, 0.0, -1.0})) << "behind";
  EXPECT_FALSE(labels->is_labelled({10.0, 20.0, -1.0})) << "beside the image";
  EXPECT_FALSE(labels->is_labelled({70.3, 5.0, 0.5})) << "at pixel (550, 175)";
}

TEST_F(DetectBoxes, PandasetCuboidsComeIntoTheSensorsFrame) {
  RigidTransform pose = RigidTransform::Identity();  // 100 m east, looking along y
  pose.linear() = Eigen::AngleAxisd(kQuarter, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(100.0, 0.0, 2.0);
  const auto labels = parse_pandaset_cuboids(
      "uuid,label,yaw,stationary,position.x,position.y,position.z,dimensions.x,dimensions.y,"
      "dimensions.z\nab,Pickup Truck,0.5,True,98.0,10.0,1.5,1.9,4.7,1.7\n",
      pose, "table");
  ASSERT_TRUE(labels) << labels.error().message;
  ASSERT_EQ(labels->boxes.size(), 1U);
  const Box& truck = labels->boxes[0];
  EXPECT_EQ(truck.label, "Pickup Truck");
  EXPECT_NEAR((truck.centre - Eigen::Vector3d(10.0, 2.0, -0.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(truck.yaw, 0.5, 1e-12) << "its length lies along y at yaw 0, as the sensor looks";
  EXPECT_EQ(truck.length, 4.7);
  EXPECT_EQ(truck.width, 1.9);
}

TEST_F(DetectBoxes, FoldersTellTheirFormat) {
  write("own/000001.txt", "Car 1 2 3 4 5 6 7 8\n");
  write("kitti/label_2/000001.txt", "Car 0 0 0 0 0 9 9 1.6 1.8 4.0 -5.0 1.7 20.0 -1.57\n");
  write("kitti/calib/000001.txt", kCalibration);
  const std::string head =
      "label,yaw,position.x,position.y,position.z,dimensions.x,dimensions.y,dimensions.z\n";
  write("panda/30.csv", head);
  write("panda/31.csv", head + "Car,0,10,0,0,2,4,1\n");
  write("panda/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 3 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(read_labels(folder_ / "own", "000001")->boxes.at(0).points, 8);
  for (const char* folder : {"kitti/label_2", "kitti/label_2/"}) {
    const auto kitti = read_labels(folder_ / folder, "000001");
    ASSERT_TRUE(kitti) << kitti.error().message;
    EXPECT_NEAR(kitti->boxes.at(0).centre.x(), 20.3, 1e-9);
  }
  EXPECT_DOUBLE_EQ(read_labels(folder_ / "panda", "31")->boxes.at(0).centre.x(), 7.0);
  EXPECT_EQ(read_labels(folder_ / "own", "000002").error().code, ErrorCode::not_found);
  write("panda/32.csv", head);
  EXPECT_EQ(read_labels(folder_ / "panda", "32").error().code, ErrorCode::corrupt);
}

TEST_F(DetectBoxes, DamagedLabelsAreErrors) {
  const auto calibration = parse_kitti_calibration(kCalibration, "calib");
  ASSERT_TRUE(calibration);
  const std::string kitti =
      "Car 0.00 0 1.85 387.63 181.54 423.81 203.12 1.6 1.8 4.0 -5.0 1.7 20.0 -1.57\n";
  const std::string table =
      "label,yaw,position.x,position.y,position.z,dimensions.x,dimensions.y,dimensions.z\n"
      "Car,0,10,0,0,2,4,1\n";
  EXPECT_FALSE(parse_kitti_calibration("P2: 1 2 3\n", "c"));
  EXPECT_FALSE(parse_kitti_labels("Car 1 2 3\n", *calibration, "l"));
  EXPECT_FALSE(parse_pandaset_cuboids("", RigidTransform::Identity(), "t"));
  EXPECT_FALSE(parse_pandaset_cuboids(table + "Car,0,10\n", RigidTransform::Identity(), "t"));
  // Whatever bytes change, there are boxes of some size or an error.
  Random random(7);
  int errors = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string one = kitti, two = table, three = kCalibration;
    for (std::string* text : {&one, &two, &three}) {
      for (int k = 0; k < 2; ++k) {
        (*text)[static_cast<std::size_t>(random.below(static_cast<int>(text->size())))] =
            static_cast<char>(random.below(256));
      }
    }
    const auto a = parse_kitti_labels(one, *calibration, "l");
    const auto b = parse_pandaset_cuboids(two, RigidTransform::Identity(), "t");
    const auto c = parse_kitti_calibration(three, "c");
    errors += !a + !b + !c;
    for (const auto* labels : {&a, &b}) {
      if (!*labels) continue;
      for (const Box& box : (*labels)->boxes) {
        EXPECT_GT(box.length, 0.0);
        EXPECT_TRUE(box.centre.allFinite());
      }
    }
  }
  EXPECT_GT(errors, 1000);
}

TEST_F(DetectBoxes, RealCarsHavePointsOnThem) {
  const auto sweeps = real_sweeps("kitti_object/velodyne");
  if (sweeps.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to the folder of real sweeps";
  int people = 0, cars = 0;
  for (const auto& sweep : sweeps) {
    auto labels = read_labels(sweep.parent_path().parent_path() / "label_2", sweep.stem().string());
    ASSERT_TRUE(labels) << labels.error().message;
    count_points(read_kitti(sweep), labels->boxes);
    for (const Box& box : labels->boxes) {
      people += box.label == "Pedestrian" && box.points > 200 ? 1 : 0;
      cars += box.label == "Car" && box.points > 5 ? 1 : 0;
      EXPECT_TRUE(labels->is_labelled(box.centre));
    }
  }
  EXPECT_EQ(people, 1);
  EXPECT_EQ(cars, 2);
}

TEST_F(DetectBoxes, RealCuboidsHavePointsOnThem) {
  const auto sweeps = real_sweeps("pandaset_pandar64");
  if (sweeps.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to the folder of real sweeps";
  auto labels = read_labels(sweeps.back().parent_path(), sweeps.back().stem().string());
  ASSERT_TRUE(labels) << labels.error().message;
  count_points(read_kitti(sweeps.back()), labels->boxes);
  int near = 0, covered = 0;
  for (const Box& box : labels->boxes) {
    if (box.label != "Car" || box.centre.head<2>().norm() > 20.0) continue;
    ++near;
    covered += box.points > 50 ? 1 : 0;
  }
  EXPECT_GT(near, 5);
  EXPECT_GT(covered, near / 2);
}

}  // namespace
}  // namespace sweepcast::lab
