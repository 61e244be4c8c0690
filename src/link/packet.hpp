// Packets: what one message of the transport carries, sealed. docs/format-link.md has the bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include "link/key.hpp"

namespace sweepcast::link {

inline constexpr std::size_t kMostPacketBytes =
    1316;                                           ///< fits the smallest usual MTUs, tunnels too
inline constexpr std::size_t kPacketHeadBytes = 9;  ///< type and counter
inline constexpr std::size_t kTagBytes = 16;
inline constexpr std::size_t kMostPlainBytes = kMostPacketBytes - kPacketHeadBytes - kTagBytes;

enum class PacketType : std::uint8_t {
  hello = 1,     ///< in the clear: a challenge
  fragment = 2,  ///< sealed; sender to receiver
  feedback = 3,  ///< sealed; receiver to sender
  report = 4,    ///< sealed; sender to receiver, see `SenderReport`
};

/// Why a packet was refused.
enum class PacketFault : std::uint8_t { none, truncated, oversized, malformed, forged, replayed };

/// The bytes of a hello.
[[nodiscard]] std::vector<std::byte> write_hello(const Challenge& challenge);
/// None where the packet is no hello of this version.
[[nodiscard]] std::optional<Challenge> read_hello(std::span<const std::byte> packet);

/// Which counters were seen, of the latest kSize; older ones count as seen.
class ReplayWindow {
 public:
  static constexpr std::uint64_t kSize = 4096;  ///< more than may be in flight at once

  [[nodiscard]] bool is_fresh(std::uint64_t counter) const;
  void mark(std::uint64_t counter);

 private:
  std::uint64_t highest_ = 0;
  std::array<std::uint64_t, kSize / 64> seen_{1};  ///< counters begin at 1: 0 is never fresh
};

/// Encrypts and authenticates packets of one direction: ChaCha20-Poly1305 (RFC 8439), the counter
/// being the nonce, type and counter authenticated too.
class PacketSealer {
 public:
  explicit PacketSealer(const LinkSecret& key) : key_(key) {}

  /// At most kMostPlainBytes. The packet stays valid until the next call.
  [[nodiscard]] std::span<const std::byte> seal(PacketType type, std::span<const std::byte> plain);

 private:
  LinkSecret key_;
  std::uint64_t counter_ = 0;
  std::vector<std::byte> packet_;
};

/// Checks and decrypts them.
class PacketOpener {
 public:
  /// Accepts packets of these types: those of its direction.
  PacketOpener(const LinkSecret& key, std::initializer_list<PacketType> types)
      : key_(key), types_(types) {}

  /// `plain` is valid until the next call; empty where there is a fault.
  [[nodiscard]] PacketFault open(std::span<const std::byte> packet,
                                 std::span<const std::byte>& plain);
  /// Of the packet that was opened last.
  [[nodiscard]] std::uint64_t counter() const { return counter_; }
  [[nodiscard]] PacketType type() const { return type_; }

 private:
  LinkSecret key_;
  std::vector<PacketType> types_;
  ReplayWindow window_;
  PacketType type_ = PacketType::hello;
  std::uint64_t counter_ = 0;
  std::vector<std::byte> plain_;
};

}  // namespace sweepcast::link
