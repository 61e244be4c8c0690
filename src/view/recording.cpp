#include "view/recording.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "io/sweep_layout.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::view {
namespace {

namespace fs = std::filesystem;

/// Of a frame whose sensor model, if it leans on one, is not yet looked for.
constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kNone = kUnknown - 1;

/// One file, and where the models are that its frames lean on.
struct SweepFile {
  fs::path path;
  SweepReader reader;
  std::uint32_t first = 0;            ///< number of its first frame in the recording
  std::vector<std::uint32_t> models;  ///< of each frame, the last one up to it that has the model
};

class SweepFiles : public Recording {
 public:
  Status open(const std::vector<fs::path>& files, const std::vector<fs::path>& originals);

  [[nodiscard]] std::uint32_t size() const override { return size_; }
  [[nodiscard]] std::vector<Stream> streams() const override;
  [[nodiscard]] std::uint8_t stream_of(std::uint32_t index) const override;
  [[nodiscard]] bool has_original(std::uint32_t index) const override {
    return original_of(index) != nullptr;
  }
  [[nodiscard]] Status original(std::uint32_t index, PointCloud& cloud) override;

 private:
  [[nodiscard]] Result<SharedSweep> make(std::uint32_t index) override;
  [[nodiscard]] static Status make_alone(SweepFile& file, std::uint32_t at, Bytes& frame);
  [[nodiscard]] static Bytes find_model(SweepFile& file, std::uint32_t at);
  [[nodiscard]] const fs::path* original_of(std::uint32_t index) const;

  std::vector<SweepFile> files_;
  std::map<std::string, fs::path> originals_;  ///< by the name of their file
  std::vector<fs::path> originals_by_number_;
  std::uint32_t size_ = 0;
};

Status SweepFiles::open(const std::vector<fs::path>& files,
                        const std::vector<fs::path>& originals) {
  if (files.size() > kMostStreams) {
    return fail(ErrorCode::limit, files.front().parent_path().string() +
                                      ": holds more than 256 .sweep files; name fewer of them");
  }
  std::uint64_t count = 0;
  for (const fs::path& path : files) {
    auto reader = SweepReader::open(path);
    if (!reader) return tl::unexpected(reader.error());
    const std::size_t frames = reader->entries().size();
    const auto first = static_cast<std::uint32_t>(count);
    count += frames;
    if (count >= kNone) return fail(ErrorCode::limit, path.string() + ": too many frames");
    files_.push_back(
        {path, std::move(*reader), first, std::vector<std::uint32_t>(frames, kUnknown)});
  }
  if (count == 0) {
    return fail(ErrorCode::invalid_argument,
                files.front().string() + ": holds no frame; record some first");
  }
  size_ = static_cast<std::uint32_t>(count);
  for (const fs::path& path : originals) originals_.emplace(path.stem().string(), path);
  originals_by_number_ = originals;
  return {};
}

std::vector<Stream> SweepFiles::streams() const {
  std::vector<Stream> streams;
  for (const SweepFile& file : files_) {
    streams.push_back({static_cast<std::uint8_t>(streams.size()),
                       fs::absolute(file.path).parent_path().filename().string(),
                       file.path.stem().string()});
  }
  return streams;
}

std::uint8_t SweepFiles::stream_of(std::uint32_t index) const {
  const auto after =
      std::upper_bound(files_.begin(), files_.end(), index,
                       [](std::uint32_t i, const SweepFile& file) { return i < file.first; });
  return static_cast<std::uint8_t>(after - files_.begin() - 1);
}

const fs::path* SweepFiles::original_of(std::uint32_t index) const {
  const SweepFile& file = files_[stream_of(index)];
  const std::string& name = file.reader.entries()[index - file.first].name;
  if (name.empty()) {
    return index < originals_by_number_.size() ? &originals_by_number_[index] : nullptr;
  }
  const auto found = originals_.find(name);
  return found == originals_.end() ? nullptr : &found->second;
}

Status SweepFiles::original(std::uint32_t index, PointCloud& cloud) {
  if (const fs::path* path = original_of(index)) return read_cloud(*path, cloud);
  return fail(ErrorCode::not_found, "frame " + std::to_string(index) + " has no original");
}

/// The last model up to frame `at`; empty where there is none. Every frame is read for that once.
Bytes SweepFiles::find_model(SweepFile& file, std::uint32_t at) {
  Bytes model;
  FrameHeader header;
  Bytes frame;
  std::uint32_t found = kNone;
  std::uint32_t i = at + 1;
  while (i > 0 && found == kNone) {
    --i;
    const std::uint32_t known = file.models[i];
    if (known == kNone) break;
    const std::uint32_t look = known == kUnknown ? i : known;
    if (!file.reader.read(look, frame) || !parse_frame_header(frame, header)) continue;
    const auto part = model_part(frame, header);
    if (!part || part->empty()) continue;
    model.assign(part->begin(), part->end());
    found = look;
  }
  std::fill(file.models.begin() + i, file.models.begin() + at + 1, found);
  return model;
}

/// Checks the frame, and puts the model in that it leans on.
Status SweepFiles::make_alone(SweepFile& file, std::uint32_t at, Bytes& frame) {
  if (Status sound = check_frame(frame, true); !sound) {
    return fail(ErrorCode::corrupt, sound.error().message);
  }
  FrameHeader header;
  if (Status parsed = parse_frame_header(frame, header); !parsed) return parsed;
  if (header.codec != CodecId::beam) return {};
  const auto own = model_part(frame, header);
  if (!own) return tl::unexpected(own.error());
  if (!own->empty()) return {};
  const Bytes model = find_model(file, at);
  if (model.empty()) return {};  // the decoder says what is missing
  Bytes whole;
  if (Status status = rewrite_frame(frame, ModelPart::put, model, whole); !status) return status;
  frame = std::move(whole);
  return {};
}

Result<SharedSweep> SweepFiles::make(std::uint32_t index) {
  const std::uint8_t stream = stream_of(index);
  SweepFile& file = files_[stream];
  const std::uint32_t at = index - file.first;
  auto frame = std::make_shared<Bytes>();
  Status status = file.reader.read(at, *frame);
  if (status) status = make_alone(file, at, *frame);
  FrameHeader header;
  if (status) status = parse_frame_header(*frame, header);
  auto sweep = std::make_shared<Sweep>();
  if (status) {
    const auto layers = count_layers(*frame, header);
    if (layers) sweep->layers = *layers;
    if (!layers) status = tl::unexpected(layers.error());
  }
  if (!status) {
    return fail(status.error().code, file.path.filename().string() + ": frame " +
                                         std::to_string(at) + ": " + status.error().message);
  }
  sweep->stream = stream;
  sweep->index = index;
  sweep->name = file.reader.entries()[at].name;
  sweep->has_original = has_original(index);
  sweep->frame = std::move(frame);
  return sweep;
}

class CloudFiles : public Recording {
 public:
  CloudFiles(std::vector<fs::path> clouds, Encoder encoder, double rate_hz)
      : clouds_(std::move(clouds)), encoder_(std::move(encoder)), rate_hz_(rate_hz) {}

