#include "lab/simulate/export.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <charconv>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/trig.hpp"
#include "io/file.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

// Fixed notation with the locale out of it, and no minus before a zero.
void append(std::string& text, double value, int digits) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::fixed, digits);
  const std::string_view number(buffer.data(), static_cast<std::size_t>(end.ptr - buffer.data()));
  const bool zero = number.find_first_not_of("-0.") == std::string_view::npos;
  text += zero && number.front() == '-' ? number.substr(1) : number;
}

std::string pose_line(const Pose& pose) {
  constexpr int kDigits = 9;
  const std::array<std::array<double, 4>, 3> rows{{
      {pose.x.x, pose.y.x, pose.z.x, pose.origin.x},
      {pose.x.y, pose.y.y, pose.z.y, pose.origin.y},
      {pose.x.z, pose.y.z, pose.z.z, pose.origin.z},
  }};
  std::string line;
  for (const auto& row : rows) {
    for (double value : row) {
      if (!line.empty()) line += ' ';
      append(line, value, kDigits);
    }
  }
  return line + '\n';
}

std::string box_lines(const std::vector<SimulatedBox>& boxes) {
  std::string text;
  for (const SimulatedBox& box : boxes) {
    text += box.kind;
    for (double value :
         {box.middle.x, box.middle.y, box.middle.z, box.length, box.width, box.height, box.yaw}) {
      text += ' ';
      append(text, value, 4);
    }
    text += ' ' + std::to_string(box.points) + '\n';
  }
  return text;
}

std::string sensor_json(const Sensor& sensor) {
  using nlohmann::ordered_json;
  ordered_json beams = ordered_json::array();
  for (const Beam& beam : sensor.beams) {
    beams.push_back({{"tan_elevation", beam.tan_elevation},
                     {"elevation_deg", arc_tangent(beam.tan_elevation, 1.0) / kDegree},
                     {"height_m", beam.height_m},
                     {"azimuth_offset_deg", beam.azimuth_offset_deg},
                     {"lateral_offset_m", beam.lateral_m},
                     {"lag_ticks", beam.lag_ticks},
                     {"delay_ns", beam.delay_ns}});
  }
  const double firings =
      1e8 * static_cast<double>(sensor.period_den) / static_cast<double>(sensor.period_num);
  const ordered_json json{{"name", sensor.name},
                          {"ticks_per_turn", sensor.ticks_per_turn},
                          {"firings_per_turn", firings},
                          {"turns_per_second", 10},
                          {"direction", "clockwise"},
                          {"range_sigma_m", sensor.range_sigma_m},
                          {"range_step_m", sensor.range_step_m},
                          {"max_range_m", sensor.max_range_m},
                          {"mount_height_m", sensor.mount_height_m},
                          {"beams", beams}};
  return json.dump(1) + '\n';
}

// The triangles within the sensor's reach of the driven way, in the first sweep's sensor frame.
Mesh seen_world(const Drive& drive) {
  const double reach = drive.sensor().max_range_m + 5.0;
  std::vector<Vec3> stations;
  for (int i = 0; i < drive.options().sweeps + 5; i += 5) {
    stations.push_back(drive.sweep_pose(std::min(i, drive.options().sweeps - 1)).origin);
    if (static_cast<double>(i) > drive.loop_length() + 5.0) break;  // a metre a sweep: all round
  }
  const Pose first = drive.sweep_pose(0);
  const Mesh& world = drive.world();
  Mesh seen;
  std::vector<std::uint32_t> renumbered(world.vertices.size(), ~0U);
  for (std::size_t i = 0; i < world.triangles.size(); ++i) {
    auto corners = world.triangles[i];
    const Vec3 p = world.vertex(corners[0]);
    const bool near = std::any_of(stations.begin(), stations.end(), [&](Vec3 station) {
      const Vec3 d = p - station;
      return dot(d, d) < reach * reach;
    });
    if (!near) continue;
    for (std::uint32_t& corner : corners) {
      std::uint32_t& number = renumbered[corner];
      if (number == ~0U) {
        number = MeshBuilder{seen}.vertex(first.invert(world.vertex(corner)));
      }
      corner = number;
    }
    seen.triangles.push_back(corners);
  }
  return seen;
}

template <class Number>
void append_bytes(std::string& text, Number value) {
  static_assert(std::endian::native == std::endian::little, "binary_little_endian as it lies");
  const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  text.append(bytes.data(), bytes.size());
}

std::string mesh_ply(const Mesh& mesh) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\ncomment metres, the first sweep's sensor frame\n"
      "element vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) +
      "\nproperty list uchar int vertex_indices\nend_header\n";
  text.reserve(text.size() + mesh.vertices.size() * 12 + mesh.triangles.size() * 13);
  for (const auto& vertex : mesh.vertices) append_bytes(text, vertex);
  for (const auto& triangle : mesh.triangles) {
    append_bytes(text, std::uint8_t{3});
    append_bytes(text, triangle);
  }
  return text;
}

Status write_text(const fs::path& path, const std::string& text) {
  return write_file(path, std::as_bytes(std::span(text)));
}

