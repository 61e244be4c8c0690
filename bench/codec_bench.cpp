// What encoding and decoding one synthetic sweep costs at each level, beside copying its bytes and
// beside zstd on them. Throughput counts 16 bytes a point: x, y, z, intensity as float32.
#include <benchmark/benchmark.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"

namespace {

constexpr int kBeams = 64;
constexpr int kColumns = 1800;

// A 64-beam sensor in a street 14 m wide, pillars along it, 2 cm of range noise.
const sweepcast::PointCloud& street() {
  static const sweepcast::PointCloud kCloud = [] {
    sweepcast::PointCloud cloud;
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.02);
    for (int beam = 0; beam < kBeams; ++beam) {
      const double elevation = (2.0 - 0.42 * beam) * std::numbers::pi / 180;
      for (int column = 0; column < kColumns; ++column) {
        const double azimuth = column * 2 * std::numbers::pi / kColumns;
        const double to_wall = 7.0 / std::max(std::abs(std::sin(azimuth)), 0.07);
        const double to_pillar = column % 150 < 10 ? 5.0 : 1e9;
        const double to_floor = elevation < 0 ? 1.7 / std::tan(-elevation) : 1e9;
        const double distance = std::min({to_wall, to_pillar, to_floor}) + noise(random);
        cloud.x.push_back(static_cast<float>(distance * std::cos(azimuth)));
        cloud.y.push_back(static_cast<float>(distance * std::sin(azimuth)));
        cloud.z.push_back(static_cast<float>(distance * std::tan(elevation)));
      }
    }
    return cloud;
  }();
  return kCloud;
}

// The sweep as a KITTI .bin holds it.
std::vector<float> packed(const sweepcast::PointCloud& cloud) {
  std::vector<float> values;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    values.insert(values.end(), {cloud.x[i], cloud.y[i], cloud.z[i], 0.0F});
  }
  return values;
}

void report(benchmark::State& state, std::size_t bytes_out) {
  const std::size_t bytes_in = street().size() * 16;
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes_in));
  state.counters["ratio"] = static_cast<double>(bytes_in) / static_cast<double>(bytes_out);
}

sweepcast::Result<sweepcast::Encoder> encoder_at(std::int64_t level) {
  sweepcast::EncoderOptions options;
  options.codec = sweepcast::CodecId::rcpcc;
  options.rcpcc.params = sweepcast::kRcpccLevels.at(static_cast<std::size_t>(level));
  return sweepcast::Encoder::create(options);
}

void encode(benchmark::State& state) {
  auto encoder = encoder_at(state.range(0));
  if (!encoder) return state.SkipWithError(encoder.error().message.c_str());
  std::size_t bytes = 1;
  while (state.KeepRunning()) {
    const auto frame = encoder->encode(street(), {});
    if (!frame) return state.SkipWithError(frame.error().message.c_str());
    bytes = frame->size();
  }
  report(state, bytes);
}

void decode(benchmark::State& state) {
  auto encoder = encoder_at(state.range(0));
  if (!encoder) return state.SkipWithError(encoder.error().message.c_str());
  const auto frame = encoder->encode(street(), {});
  if (!frame) return state.SkipWithError(frame.error().message.c_str());
  sweepcast::Decoder decoder;
  sweepcast::PointCloud cloud;
  while (state.KeepRunning()) {
    const auto status = decoder.decode(*frame, cloud);
    if (!status) return state.SkipWithError(status.error().message.c_str());
    benchmark::DoNotOptimize(cloud.x.data());
  }
  report(state, frame->size());
}

void copy_bytes(benchmark::State& state) {
  const std::vector<float> in = packed(street());
  std::vector<float> out(in.size());
  while (state.KeepRunning()) {
    std::memcpy(out.data(), in.data(), in.size() * sizeof(float));
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  report(state, in.size() * sizeof(float));
}

void zstd_encode(benchmark::State& state) {
  const std::vector<float> in = packed(street());
  const auto bytes = std::as_bytes(std::span(in));
  std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
  std::size_t size = 1;
  while (state.KeepRunning()) {
    size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(),
                         static_cast<int>(state.range(0)));
    benchmark::DoNotOptimize(size);
  }
  report(state, size);
}

}  // namespace

BENCHMARK(encode)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);
BENCHMARK(decode)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);
BENCHMARK(copy_bytes)->Unit(benchmark::kMillisecond);
BENCHMARK(zstd_encode)->Arg(1)->Arg(3)->Arg(9)->Unit(benchmark::kMillisecond);