  [[nodiscard]] std::uint32_t size() const override {
    return static_cast<std::uint32_t>(clouds_.size());
  }
  [[nodiscard]] std::vector<Stream> streams() const override {
    return {{0, fs::absolute(clouds_.front()).parent_path().filename().string(), "clouds"}};
  }
  [[nodiscard]] std::uint8_t stream_of(std::uint32_t /*index*/) const override { return 0; }
  [[nodiscard]] bool has_original(std::uint32_t /*index*/) const override { return true; }
  [[nodiscard]] Status original(std::uint32_t index, PointCloud& cloud) override {
    return read_cloud(clouds_[index], cloud);
  }

 private:
  [[nodiscard]] Result<SharedSweep> make(std::uint32_t index) override;

  std::vector<fs::path> clouds_;
  Encoder encoder_;
  double rate_hz_;
  PointCloud cloud_;
};

Result<SharedSweep> CloudFiles::make(std::uint32_t index) {
  const fs::path& path = clouds_[index];
  if (Status read = read_cloud(path, cloud_); !read) return tl::unexpected(read.error());
  const auto stamp_ns = static_cast<std::int64_t>(static_cast<double>(index) * 1e9 / rate_hz_);
  const auto frame = encoder_.encode(cloud_, {index, stamp_ns, "clouds"});
  FrameHeader header;
  if (!frame) {
    return fail(frame.error().code, path.filename().string() + ": " + frame.error().message);
  }
  if (Status parsed = parse_frame_header(*frame, header); !parsed) {
    return tl::unexpected(parsed.error());
  }
  const auto layers = count_layers(*frame, header);
  if (!layers) return tl::unexpected(layers.error());
  auto sweep = std::make_shared<Sweep>();
  sweep->index = index;
  sweep->name = path.stem().string();
  sweep->has_original = true;
  sweep->layers = *layers;
  sweep->frame = std::make_shared<Bytes>(frame->begin(), frame->end());
  return sweep;
}

}  // namespace

Result<SharedSweep> Recording::sweep(std::uint32_t index) {
  if (index >= size()) {
    return fail(ErrorCode::invalid_argument, "there is no frame " + std::to_string(index));
  }
  for (const SharedSweep& kept : kept_) {
    if (kept->index == index) return kept;
  }
  auto made = make(index);
  if (!made) return made;
  kept_.push_back(*made);
  kept_bytes_ += (*made)->frame->size();
  while (kept_bytes_ > kMostKept && kept_.size() > 1) {
    kept_bytes_ -= kept_.front()->frame->size();
    kept_.pop_front();
  }
  return made;
}

Result<std::unique_ptr<Recording>> open_sweep_files(const std::vector<fs::path>& files,
                                                    const std::vector<fs::path>& originals) {
  auto recording = std::make_unique<SweepFiles>();
  if (Status opened = recording->open(files, originals); !opened) {
    return tl::unexpected(opened.error());
  }
  return recording;
}

Result<std::unique_ptr<Recording>> open_clouds(std::vector<fs::path> clouds, EncoderOptions options,
                                               double rate_hz) {
  options.beam.model_interval = 1;
  auto encoder = Encoder::create(options);
  if (!encoder) return tl::unexpected(encoder.error());
  return std::make_unique<CloudFiles>(std::move(clouds), std::move(*encoder), rate_hz);
}

}  // namespace sweepcast::view
