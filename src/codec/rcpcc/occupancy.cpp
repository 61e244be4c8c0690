#include "codec/rcpcc/occupancy.hpp"

#include <algorithm>

#include "codec/rcpcc/symbols.hpp"

namespace sweepcast::rcpcc {

void write_occupancy(std::span<const std::int32_t> range_mm, ByteWriter& out) {
  bool occupied = false;
  std::uint32_t run = 0;
  for (const std::int32_t range : range_mm) {
    if ((range != 0) != occupied) {
      put_count(out, run);
      run = 0;
      occupied = !occupied;
    }
    ++run;
  }
  put_count(out, run);
}

bool read_occupancy(ByteReader& in, std::span<std::int32_t> range_mm) {
  bool occupied = false;
  std::size_t at = 0;
  while (at < range_mm.size()) {
    const std::size_t run = get_count(in);
    if (!in.ok() || run > range_mm.size() - at) return false;
    std::fill_n(range_mm.begin() + static_cast<std::ptrdiff_t>(at), run, occupied ? 1 : 0);
    at += run;
    occupied = !occupied;
  }
  return true;
}

}  // namespace sweepcast::rcpcc
