#include "lab/evaluate/sweep_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/crc32.hpp"

namespace sweepcast::lab {
namespace {

/// Low to high, from blue over green to orange; each is legible on black and on white.
constexpr std::array<std::uint32_t, 16> kColours{
    0x000000, 0x4B4FCB, 0x3F62D0, 0x3574CF, 0x2C84C8, 0x2492BB, 0x1F9EA8, 0x22A890,
    0x32AF77, 0x4CB35E, 0x6BB348, 0x8BAF37, 0xA9A72F, 0xC59A30, 0xDB8936, 0xE87440};
constexpr double kLowestM = -2.5, kHighestM = 2.5;

void put_u32(std::string& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xFFU);
}

void put_chunk(std::string& out, std::string_view kind, std::string_view data) {
  put_u32(out, static_cast<std::uint32_t>(data.size()));
  const std::string body = std::string(kind) + std::string(data);
  out += body;
  put_u32(out, crc32(std::as_bytes(std::span(body))));
}

std::uint32_t adler32(std::string_view data) {
  std::uint32_t a = 1, b = 0;
  for (const char c : data) {
    a = (a + static_cast<std::uint8_t>(c)) % 65521U;
    b = (b + a) % 65521U;
  }
  return b << 16 | a;
}

/// A zlib stream of stored blocks (RFC 1950, RFC 1951).
std::string stored(std::string_view data) {
  constexpr std::size_t kMost = 65535;
  std::string out("\x78\x01", 2);
  for (std::size_t at = 0; at == 0 || at < data.size(); at += kMost) {
    const std::string_view block = data.substr(at, kMost);
    const auto size = static_cast<std::uint32_t>(block.size());
    out += static_cast<char>(at + kMost >= data.size() ? 1 : 0);
    for (const std::uint32_t half : {size, ~size}) {
      out += static_cast<char>(half & 0xFFU);
      out += static_cast<char>(half >> 8 & 0xFFU);
    }
    out += block;
  }
  put_u32(out, adler32(data));
  return out;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::string_view group = bytes.substr(at, 3);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      bits = bits << 8 | (i < group.size() ? static_cast<std::uint8_t>(group[i]) : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      text += i <= group.size() ? kDigits[bits >> (18 - 6 * i) & 63U] : '=';
    }
  }
  return text;
}

std::string png_file(std::span<const std::uint8_t> pixels, std::size_t width,
                     std::span<const std::uint32_t> colours) {
  const std::size_t height = width > 0 ? pixels.size() / width : 0;
  std::string out("\x89PNG\r\n\x1A\n", 8);
  std::string head;
  put_u32(head, static_cast<std::uint32_t>(width));
  put_u32(head, static_cast<std::uint32_t>(height));
  head += std::string("\x04\x03\x00\x00\x00", 5);  // 4 bits, palette, no filter, no interlace
  put_chunk(out, "IHDR", head);
  std::string palette;
  for (const std::uint32_t colour : colours) {
    for (int shift = 16; shift >= 0; shift -= 8) {
      palette += static_cast<char>(colour >> shift & 0xFFU);
    }
  }
  put_chunk(out, "PLTE", palette);
  put_chunk(out, "tRNS", std::string(1, '\0'));
  std::string rows;
  for (std::size_t row = 0; row < height; ++row) {
    rows += '\0';  // no filter
    for (std::size_t column = 0; column < width; column += 2) {
      const std::size_t at = row * width + column;
      const unsigned second = column + 1 < width ? pixels[at + 1] & 15U : 0U;
      rows += static_cast<char>((pixels[at] & 15U) << 4 | second);
    }
  }
  put_chunk(out, "IDAT", stored(rows));
  put_chunk(out, "IEND", {});
  return out;
}

std::string picture_of(const PointCloud& cloud) {
  constexpr double kScale = static_cast<double>(kPicturePixels) / (2.0 * kPictureReachM);
  std::vector<std::uint8_t> pixels(kPicturePixels * kPicturePixels);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double x = double{cloud.x[i]}, y = double{cloud.y[i]}, z = double{cloud.z[i]};
    if (!(std::abs(x) < kPictureReachM && std::abs(y) < kPictureReachM) || !std::isfinite(z)) {
      continue;
    }
    const auto column = static_cast<std::size_t>((x + kPictureReachM) * kScale);
    const auto row = static_cast<std::size_t>((kPictureReachM - y) * kScale);
    const double height = std::clamp((z - kLowestM) / (kHighestM - kLowestM), 0.0, 1.0);
    const auto colour = static_cast<std::uint8_t>(1.0 + std::floor(14.0 * height + 0.5));
    for (const std::size_t at_row : {row, row + 1}) {  // two pixels wide, to be seen when shrunk
      for (const std::size_t at_column : {column, column + 1}) {
        if (at_row >= kPicturePixels || at_column >= kPicturePixels) continue;
        std::uint8_t& pixel = pixels[at_row * kPicturePixels + at_column];
        pixel = std::max(pixel, colour);  // what is highest is seen from above
      }
    }
  }
  return base64(png_file(pixels, kPicturePixels, kColours));
}

}  // namespace sweepcast::lab