std::string number_name(int index) {
  std::string digits = std::to_string(index);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

// Makes and writes all sweeps, several at a time; the first error ends it.
class SweepWriter {
 public:
  SweepWriter(const Drive& drive, fs::path folder, const ExportOptions& options,
              const std::function<void()>& progress)
      : drive_(drive), folder_(std::move(folder)), options_(options), progress_(progress) {}

  Result<ExportSummary> run() {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const int count =
        std::min(options_.threads > 0 ? options_.threads : cores, drive_.options().sweeps);
    std::vector<std::thread> threads;
    threads.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      threads.emplace_back([this] { work(); });
    }
    for (std::thread& thread : threads) thread.join();
    if (error_) return tl::unexpected(std::move(*error_));
    return summary_;
  }

 private:
  void work() {
    for (;;) {
      const int index = next_.fetch_add(1);
      if (index >= drive_.options().sweeps || stop_) return;
      const auto sweep = drive_.sweep(index);
      Status status = sweep ? write(index, *sweep) : Status(tl::unexpected(sweep.error()));
      const std::scoped_lock lock(mutex_);
      if (!status) {
        stop_ = true;
        if (!error_) error_ = std::move(status.error());
        return;
      }
      ++summary_.sweeps;
      summary_.points += sweep->cloud.size();
      summary_.boxes += sweep->boxes.size();
      if (progress_) progress_();
    }
  }

  Status write(int index, const SimulatedSweep& sweep) {
    const CloudFormat format = options_.kitti ? CloudFormat::bin : CloudFormat::pcd;
    const std::string name = number_name(index);
    const fs::path cloud = folder_ / "sweeps" / (name + (options_.kitti ? ".bin" : ".pcd"));
    if (Status status = write_cloud(cloud, sweep.cloud, format); !status) return status;
    return write_text(folder_ / "boxes" / (name + ".txt"), box_lines(sweep.boxes));
  }

  const Drive& drive_;
  fs::path folder_;
  ExportOptions options_;
  const std::function<void()>& progress_;
  std::atomic<int> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  ExportSummary summary_;
  std::optional<Error> error_;
};

Result<ExportSummary> write_files(const Drive& drive, const fs::path& folder,
                                  const ExportOptions& options,
                                  const std::function<void()>& progress) {
  std::error_code error;
  for (const char* part : {"sweeps", "boxes"}) {
    fs::create_directories(folder / part, error);
    if (error) return io_failure(folder / part, "cannot be made", error.value());
  }
  auto summary = SweepWriter(drive, folder, options, progress).run();
  if (!summary) return summary;
  std::string poses;
  const Pose first = drive.sweep_pose(0);
  for (int i = 0; i < drive.options().sweeps; ++i) {
    poses += pose_line(drive.sweep_pose(i).relative_to(first));
  }
  const Mesh world = seen_world(drive);
  summary->triangles = world.triangles.size();
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"poses.txt", poses},
                                   {"mesh.ply", mesh_ply(world)},
                                   {"sensor.json", sensor_json(drive.sensor())}}) {
    if (Status status = write_text(folder / name, text); !status) {
      return tl::unexpected(std::move(status.error()));
    }
  }
  return summary;
}

// Replaces the drive's parts in `folder`, and nothing else that lies there.
Status move_parts(const fs::path& from, const fs::path& folder) {
  const auto whole = hold_unfinished();  // the old drive or the new one, not parts of both
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return io_failure(folder, "cannot be made", error.value());
  for (const char* part : {"sweeps", "boxes", "poses.txt", "mesh.ply", "sensor.json"}) {
    fs::remove_all(folder / part, error);
    if (!error) fs::rename(from / part, folder / part, error);
    if (error) return io_failure(folder / part, "cannot be replaced", error.value());
  }
  return {};
}

}  // namespace

Result<ExportSummary> write_drive(const Drive& drive, const fs::path& folder,
                                  const ExportOptions& options,
                                  const std::function<void()>& progress) {
  std::error_code error;
  fs::path target = fs::absolute(folder, error).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  if (fs::exists(target, error) && !fs::is_directory(target, error)) {
    return fail(ErrorCode::invalid_argument,
                folder.string() + ": is a file; name a folder for the drive");
  }
  if (fs::exists(target, error) && !fs::is_empty(target, error) && !error && !options.force) {
    return fail(ErrorCode::invalid_argument,
                folder.string() +
                    ": is not empty; name another folder, or replace the drive in it "
                    "with --force");
  }
  fs::create_directories(target.parent_path(), error);
  if (error) return io_failure(target.parent_path(), "cannot be made", error.value());
  const Unfinished partial(target.parent_path() /
                           ("." + target.filename().string() + ".sweepcast"));
  fs::remove_all(partial.path(), error);  // of a run that was killed
  auto summary = write_files(drive, partial.path(), options, progress);
  if (summary) {
    if (Status status = move_parts(partial.path(), target); !status) {
      summary = tl::unexpected(std::move(status.error()));
    }
  }
  return summary;
}

}  // namespace sweepcast::lab
