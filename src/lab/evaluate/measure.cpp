#include "lab/evaluate/measure.hpp"

#include <ctime>
#include <memory>
#include <optional>
#include <utility>

#include "lab/evaluate/settings.hpp"
#include "lab/evaluate/sweep_picture.hpp"
#include "lab/odometry/sweep_clock.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/frame.hpp"

namespace sweepcast::lab {
namespace {

/// CPU time that this thread has used, milliseconds.
double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

/// Sums over the sweeps.
struct Sums {
  double points = 0.0, bytes = 0.0, encode_ms = 0.0, decode_ms = 0.0;
  std::map<std::string, double> parts;

  void add_parts(std::span<const std::byte> frame) {
    FrameHeader header;
    if (!parse_frame_header(frame, header)) return;
    parts["header"] += static_cast<double>(header.header_size);
    int layer = 0;
    for (const FramePart& part : header.parts) {
      std::string part_of(part_name(header.codec, part.kind));
      if (part_of == "layer") part_of += " " + std::to_string(++layer);
      parts[part_of] += static_cast<double>(part.size);
    }
  }

  [[nodiscard]] Coding coding(std::size_t sweep_count) const {
    const auto sweeps = static_cast<double>(sweep_count);
    Coding coding;
    coding.ratio = bytes > 0.0 ? kBytesAPoint * points / bytes : 0.0;
    coding.bytes = bytes / sweeps;
    coding.encode_ms = encode_ms / sweeps;
    coding.decode_ms = decode_ms / sweeps;
    for (const auto& [part, sum] : parts) coding.parts[part] = sum / sweeps;
    return coding;
  }
};

bool is_ours(const Peer& peer) {
  return peer.codec() == name(CodecId::beam) || peer.codec() == name(CodecId::rcpcc);
}

Status code(Peer& peer, const PointCloud& original, PointCloud& decoded, Sums& sums) {
  const double begin = thread_ms();
  const auto bytes = peer.encode(original);
  const double encoded = thread_ms();
  if (!bytes) return tl::unexpected(bytes.error());
  sums.encode_ms += encoded - begin + peer.child_ms();
  sums.points += static_cast<double>(original.size());
  sums.bytes += static_cast<double>(bytes->size());
  if (is_ours(peer)) sums.add_parts(*bytes);
  const double decode_begin = thread_ms();
  Status status = peer.decode(*bytes, decoded);
  sums.decode_ms += thread_ms() - decode_begin + peer.child_ms();
  return status;
}

/// The tasks at work; one that failed has its error, and no run any more.
class Runs {
 public:
  explicit Runs(std::span<const Task* const> tasks) : tasks_(tasks) {
    for (const Task* task : tasks) {
      auto run = task->begin();
      outcomes_.emplace_back(Figures{});
      runs_.push_back(run ? std::move(*run) : nullptr);
      if (!run) outcomes_.back() = tl::unexpected(std::move(run.error()));
    }
  }

  void add(const SweepPair& sweep) {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (runs_[i] == nullptr || !tasks_[i]->takes(sweep.index)) continue;
      if (Status added = runs_[i]->add(sweep); !added) {
        outcomes_[i] = tl::unexpected(std::move(added.error()));
        runs_[i].reset();
      }
    }
  }

  std::vector<TaskOutcome> finish() {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (runs_[i] == nullptr) continue;
      outcomes_[i] = runs_[i]->finish();
      runs_[i].reset();
    }
    return std::move(outcomes_);
  }

 private:
  std::span<const Task* const> tasks_;
  std::vector<std::unique_ptr<TaskRun>> runs_;
  std::vector<TaskOutcome> outcomes_;
};

}  // namespace

Result<Measurement> measure(const DriveFiles& drive, Peer& peer, std::span<const Task* const> tasks,
                            const std::function<void()>& on_sweep) {
  const auto failed = [&](const std::filesystem::path& sweep, const Error& error) {
    return fail(error.code, sweep.string() + ": " + error.message);
  };
  Runs runs(tasks);
  Sums sums;
  PointCloud original, decoded;
  std::vector<float> when;
  std::string picture;
  for (std::size_t i = 0; i < drive.sweeps.size(); ++i) {
    if (Status read = read_cloud(drive.sweeps[i], original); !read) {
      return tl::unexpected(std::move(read.error()));
    }
    if (Status coded = code(peer, original, decoded, sums); !coded) {
      return failed(drive.sweeps[i], coded.error());
    }
    when.clear();
    if (const auto clock = SweepClock::learn(original)) clock->tell(decoded, when);
    runs.add({i, original, decoded, when});
    if (i == drive.sweeps.size() / 2) picture = picture_of(decoded);
    if (on_sweep) on_sweep();
  }
  Measurement measurement{sums.coding(drive.sweeps.size()), runs.finish()};
  measurement.coding.picture = std::move(picture);
  if (peer.codec() == kOriginal) measurement.coding.encode_ms = measurement.coding.decode_ms = 0.0;
  return measurement;
}

}  // namespace sweepcast::lab
