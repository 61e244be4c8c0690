// A codec as the benchmark sees it. Adding one is a file beside this that implements `Peer` and a
// function that makes its ladder of settings, which a line in registry.cpp names.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/stages.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Of a point as it comes in, uncoded: x, y, z and intensity as float32. Ratios refer to it.
inline constexpr std::size_t kBytesAPoint = 16;

/// A codec at one setting. What `encode` and `decode` do is what the benchmark times, so both do
/// what a user of the codec would have to do, no less and no more. Whatever comes in, decoded
/// points are finite; points that a codec cannot represent are missing among them. Damaged bytes
/// give an error or another cloud, nothing worse.
class Peer {
 public:
  Peer(std::string codec, std::string setting)
      : codec_(std::move(codec)), setting_(std::move(setting)) {}
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  [[nodiscard]] const std::string& codec() const { return codec_; }      ///< as in "rcpcc"
  [[nodiscard]] const std::string& setting() const { return setting_; }  ///< as in "L0"

  /// Encodes the coordinates of a sweep. The bytes stay valid until the next call.
  [[nodiscard]] virtual Result<std::span<const std::byte>> encode(const PointCloud& cloud) = 0;

  /// Decodes what `encode` gave into `cloud`, whose memory is reused.
  [[nodiscard]] virtual Status decode(std::span<const std::byte> bytes, PointCloud& cloud) = 0;

  /// CPU time of other programs that the last call ran and waited for, milliseconds.
  [[nodiscard]] virtual double child_ms() const { return 0.0; }

  /// What the stages of all calls since `forget_stages` took; empty where the codec does not tell.
  [[nodiscard]] virtual std::span<const StageTime> encode_stages() const { return {}; }
  [[nodiscard]] virtual std::span<const StageTime> decode_stages() const { return {}; }
  virtual void forget_stages() {}

 private:
  std::string codec_;
  std::string setting_;
};

using Peers = std::vector<std::unique_ptr<Peer>>;

/// The peers that `make` gives of each rung, in order. Errors: the first of `make`'s.
template <class Rungs, class Make>
[[nodiscard]] Result<Peers> make_ladder(const Rungs& rungs, const Make& make) {
  Peers peers;
  for (const auto& rung : rungs) {
    Result<std::unique_ptr<Peer>> peer = make(rung);
    if (!peer) return tl::unexpected(peer.error());
    peers.push_back(std::move(*peer));
  }
  return peers;
}

}  // namespace sweepcast::lab
