// A receiver's side of one connection, without its socket: packets in, sweeps and reports out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "link/arrival_meter.hpp"
#include "link/feedback.hpp"
#include "link/packet.hpp"
#include "link/reassembly.hpp"

namespace sweepcast::link {

/// A sweep, ready to be handed out.
struct ArrivedSweep {
  SweepLabel label;
  std::vector<std::byte> frame;  ///< whole, with its sensor's model
  int layers = 0;
  int layers_made = 0;
};

/// What came, since it was last asked.
struct PeerCounts {
  std::uint64_t whole = 0, cut = 0, missed = 0;
  std::uint64_t packets = 0, bytes = 0;
  std::uint64_t forged = 0, replayed = 0, malformed = 0, late = 0, over_limit = 0;
};

class Peer {
 public:
  Peer(const LinkKey& key, std::size_t most_bytes, MemoryBudget& shared, Microseconds now);

  [[nodiscard]] const std::string& robot() const { return key_.robot; }
  [[nodiscard]] const Challenge& challenge() const { return challenge_; }
  [[nodiscard]] Microseconds began() const { return began_; }
  /// Whether a packet came that only the key's owner can make.
  [[nodiscard]] bool is_authentic() const { return authentic_; }

  /// Takes a packet, whatever it is. What is not sound is counted and left.
  void take(std::span<const std::byte> packet, Microseconds now);
  /// Ends the sweeps whose deadline is over.
  void expire(Microseconds now);

  /// The sweeps that arrived since the last call.
  [[nodiscard]] std::vector<ArrivedSweep> take_arrived();
  [[nodiscard]] PeerCounts take_counts();
  /// The newest of the sender's own reports, if one came since the last call.
  [[nodiscard]] std::optional<SenderReport> take_sender_report();
  /// The packet to send now; empty where the next report is not yet due. It carries the wish where
  /// the sender has said that it obeys.
  [[nodiscard]] std::span<const std::byte> report(Microseconds now, LevelWish wish = {});

  /// Tells the transport's round trip; the least one counts.
  void set_round_trip(double seconds);
  /// Seconds since capture, see `ReceivedSweep::age_s`.
  [[nodiscard]] double age_of(const ArrivedSweep& sweep, Microseconds now) const;

 private:
  void take_sender_report(std::span<const std::byte> plain);
  void take_fragment(const Fragment& fragment, std::size_t packet_bytes, Microseconds now);
  void finish(std::vector<ReadySweep>& ready);
  [[nodiscard]] bool restore_frame(const ReadySweep& ready, ArrivedSweep& sweep);

  struct Stream {
    std::vector<std::byte> model;
    StreamReport report;
  };

  LinkKey key_;
  Challenge challenge_;
  Microseconds began_;
  bool authentic_ = false;
  std::optional<PacketOpener> opener_;
  std::optional<PacketSealer> sealer_;
  Reassembler reassembler_;
  std::array<Stream, kMostStreams> streams_;
  std::vector<ReadySweep> ready_;
  std::vector<ArrivedSweep> arrived_;
  PeerCounts counts_;
  Report report_;
  std::optional<SenderReport> sender_report_;  ///< since it was last asked
  std::uint32_t sender_reports_ = 0;           ///< number of the newest
  bool obeys_ = false;
  ArrivalMeter meter_;
  Microseconds reported_ = 0;
  Microseconds newest_at_ = 0;  ///< when the newest fragment arrived
  std::vector<std::byte> plain_;
  std::optional<std::uint32_t> least_delay_us_;  ///< since the connection began
  double least_round_trip_s_ = 1.0;
};

}  // namespace sweepcast::link
