#include "lab/peers/zstd_grid.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "codec/entropy/zstd_coder.hpp"
#include "lab/peers/step_grid.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::size_t kMaxPoints = std::size_t{1} << 24;

/// The low 21 bits of `value`, two zeros after each but the last.
std::uint64_t spread(std::uint64_t value) {
  value = (value | (value << 32)) & 0x001F00000000FFFF;
  value = (value | (value << 16)) & 0x001F0000FF0000FF;
  value = (value | (value << 8)) & 0x100F00F00F00F00F;
  value = (value | (value << 4)) & 0x10C30C30C30C30C3;
  return (value | (value << 2)) & 0x1249249249249249;
}

/// The inverse; other bits are ignored.
std::uint32_t gather(std::uint64_t value) {
  value &= 0x1249249249249249;
  value = (value | (value >> 2)) & 0x10C30C30C30C30C3;
  value = (value | (value >> 4)) & 0x100F00F00F00F00F;
  value = (value | (value >> 8)) & 0x001F0000FF0000FF;
  value = (value | (value >> 16)) & 0x001F00000000FFFF;
  return static_cast<std::uint32_t>((value | (value >> 32)) & 0x1FFFFF);
}

void write_morton(const StepGrid& grid, std::vector<std::byte>& raw) {
  std::vector<std::uint64_t> codes(grid.cells.size());
  std::transform(grid.cells.begin(), grid.cells.end(), codes.begin(), [](const GridCell& cell) {
    return spread(cell[0]) | (spread(cell[1]) << 1) | (spread(cell[2]) << 2);
  });
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  raw.clear();
  ByteWriter writer(raw);
  std::uint64_t last = 0;
  for (const std::uint64_t code : codes) {
    writer.put_varint(code - last);
    last = code;
  }
}

bool read_morton(std::span<const std::byte> raw, StepGrid& grid) {
  ByteReader reader(raw);
  std::uint64_t code = 0;
  while (reader.ok() && !reader.at_end()) {
    code += reader.get_varint(~std::uint64_t{0} >> 1);
    if ((code >> 63) != 0 || grid.cells.size() == kMaxPoints) return false;
    grid.cells.push_back({gather(code), gather(code >> 1), gather(code >> 2)});
  }
  return reader.ok();
}

/// Byte `plane` of each difference stands with the same byte of the others, where zstd finds more
/// to match than in whole numbers.
void write_differences(const StepGrid& grid, std::vector<std::byte>& raw) {
  const std::size_t count = grid.cells.size();
  raw.resize(count * sizeof(GridCell));
  std::byte* out = raw.data();
  for (std::size_t axis = 0; axis < 3; ++axis, out += 4 * count) {
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t difference = grid.cells[i][axis] - last;  // modulo 2^32
      last = grid.cells[i][axis];
      const std::uint32_t zigzag = (difference << 1) ^ (0U - (difference >> 31));
      for (unsigned plane = 0; plane < 4; ++plane) {
        out[plane * count + i] = static_cast<std::byte>(zigzag >> (8 * plane));
      }
    }
  }
}

bool read_differences(std::span<const std::byte> raw, StepGrid& grid) {
  const std::size_t count = raw.size() / sizeof(GridCell);
  if (raw.size() % sizeof(GridCell) != 0) return false;
  grid.cells.resize(count);
  const std::byte* in = raw.data();
  for (std::size_t axis = 0; axis < 3; ++axis, in += 4 * count) {
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t zigzag = 0;
      for (unsigned plane = 0; plane < 4; ++plane) {
        zigzag |= static_cast<std::uint32_t>(in[plane * count + i]) << (8 * plane);
      }
      last += (zigzag >> 1) ^ (0U - (zigzag & 1));
      if (last >= kGridSteps) return false;
      grid.cells[i][axis] = last;
    }
  }
  return true;
}

class ZstdGridPeer : public Peer {
 public:
  ZstdGridPeer(std::string codec, std::uint32_t step_um, const ZstdGridOptions& options)
      : Peer(std::move(codec), fmt::format("step {} m", options.step_m)),
        step_um_(step_um),
        order_(options.order),
        encoder_(options.level) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    to_grid(cloud, step_um_, grid_);
    frame_.clear();
    if (grid_.cells.empty()) return std::span<const std::byte>{};
    order_ == GridOrder::morton ? write_morton(grid_, raw_) : write_differences(grid_, raw_);
    ByteWriter frame(frame_);
    write_head(grid_, frame);
    encoder_.append(raw_, frame_);
    return std::span<const std::byte>(frame_);
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    cloud.clear();
    if (bytes.empty()) return {};
    const auto damaged = [&] { return fail(ErrorCode::corrupt, codec() + ": damaged bytes"); };
    ByteReader frame(bytes);
    if (!read_head(frame, decoded_)) return damaged();
    const auto packed = frame.get_bytes(frame.remaining());
    Status unpacked = decoder_.decode(packed, kMaxPoints * sizeof(GridCell), raw_);
    if (!unpacked) return unpacked;
    const bool read = order_ == GridOrder::morton ? read_morton(raw_, decoded_)
                                                  : read_differences(raw_, decoded_);
    if (!read) return damaged();
    to_cloud(decoded_, cloud);
    return {};
  }

 private:
  std::uint32_t step_um_;
  GridOrder order_;
  ZstdEncoder encoder_;
  ZstdDecoder decoder_;
  StepGrid grid_, decoded_;
  std::vector<std::byte> raw_, frame_;
};

Result<Peers> ladder(std::span<const double> steps, GridOrder order) {
  return make_ladder(steps, [order](double step) {
    return make_zstd_grid_peer({.step_m = step, .order = order});
  });
}

}  // namespace

Result<std::unique_ptr<Peer>> make_zstd_grid_peer(const ZstdGridOptions& options) {
  const char* codec = options.order == GridOrder::morton ? "zstd-morton" : "zstd-delta";
  const auto step = step_um_of(options.step_m, codec);
  if (!step) return tl::unexpected(step.error());
  if (options.level < 1 || options.level > 22) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: level {}; give 1 to 22", codec, options.level));
  }
  return std::make_unique<ZstdGridPeer>(codec, *step, options);
}

Result<Peers> zstd_morton_ladder() {
  static constexpr std::array<double, 9> kSteps{0.01, 0.02, 0.05, 0.08, 0.1, 0.15, 0.2, 0.3, 0.4};
  return ladder(kSteps, GridOrder::morton);
}

Result<Peers> zstd_delta_ladder() {
  static constexpr std::array<double, 9> kSteps{0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6};
  return ladder(kSteps, GridOrder::as_given);
}

}  // namespace sweepcast::lab
