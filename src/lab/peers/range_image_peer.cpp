#include "lab/peers/range_image_peer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lab/peers/checked_frame.hpp"
#include "lab/peers/mask_coder.hpp"

namespace sweepcast::lab {
namespace {

constexpr int kUniformRows = 64;

bool has_finite_point(const PointCloud& cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.is_finite(i)) return true;
  }
  return false;
}

class RangeImagePeer : public Peer {
 public:
  RangeImagePeer(std::string codec, std::string setting, const RangeImageForm& form,
                 std::unique_ptr<ImageCoder> coder)
      : Peer(std::move(codec), std::move(setting)), form_(form), coder_(std::move(coder)) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    if (!has_finite_point(cloud)) return std::span<const std::byte>{};
    if (raster_.rows.empty()) {
      raster_.rows = form_.beam_aligned ? beam_rows(cloud) : uniform_rows(cloud, kUniformRows);
    }
    raster_.columns = form_.columns;
    draw(cloud, raster_);
    body_.clear();
    ByteWriter writer(body_);
    write_head(raster_, writer);
    mask_.clear();
    if (form_.beam_aligned) {
      encode_mask(raster_.ranges, raster_.columns, mask_);
      fill_gaps(raster_.columns, raster_.ranges);
    }
    writer.put_varint(form_.beam_aligned ? mask_.size() + 1 : 0);
    writer.put_bytes(mask_);
    if (Status coded = coder_->encode(raster_.ranges, raster_.columns, body_); !coded) {
      return tl::unexpected(coded.error());
    }
    write_checked(body_, frame_);
    return std::span<const std::byte>(frame_);
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    cloud.clear();
    if (bytes.empty()) return {};
    const auto body = read_checked(bytes);
    if (!body) return damaged("checksum");
    ByteReader reader(*body);
    if (!read_head(reader, decoded_)) return damaged("head");
    const std::size_t mask_size = reader.get_varint(bytes.size());
    occupied_.assign(decoded_.ranges.size(), 1);
    if (mask_size > 0) {
      const auto mask = reader.get_bytes(mask_size - 1);
      if (!reader.ok() || !decode_mask(mask, decoded_.columns, occupied_)) return damaged("mask");
    }
    const auto image = reader.get_bytes(reader.remaining());
    if (!reader.ok()) return damaged("head");
    Status read = coder_->decode(image, decoded_.columns, decoded_.ranges);
    if (!read) return read;
    show(mask_size > 0, cloud);
    return {};
  }

 private:
  [[nodiscard]] Status damaged(const char* part) const {
    return fail(ErrorCode::corrupt,
                fmt::format("{}: the range image's {} is damaged", codec(), part));
  }

  void show(bool masked, PointCloud& cloud) {
    auto& ranges = decoded_.ranges;
    for (std::size_t i = 0; masked && i < ranges.size(); ++i) {
      // A masked cell holds a point, even where the codec's error brings its range down to 0.
      ranges[i] = occupied_[i] != 0 ? std::max<std::uint16_t>(ranges[i], 1) : std::uint16_t{0};
    }
    const double least = std::ceil(kNaiveNearest * 1e6 / std::max(1U, decoded_.unit_um));
    to_cloud(decoded_, masked ? 1 : static_cast<std::uint32_t>(least), cloud);
  }

  RangeImageForm form_;
  std::unique_ptr<ImageCoder> coder_;
  RangeRaster raster_, decoded_;
  std::vector<std::byte> frame_, body_, mask_;
  std::vector<std::uint8_t> occupied_;
};

}  // namespace

std::string name(const RangeImageForm& form) {
  if (form.beam_aligned) return fmt::format("beams x {}", form.columns);
  return fmt::format("{} x {}", kUniformRows, form.columns);
}

Status check(const RangeImageForm& form) {
  if (form.columns >= 16 && form.columns <= kMaxRasterColumns) return {};
  return fail(ErrorCode::invalid_argument, fmt::format("range image: {} columns; give 16 to {}",
                                                       form.columns, kMaxRasterColumns));
}

std::unique_ptr<Peer> make_range_image_peer(std::string codec, std::string setting,
                                            const RangeImageForm& form,
                                            std::unique_ptr<ImageCoder> coder) {
  return std::make_unique<RangeImagePeer>(std::move(codec), std::move(setting), form,
                                          std::move(coder));
}

}  // namespace sweepcast::lab
