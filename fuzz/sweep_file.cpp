// Opens the input as a .sweep file: every entry must lie within it.
#include <algorithm>
#include <cstdlib>
#include <span>

#include "io/sweep_layout.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepcast;
  const auto file = std::as_bytes(std::span(data, size));
  const auto read = [&](std::uint64_t offset, std::span<std::byte> out) -> Status {
    if (offset > size || out.size() > size - offset) std::abort();  // reads past the end
    std::copy_n(file.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
    return {};
  };
  const auto contents = scan_sweep(read, size, "input");
  if (!contents) return 0;
  std::uint64_t end = kSweepHeadSize;
  for (const SweepEntry& entry : contents->entries) {
    if (entry.offset != end + kRecordHeadSize + entry.name.size()) std::abort();
    end = entry.offset + entry.size;
  }
  if (end != contents->records_end || end > size) std::abort();
  return 0;
}
