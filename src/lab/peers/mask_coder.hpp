// Which cells of a range image hold a point: arithmetic coding with the ten nearest cells as
// context, as coders of two-coloured pictures do (ITU-T T.82 describes such a template).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::lab {

/// Appends the mask of `cells`, rows of `columns` (at least 1): whether each is above 0.
void encode_mask(std::span<const std::uint16_t> cells, std::size_t columns,
                 std::vector<std::byte>& out);

/// The inverse: 1 or 0 for each of `cells`, whole rows. False where the bytes end too early.
[[nodiscard]] bool decode_mask(std::span<const std::byte> bytes, std::size_t columns,
                               std::span<std::uint8_t> cells);

}  // namespace sweepcast::lab
