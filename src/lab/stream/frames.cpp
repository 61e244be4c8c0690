#include "lab/stream/frames.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "lab/distortion.hpp"
#include "rate/qoe.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::size_t kF10 = 2;  ///< of `kFScoreDistancesM`

EncoderOptions ladder_options(CodecId codec, std::size_t level) {
  EncoderOptions options;
  options.codec = codec;
  options.rcpcc.params = kRcpccLevels[level];
  options.beam.level = static_cast<int>(level);
  options.beam.fields = Fields::xyz;
  options.beam.model_interval = 1;  // so that each frame decodes alone
  return options;
}

EncoderOptions budget_options(std::size_t bytes) {
  EncoderOptions options = ladder_options(CodecId::beam, 0);
  options.beam.level.reset();
  options.beam.target_bytes = bytes;
  return options;
}

/// Sizes of the budgets, largest first.
std::vector<std::size_t> budgets() {
  std::vector<std::size_t> sizes;
  double bytes = FrameMaker::kLargestBudget;
  for (std::size_t i = 0; i < FrameMaker::kBudgets; ++i, bytes /= FrameMaker::kBudgetStep) {
    sizes.push_back(static_cast<std::size_t>(std::lround(bytes)));
  }
  return sizes;
}

Result<FrameSize> size_of(std::span<const std::byte> frame) {
  FrameHeader header;
  if (Status parsed = parse_frame_header(frame, header); !parsed) {
    return tl::unexpected(parsed.error());
  }
  FrameSize size;
  for (const FramePart& part : header.parts) {
    const std::string_view name = part_name(header.codec, part.kind);
    if (name == "model") size.model = part.size;
    if (name == "layer") size.layer_ends.push_back(part.offset + part.size - size.model);
  }
  if (size.layer_ends.empty()) size.layer_ends.push_back(header.frame_size - size.model);
  size.layer_ends.back() = header.frame_size - size.model;
  return size;
}

tl::unexpected<Error> of_file(const std::filesystem::path& path, const Error& error) {
  return fail(error.code, path.string() + ": " + error.message);
}

}  // namespace

std::vector<std::size_t> FrameSet::level_bytes() const {
  std::vector<std::size_t> bytes(ladder, 0);
  for (const auto& sweep : sizes) {
    for (std::size_t level = 0; level < ladder; ++level) {
      bytes[level] += sweep[level].layer_ends.back();
    }
  }
  for (std::size_t& sum : bytes) sum /= sizes.size();
  return bytes;
}

std::size_t FrameSet::level_reached(const FrameKey& key) const {
  if (key.setting < ladder && key.layers == sizes[key.sweep][key.setting].layer_ends.size()) {
    return key.setting;
  }
  const double f10 = qualities.at(key).f10;
  std::size_t level = 0;
  while (level < ladder) {
    const std::size_t layers = sizes[key.sweep][level].layer_ends.size();
    if (f10 >= qualities.at({key.sweep, level, layers}).f10) break;
    ++level;
  }
  return level;
}

Result<FrameSet> FrameMaker::encode(bool with_budgets, const OnSweep& on_sweep) {
  FrameSet frames;
  frames.codec = codec_;
  frames.ladder = kLevels;
  std::vector<Encoder> encoders;
  const auto add = [&](const EncoderOptions& options, std::size_t bytes) {
    auto encoder = Encoder::create(options);
    if (encoder) encoders.push_back(std::move(*encoder));
    frames.target_bytes.push_back(bytes);
  };
  for (std::size_t level = 0; level < kLevels; ++level) add(ladder_options(codec_, level), 0);
  if (with_budgets && codec_ == CodecId::beam) {
    for (const std::size_t bytes : budgets()) add(budget_options(bytes), bytes);
  }
  bytes_.clear();
  PointCloud cloud;
  for (const auto& path : paths_) {
    if (const Status read = read_cloud(path, cloud); !read) return tl::unexpected(read.error());
    auto& kept = bytes_.emplace_back();
    auto& sizes = frames.sizes.emplace_back();
    for (std::size_t i = 0; i < frames.target_bytes.size(); ++i) {
      const auto frame = encoders[i].encode(cloud, SweepInfo{});
      if (!frame && frames.target_bytes[i] > 0 && frame.error().code == ErrorCode::limit) {
        frames.target_bytes.resize(i);  // this sweep does not fit, nor smaller sizes
        break;
      }
      if (!frame) return of_file(path, frame.error());
      auto size = size_of(*frame);
      if (!size) return of_file(path, size.error());
      kept.emplace_back(frame->begin(), frame->end());
      sizes.push_back(std::move(*size));
    }
    if (on_sweep) on_sweep(path.filename().string());
  }
  return frames;
}

Status FrameMaker::measure(const std::set<FrameKey>& keys, FrameSet& frames,
                           const OnSweep& on_sweep) const {
  PointCloud cloud;
  PointCloud decoded;
  std::optional<Reference> reference;
  std::optional<std::size_t> sweep;  // that `reference` is of
  for (const FrameKey& key : keys) {
    if (frames.qualities.contains(key)) continue;
    const auto& path = paths_[key.sweep];
    if (sweep != key.sweep) {
      if (Status read = read_cloud(path, cloud); !read) return read;
      reference.emplace(cloud);
      sweep = key.sweep;
    }
    DecoderOptions options;
    options.fill = true;
    options.max_layers = static_cast<int>(key.layers);
    const Status done = Decoder(options).decode(bytes_[key.sweep][key.setting], decoded);
    if (!done) return of_file(path, done.error());
    const Distortion distortion = reference->compare(decoded);
    frames.qualities[key] = {distortion.f_score[kF10], distortion.d2_psnr};
    if (on_sweep) on_sweep(path.filename().string());
  }
  return {};
}

}  // namespace sweepcast::lab
