#include "lab/peers/mask_coder.hpp"

#include <algorithm>
#include <array>

#include "codec/entropy/range_coder.hpp"

namespace sweepcast::lab {
namespace {

/// The chance of a 1, from a fast and a slow running mean.
struct Chance {
  std::uint16_t fast = 32768, slow = 32768;

  [[nodiscard]] std::uint32_t p1() const {
    return std::clamp((std::uint32_t{fast} + slow) / 2, 16U, 65520U);
  }
  void learn(bool bit) {
    const int goal = bit ? 65535 : 0;
    fast = static_cast<std::uint16_t>(fast + (goal - fast) / 16);
    slow = static_cast<std::uint16_t>(slow + (goal - slow) / 128);
  }
};

/// The rows around a cell, with margins of zeros.
class Window {
 public:
  explicit Window(std::size_t columns) {
    for (auto& row : rows_) row.assign(columns + 2 * kMargin, 0);
  }

  /// Four cells of this row, three of each of the two above it.
  [[nodiscard]] std::size_t context(std::size_t column) const {
    const std::uint8_t* here = rows_[0].data() + column + kMargin;
    const std::uint8_t* above = rows_[1].data() + column + kMargin;
    const std::uint8_t* higher = rows_[2].data() + column + kMargin;
    std::size_t context = 0;
    for (const std::uint8_t cell : {here[-1], here[-2], here[-3], here[-4], above[-1], above[0],
                                    above[1], higher[-1], higher[0], higher[1]}) {
      context = 2 * context + cell;
    }
    return context;
  }
  void set(std::size_t column, bool bit) { rows_[0][column + kMargin] = bit ? 1 : 0; }
  void next_row() {
    std::rotate(rows_.begin(), rows_.end() - 1, rows_.end());
    std::fill(rows_[0].begin(), rows_[0].end(), std::uint8_t{0});
  }

 private:
  static constexpr std::size_t kMargin = 4;
  std::array<std::vector<std::uint8_t>, 3> rows_;
};

/// Codes a mask in either direction, row by row; `bit_of(i)` is what the encoder codes. Stops early
/// where damaged bytes have ended.
template <class Coder, class BitOf, class Take>
bool code_mask(Coder& coder, std::size_t columns, std::size_t count, BitOf bit_of, Take take) {
  std::vector<Chance> chances(1024);
  Window window(columns);
  for (std::size_t begin = 0; begin < count; begin += columns) {
    if (ran_dry(coder)) return false;
    window.next_row();
    for (std::size_t column = 0; column < columns; ++column) {
      Chance& chance = chances[window.context(column)];
      const bool bit = coder.code(bit_of(begin + column), chance.p1());
      chance.learn(bit);
      window.set(column, bit);
      take(begin + column, bit);
    }
  }
  return !ran_dry(coder);
}

}  // namespace

void encode_mask(std::span<const std::uint16_t> cells, std::size_t columns,
                 std::vector<std::byte>& out) {
  RangeEncoder coder(out);
  code_mask(
      coder, columns, cells.size(), [&](std::size_t i) { return cells[i] != 0; },
      [](std::size_t, bool) {});
  coder.finish();
}

bool decode_mask(std::span<const std::byte> bytes, std::size_t columns,
                 std::span<std::uint8_t> cells) {
  RangeDecoder coder(bytes);
  return code_mask(
      coder, columns, cells.size(), [](std::size_t) { return false; },
      [&](std::size_t i, bool bit) { cells[i] = bit ? 1 : 0; });
}

}  // namespace sweepcast::lab
