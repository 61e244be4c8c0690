#include "link/packet.hpp"

#include <sodium.h>

#include <algorithm>

#include "core/bytes.hpp"

namespace sweepcast::link {
namespace {

static_assert(kTagBytes == crypto_aead_chacha20poly1305_IETF_ABYTES);
static_assert(std::tuple_size_v<LinkSecret> == crypto_aead_chacha20poly1305_IETF_KEYBYTES);

constexpr std::uint8_t kVersion = 1;

using Nonce = std::array<std::uint8_t, crypto_aead_chacha20poly1305_IETF_NPUBBYTES>;

/// Four zero bytes, then the counter as in the packet.
Nonce nonce_of(std::uint64_t counter) {
  Nonce nonce{};
  for (std::size_t i = 0; i < sizeof(counter); ++i) {
    nonce[4 + i] = static_cast<std::uint8_t>(counter >> (8 * i));
  }
  return nonce;
}

const unsigned char* raw(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

unsigned char* raw(std::span<std::byte> bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}

}  // namespace

std::vector<std::byte> write_hello(const Challenge& challenge) {
  std::vector<std::byte> packet;
  ByteWriter out(packet);
  out.put(static_cast<std::uint8_t>(PacketType::hello));
  out.put(kVersion);
  for (const std::uint8_t byte : challenge) out.put(byte);
  return packet;
}

std::optional<Challenge> read_hello(std::span<const std::byte> packet) {
  ByteReader in(packet);
  const auto type = in.get<std::uint8_t>();
  const auto version = in.get<std::uint8_t>();
  Challenge challenge{};
  for (std::uint8_t& byte : challenge) byte = in.get<std::uint8_t>();
  if (!in.ok() || !in.at_end() || version != kVersion) return std::nullopt;
  if (type != static_cast<std::uint8_t>(PacketType::hello)) return std::nullopt;
  return challenge;
}

bool ReplayWindow::is_fresh(std::uint64_t counter) const {
  if (counter > highest_) return true;
  if (highest_ - counter >= kSize) return false;
  const std::uint64_t bit = counter % kSize;
  return (seen_[bit / 64] >> (bit % 64) & 1) == 0;
}

void ReplayWindow::mark(std::uint64_t counter) {
  if (counter > highest_) {
    if (counter - highest_ >= kSize) {
      seen_.fill(0);
    } else {
      for (std::uint64_t c = highest_ + 1; c < counter; ++c) {
        seen_[c % kSize / 64] &= ~(std::uint64_t{1} << (c % 64));
      }
    }
    highest_ = counter;
  }
  seen_[counter % kSize / 64] |= std::uint64_t{1} << (counter % 64);
}

std::span<const std::byte> PacketSealer::seal(PacketType type, std::span<const std::byte> plain) {
  ++counter_;
  packet_.clear();
  ByteWriter out(packet_);
  out.put(static_cast<std::uint8_t>(type));
  out.put(counter_);
  packet_.resize(kPacketHeadBytes + plain.size() + kTagBytes);
  const auto sealed = std::span(packet_).subspan(kPacketHeadBytes);
  crypto_aead_chacha20poly1305_ietf_encrypt(
      raw(sealed), nullptr, raw(plain), plain.size(), raw(std::span<const std::byte>(packet_)),
      kPacketHeadBytes, nullptr, nonce_of(counter_).data(), key_.data());
  return packet_;
}

PacketFault PacketOpener::open(std::span<const std::byte> packet,
                               std::span<const std::byte>& plain) {
  plain = {};
  if (packet.size() < kPacketHeadBytes + kTagBytes) return PacketFault::truncated;
  if (packet.size() > kMostPacketBytes) return PacketFault::oversized;
  ByteReader in(packet);
  const auto type = static_cast<PacketType>(in.get<std::uint8_t>());
  if (std::find(types_.begin(), types_.end(), type) == types_.end()) return PacketFault::malformed;
  const auto counter = in.get<std::uint64_t>();
  if (!window_.is_fresh(counter)) return PacketFault::replayed;
  const auto sealed = packet.subspan(kPacketHeadBytes);
  plain_.resize(sealed.size() - kTagBytes);
  if (crypto_aead_chacha20poly1305_ietf_decrypt(
          raw(std::span(plain_)), nullptr, nullptr, raw(sealed), sealed.size(), raw(packet),
          kPacketHeadBytes, nonce_of(counter).data(), key_.data()) != 0) {
    return PacketFault::forged;
  }
  counter_ = counter;
  type_ = type;
  window_.mark(counter);  // only now: a forged packet must not shut out a true one
  plain = plain_;
  return PacketFault::none;
}

}  // namespace sweepcast::link
