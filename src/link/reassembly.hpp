// Sweeps put together again from fragments, in bounded memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "link/fragment.hpp"

namespace sweepcast::link {

/// Bytes that all reassemblers of a receiver may hold together.
struct MemoryBudget {
  std::size_t limit = 0;
  std::size_t used = 0;
};

/// The longest whole prefix of a sweep's layers.
struct ReadySweep {
  std::uint8_t stream = 0;
  std::uint32_t sweep = 0;
  int layers = 0;  ///< whole ones; 0: not even the first arrived in time
  int layers_made = 0;
  std::vector<std::byte> bytes;  ///< label and frame, cut behind the last whole layer
};

/// What became of a fragment.
enum class FragmentFate : std::uint8_t {
  taken,
  repeated,    ///< it was there already
  late,        ///< its sweep, or a newer one of the stream, is over
  over_limit,  ///< it would exceed the memory allowed
  malformed,   ///< it contradicts those before it
};

/// Puts the sweeps of one connection together. A stream's sweeps come out in order: one is over
/// when it is whole, when its deadline passes, or when a newer one is whole. One of which a part of
/// the first layer is missing then may still be repaired: the newer one waits `kRepair` for it.
class Reassembler {
 public:
  /// A lost packet takes about a round trip until it is there again. On slow links that is longer
  /// than from a sweep's end to the next one's, so that without waiting every lost packet of a
  /// first layer would cost the sweep.
  static constexpr Microseconds kRepair = 60'000;
  static constexpr std::size_t kMostOpen =
      8;  ///< sweeps of a stream at a time; then the oldest ends

  /// `shared` must outlive this object.
  Reassembler(std::size_t limit, MemoryBudget& shared) : limit_(limit), shared_(shared) {}
  Reassembler(const Reassembler&) = delete;
  Reassembler& operator=(const Reassembler&) = delete;
  ~Reassembler();

  /// Takes a fragment that arrived at `now`; what it completes is appended to `ready`.
  FragmentFate add(const Fragment& fragment, Microseconds now, std::vector<ReadySweep>& ready);

  /// Ends the sweeps whose deadline is over.
  void expire(Microseconds now, std::vector<ReadySweep>& ready);

  /// Bytes that are held.
  [[nodiscard]] std::size_t used() const { return used_; }

 private:
  struct Layer {
    std::vector<std::byte> bytes;
    std::vector<bool> has;  ///< which fragments
    std::size_t missing = 0;

    [[nodiscard]] bool is_whole() const { return !has.empty() && missing == 0; }
  };
  struct Sweep {
    std::vector<Layer> layers;
    Microseconds deadline = 0;

    [[nodiscard]] bool is_whole() const;
  };
  struct Stream {
    std::map<std::uint32_t, Sweep> open;
    std::uint32_t last_over = 0;
  };

  [[nodiscard]] bool reserve(std::size_t bytes);
  void end_what_is_over(std::uint8_t number, Microseconds now, std::vector<ReadySweep>& ready);
  void end_until(std::uint8_t number, std::uint32_t sweep, std::vector<ReadySweep>& ready);

  std::size_t limit_;
  MemoryBudget& shared_;
  std::size_t used_ = 0;
  std::array<Stream, kMostStreams> streams_;
};

}  // namespace sweepcast::link
