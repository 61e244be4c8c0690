// What a link carries while it is busy, measured where packets arrive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "link/fragment.hpp"

namespace sweepcast::link {

/// A sender's packets come in trains, sent faster than the link is thought to carry; how far apart
/// they arrive tells what it carries. Counts the time in which packets had to wait for the link,
/// and the bytes that came in it. The first packet of a train may have found the link idle: of it
/// only the time that it took beyond the shortest one counts, where that is more than `kTrain`.
///
/// Clocks need not agree, and may drift. Where one of them jumps by more than `kJump`, measuring
/// begins anew; a smaller jump is forgotten within twice `kSpan`. A true delay beyond `kJump` is
/// taken for a jump until delays fall again, which costs no more than the time of one packet.
class ArrivalMeter {
 public:
  static constexpr Microseconds kTrain = 15'000;  ///< between two packets of one, at most
  static constexpr Microseconds kJump = 300'000;
  static constexpr Microseconds kSpan = 500'000;  ///< shortest delays: of the last one or two

  /// A packet of so many bytes. `counter` rises with each that is sent; `sent_us` is the sender's
  /// clock, `now` ours. One that comes late was held up or repeated, and tells nothing.
  void add(std::uint64_t counter, std::uint32_t sent_us, std::size_t bytes, Microseconds now);

  /// Modulo 2^32, since the beginning.
  [[nodiscard]] std::uint32_t busy_us() const { return static_cast<std::uint32_t>(busy_us_); }
  [[nodiscard]] std::uint32_t busy_bytes() const { return static_cast<std::uint32_t>(bytes_); }

 private:
  [[nodiscard]] Microseconds least() const;

  struct Packet {
    std::uint64_t counter = 0;
    std::uint32_t sent_us = 0;
    Microseconds arrived = 0;
  };
  std::optional<Packet> last_;
  std::uint32_t reference_us_ = 0;  ///< a delay that others are told apart from
  Microseconds least_now_ = 0, least_before_ = 0, span_began_ = 0;
  std::uint64_t busy_us_ = 0, bytes_ = 0;
};

}  // namespace sweepcast::link
