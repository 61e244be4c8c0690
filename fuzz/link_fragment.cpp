// Everything behind authentication: the input is a series of opened packets, a length byte and a
// byte before each. What comes out must keep within its memory, and decode or be refused.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "link/feedback.hpp"
#include "link/reassembly.hpp"
#include "link/sender_report.hpp"
#include "sweepcast/decoder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepcast;
  using namespace sweepcast::link;
  constexpr std::size_t kLimit = std::size_t{1} << 20;
  MemoryBudget memory{kLimit, 0};
  std::vector<ReadySweep> ready;
  {
    Reassembler reassembler(kLimit, memory);
    auto rest = std::as_bytes(std::span(data, size));
    for (Microseconds now = 0; rest.size() >= 2; now += 1000) {
      const std::size_t length =
          std::to_integer<std::size_t>(rest[0]) + 256 * (std::to_integer<std::size_t>(rest[1]) % 8);
      rest = rest.subspan(2);
      const auto plain = rest.first(std::min(length, rest.size()));
      rest = rest.subspan(plain.size());
      (void)read_report(plain);
      if (const auto told = read_sender_report(plain)) {
        std::vector<std::byte> again;
        write_sender_report(told->number, told->report, again);
        if (!read_sender_report(again)) std::abort();
      }
      if (const auto fragment = read_fragment(plain)) {
        (void)reassembler.add(*fragment, now, ready);
      }
      reassembler.expire(now, ready);
      if (memory.used > kLimit || memory.used != reassembler.used()) std::abort();
    }
  }
  if (memory.used != 0) std::abort();
  for (const ReadySweep& sweep : ready) {
    std::span<const std::byte> frame;
    if (sweep.layers == 0 || !read_label(sweep.bytes, frame)) continue;
    PointCloud cloud;
    (void)Decoder({std::size_t{1} << 16}).decode(frame, cloud);
  }
  return 0;
}
