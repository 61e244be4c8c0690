#include "lab/bench.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>

#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

/// CPU time that this thread has used, milliseconds.
double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double median(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// One peer's times and result on one sweep; the memory serves all sweeps.
struct Trial {
  std::vector<double> encode_ms, decode_ms;
  std::size_t bytes = 0;
  PointCloud decoded;
};

/// Adds what the stages took of each of `runs` runs.
void add_stages(std::span<const StageTime> stages, int runs, std::vector<StageMean>& sums) {
  for (const StageTime& stage : stages) {
    auto sum = std::find_if(sums.begin(), sums.end(),
                            [&](const StageMean& known) { return known.stage == stage.stage; });
    if (sum == sums.end()) sum = sums.insert(sum, {std::string(stage.stage), 0.0});
    sum->ms += std::chrono::duration<double, std::milli>(stage.time).count() / runs;
  }
}

/// What is summed up over the sweeps for one peer.
struct Totals {
  double bytes = 0, points_in = 0, points_out = 0, points_filled = 0;
  double encode_ms = 0, decode_ms = 0;
  DistortionMean distortion;
  std::vector<StageMean> encode_stages, decode_stages;

  void add(Trial& trial, const PointCloud& cloud, const Reference& reference) {
    bytes += static_cast<double>(trial.bytes);
    points_in += static_cast<double>(cloud.size());
    points_out += static_cast<double>(trial.decoded.size());
    const auto& filled = trial.decoded.filled;
    points_filled += static_cast<double>(
        std::count_if(filled.begin(), filled.end(), [](std::uint8_t mark) { return mark != 0; }));
    encode_ms += median(trial.encode_ms);
    decode_ms += median(trial.decode_ms);
    distortion.add(reference.compare(trial.decoded));
  }

  BenchRow row(const Peer& peer, std::size_t sweep_count) const {
    const auto sweeps = static_cast<double>(sweep_count);
    BenchRow row;
    row.codec = peer.codec();
    row.setting = peer.setting();
    row.ratio = bytes > 0 ? kBytesAPoint * points_in / bytes : 0.0;
    row.bytes = bytes / sweeps;
    row.points_in = points_in / sweeps;
    row.points_out = points_out / sweeps;
    row.points_filled = points_filled / sweeps;
    row.distortion = distortion.mean();
    row.encode_ms = encode_ms / sweeps;
    row.decode_ms = decode_ms / sweeps;
    row.encode_stages = encode_stages;
    row.decode_stages = decode_stages;
    for (auto* stages : {&row.encode_stages, &row.decode_stages}) {
      for (StageMean& stage : *stages) stage.ms /= sweeps;
    }
    return row;
  }
};

Status run(Peer& peer, const PointCloud& cloud, Trial& trial) {
  const double begin = thread_ms();
  const auto bytes = peer.encode(cloud);
  const double encoded = thread_ms();
  if (!bytes) return tl::unexpected(bytes.error());
  const double encode_child = peer.child_ms();
  const double decode_begin = thread_ms();
  Status decoded = peer.decode(*bytes, trial.decoded);
  const double end = thread_ms();
  if (!decoded) return decoded;
  trial.encode_ms.push_back(encoded - begin + encode_child);
  trial.decode_ms.push_back(end - decode_begin + peer.child_ms());
  trial.bytes = bytes->size();
  return {};
}

/// All runs of all peers on one sweep.
Status run_all(const Peers& peers, const PointCloud& cloud, int runs, std::vector<Trial>& trials) {
  for (int k = 0; k <= runs; ++k) {
    for (std::size_t i = 0; i < peers.size(); ++i) {
      if (k <= 1) {  // forgets the last sweep, then the run that warmed up
        trials[i].encode_ms.clear();
        trials[i].decode_ms.clear();
        peers[i]->forget_stages();
      }
      const Status status = run(*peers[i], cloud, trials[i]);
      if (!status) {
        return fail(status.error().code,
                    peers[i]->codec() + " " + peers[i]->setting() + ": " + status.error().message);
      }
    }
  }
  return {};
}

}  // namespace

Result<std::vector<BenchRow>> bench(std::span<const std::filesystem::path> sweeps,
                                    const Peers& peers, const BenchOptions& options) {
  if (sweeps.empty()) return fail(ErrorCode::invalid_argument, "bench: no sweep to measure on");
  if (options.runs < 1) return fail(ErrorCode::invalid_argument, "bench: runs must be at least 1");
  std::vector<Trial> trials(peers.size());
  std::vector<Totals> totals(peers.size());
  PointCloud cloud;
  for (const auto& path : sweeps) {
    if (const Status status = read_cloud(path, cloud); !status) {
      return tl::unexpected(status.error());
    }
    if (const Status status = run_all(peers, cloud, options.runs, trials); !status) {
      return fail(status.error().code, path.string() + ": " + status.error().message);
    }
    const Reference reference(cloud);
    for (std::size_t i = 0; i < peers.size(); ++i) {
      totals[i].add(trials[i], cloud, reference);
      add_stages(peers[i]->encode_stages(), options.runs, totals[i].encode_stages);
      add_stages(peers[i]->decode_stages(), options.runs, totals[i].decode_stages);
    }
    if (options.on_sweep) options.on_sweep(path.filename().string());
  }
  std::vector<BenchRow> rows;
  for (std::size_t i = 0; i < peers.size(); ++i)
    rows.push_back(totals[i].row(*peers[i], sweeps.size()));
  return rows;
}

}  // namespace sweepcast::lab
