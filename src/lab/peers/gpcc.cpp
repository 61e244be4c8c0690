#include "lab/peers/gpcc.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "io/file.hpp"
#include "io/unfinished.hpp"
#include "lab/peers/run_program.hpp"
#include "lab/peers/step_grid.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxStream = std::size_t{1} << 28;  // bytes

/// A folder of its own, removed at the end of its life.
class WorkFolder {
 public:
  /// Errors: io.
  static Result<WorkFolder> create() {
    static std::atomic<unsigned> next{0};
    std::error_code error;
    const fs::path parent = fs::temp_directory_path(error);
    WorkFolder folder(parent / fmt::format("sweepcast-gpcc-{}-{}", getpid(), next++));
    if (!error) fs::create_directory(folder.path(), error);
    if (!error) return folder;
    return fail(ErrorCode::io, fmt::format("{}: cannot be made: {}; set TMPDIR to a folder that "
                                           "can be written to",
                                           folder.path().string(), error.message()));
  }
  [[nodiscard]] const fs::path& path() const { return folder_.path(); }
  [[nodiscard]] fs::path operator/(const char* name) const { return folder_.path() / name; }

 private:
  explicit WorkFolder(fs::path path) : folder_(std::move(path)) {}
  Unfinished folder_;
};

/// The cells as a cloud whose coordinates are whole steps: exact in float32.
PointCloud whole_steps(const StepGrid& grid) {
  PointCloud cloud;
  for (const GridCell& cell : grid.cells) {
    cloud.x.push_back(static_cast<float>(cell[0]));
    cloud.y.push_back(static_cast<float>(cell[1]));
    cloud.z.push_back(static_cast<float>(cell[2]));
  }
  return cloud;
}

/// The inverse. False where the program gave what are no cells.
bool take_steps(const PointCloud& cloud, StepGrid& grid) {
  grid.cells.clear();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    GridCell cell{};
    const std::array<float, 3> place{cloud.x[i], cloud.y[i], cloud.z[i]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(place[axis] >= 0.0F && place[axis] < static_cast<float>(kGridSteps))) return false;
      cell[axis] = static_cast<std::uint32_t>(place[axis]);
    }
    grid.cells.push_back(cell);
  }
  return true;
}

class GpccPeer : public Peer {
 public:
  GpccPeer(std::uint32_t step_um, const GpccOptions& options)
      : Peer("gpcc-octree", fmt::format("step {} m", options.step_m)),
        step_um_(step_um),
        program_(options.program) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    child_ms_ = 0.0;
    to_grid(cloud, step_um_, grid_);
    if (grid_.cells.empty()) return std::span<const std::byte>{};
    frame_.clear();
    ByteWriter writer(frame_);
    write_head(grid_, writer);
    if (Status coded = run_encoder(); !coded) return tl::unexpected(coded.error());
    writer.put_bytes(stream_);
    return std::span<const std::byte>(frame_);
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    child_ms_ = 0.0;
    cloud.clear();
    if (bytes.empty()) return {};
    ByteReader reader(bytes);
    if (!read_head(reader, decoded_)) return fail(ErrorCode::corrupt, "gpcc: the head is damaged");
    if (Status run = run_decoder(reader.get_bytes(reader.remaining()), cloud); !run) {
      cloud.clear();
      return run;
    }
    const bool sound = take_steps(cloud, decoded_);
    cloud.clear();
    if (!sound) return fail(ErrorCode::corrupt, "gpcc: the program decoded what are no steps");
    to_cloud(decoded_, cloud);
    return {};
  }

  [[nodiscard]] double child_ms() const override { return child_ms_; }

 private:
  Status run(std::vector<std::string> arguments, const fs::path& log) {
    arguments.insert(arguments.begin(), program_);
    const auto ms = run_program(arguments, log);
    if (!ms) return tl::unexpected(ms.error());
    child_ms_ = *ms;
    return {};
  }

  /// Codes `grid_` into `stream_`.
  Status run_encoder() {
    const auto folder = WorkFolder::create();
    if (!folder) return tl::unexpected(folder.error());
    const fs::path sweep = *folder / "sweep.ply";
    const fs::path stream = *folder / "sweep.bin";
    Status written = write_cloud(sweep, whole_steps(grid_), CloudFormat::ply);
    if (!written) return written;
    // The geometry's octree alone, as it did best on sweeps of a spinning sensor: no planar mode,
    // no direct coding of lone points.
    Status coded = run({"--mode=0", "--uncompressedDataPath=" + sweep.string(),
                        "--compressedStreamPath=" + stream.string(), "--disableAttributeCoding=1",
                        "--positionQuantizationScale=1", "--mergeDuplicatedPoints=1",
                        "--neighbourAvailBoundaryLog2=8", "--inferredDirectCodingMode=0",
                        "--planarEnabled=0", "--maxNumQtBtBeforeOt=2", "--minQtbtSizeLog2=0"},
                       *folder / "log");
    if (!coded) return coded;
    return read_file(stream, kMaxStream, stream_);
  }

  /// Decodes a stream into whole steps.
  Status run_decoder(std::span<const std::byte> bytes, PointCloud& cloud) {
    const auto folder = WorkFolder::create();
    if (!folder) return tl::unexpected(folder.error());
    const fs::path sweep = *folder / "decoded.ply";
    const fs::path stream = *folder / "sweep.bin";
    if (Status written = write_file(stream, bytes); !written) return written;
    Status decoded = run({"--mode=1", "--compressedStreamPath=" + stream.string(),
                          "--reconstructedDataPath=" + sweep.string(), "--outputBinaryPly=1"},
                         *folder / "log");
    if (!decoded) return decoded;
    return read_cloud(sweep, cloud);
  }

  std::uint32_t step_um_;
  std::string program_;
  double child_ms_ = 0.0;
  StepGrid grid_, decoded_;
  std::vector<std::byte> stream_, frame_;
};

}  // namespace

Result<std::unique_ptr<Peer>> make_gpcc_peer(const GpccOptions& options) {
  const auto step = step_um_of(options.step_m, "gpcc");
  if (!step) return tl::unexpected(step.error());
  if (!has_program(options.program)) {
    return fail(
        ErrorCode::not_found,
        fmt::format("gpcc: no program {} on the PATH; build MPEG's test model TMC13 and put "
                    "its tmc3 there",
                    options.program));
  }
  return std::make_unique<GpccPeer>(*step, options);
}

Result<Peers> gpcc_ladder() {
  static constexpr std::array<double, 10> kSteps{0.008, 0.016, 0.032, 0.05, 0.08,
                                                 0.1,   0.128, 0.16,  0.2,  0.3};
  return make_ladder(kSteps, [](double step) { return make_gpcc_peer({.step_m = step}); });
}

}  // namespace sweepcast::lab
