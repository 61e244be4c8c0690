// A sweep seen from above.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

inline constexpr std::size_t kPicturePixels = 480;  ///< width and height
inline constexpr double kPictureReachM = 40.0;      ///< from the sensor, in the middle, to the rim

/// Draws the points within reach, x to the right and y upward, coloured by height from 2.5 m below
/// the sensor to 2.5 m above, where there is none transparent. Returns a PNG file in base64.
[[nodiscard]] std::string picture_of(const PointCloud& cloud);

/// A PNG of 16 colours: `pixels` row by row, `width` a row, each a colour's number; colour 0 is
/// transparent. `colours` are red, green and blue. Stored without compression.
[[nodiscard]] std::string png_file(std::span<const std::uint8_t> pixels, std::size_t width,
                                   std::span<const std::uint32_t> colours);

[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace sweepcast::lab
