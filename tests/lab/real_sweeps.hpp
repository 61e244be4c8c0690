// Real sweeps for tests of measuring, read without the library's own readers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <vector>

#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

/// The KITTI .bin sweeps of a folder below SWEEPCAST_DATA, by name; none where it is not set.
inline std::vector<std::filesystem::path> real_sweeps(const char* folder) {
  const char* data = std::getenv("SWEEPCAST_DATA");
  std::vector<std::filesystem::path> paths;
  if (data == nullptr || !std::filesystem::is_directory(std::filesystem::path(data) / folder)) {
    return paths;
  }
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(data) / folder)) {
    if (entry.path().extension() == ".bin") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// The first sweep of each of these folders, as `real_sweeps` gives them.
inline std::vector<std::filesystem::path> first_sweeps(std::initializer_list<const char*> folders) {
  std::vector<std::filesystem::path> paths;
  for (const char* folder : folders) {
    const auto sweeps = real_sweeps(folder);
    if (!sweeps.empty()) paths.push_back(sweeps.front());
  }
  return paths;
}

/// The sweeps of these names in the folder "nebula"; those that are there.
inline std::vector<std::filesystem::path> nebula_sweeps(std::initializer_list<const char*> names) {
  const char* data = std::getenv("SWEEPCAST_DATA");
  std::vector<std::filesystem::path> paths;
  if (data == nullptr) return paths;
  for (const char* name : names) {
    const auto path = std::filesystem::path(data) / "nebula" / name;
    if (std::filesystem::exists(path)) paths.push_back(path);
  }
  return paths;
}

inline PointCloud read_kitti(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  PointCloud cloud;
  std::array<float, 4> point{};
  while (file.read(reinterpret_cast<char*>(point.data()), sizeof(point))) {
    cloud.x.push_back(point[0]);
    cloud.y.push_back(point[1]);
    cloud.z.push_back(point[2]);
    cloud.intensity.push_back(point[3]);
  }
  return cloud;
}

}  // namespace sweepcast::lab
