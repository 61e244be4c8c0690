#include "lab/evaluate/settings.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "lab/evaluate/aimed_beam.hpp"
#include "lab/peers/registry.hpp"
#include "lab/peers/sweepcast_codec.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/ladder.hpp"

namespace sweepcast::lab {
namespace {

/// A sweep as it is.
class UncodedDrive : public Peer {
 public:
  UncodedDrive() : Peer(std::string(kOriginal), "") {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    cloud_ = &cloud;
    bytes_.resize(kBytesAPoint * cloud.size());
    return std::span<const std::byte>(bytes_);
  }

  Status decode(std::span<const std::byte> /*bytes*/, PointCloud& cloud) override {
    cloud.clear();
    cloud.x = cloud_->x;
    cloud.y = cloud_->y;
    cloud.z = cloud_->z;
    return {};
  }

 private:
  const PointCloud* cloud_ = nullptr;
  std::vector<std::byte> bytes_;
};

/// From this ratio on beam leaves points out, as a rule, which a decoder may fill in.
constexpr double kThinned = 100.0;

Status add_beam(const DriveFiles& drive, const std::vector<double>& ratios, SettingChoice& choice) {
  PointCloud first;
  if (Status read = read_cloud(drive.sweeps.front(), first); !read) return read;
  EncoderOptions finest;
  finest.codec = CodecId::beam;
  finest.beam.max_error_m = kFinestErrorM;
  auto peer_at_bound = make_sweepcast_peer(finest, fmt::format("E {} m", kFinestErrorM));
  if (!peer_at_bound) return tl::unexpected(std::move(peer_at_bound.error()));
  choice.peers.push_back(std::move(*peer_at_bound));
  for (const bool fill : {false, true}) {
    for (const double ratio : ratios) {
      if (fill && ratio < kThinned) continue;
      auto peer = make_aimed_beam(ratio, first, drive.sweeps.size(), fill);
      if (peer) {
        choice.peers.push_back(std::move(*peer));
      } else if (!fill) {
        choice.left_out.push_back(std::move(peer.error().message));
      }
    }
  }
  return {};
}

Status add_rcpcc(SettingChoice& choice) {
  for (std::size_t level = 0; level < kRcpccLevels.size(); ++level) {
    EncoderOptions options;
    options.codec = CodecId::rcpcc;
    options.rcpcc.params = kRcpccLevels.at(level);
    auto peer = make_sweepcast_peer(options, fmt::format("L{}", level));
    if (!peer) return tl::unexpected(std::move(peer.error()));
    choice.peers.push_back(std::move(*peer));
  }
  return {};
}

/// Moves `most` peers of a ladder, its ends among them, evenly spread.
void take_spread(Peers::iterator begin, Peers::iterator end, std::size_t most, Peers& taken) {
  const auto count = static_cast<std::size_t>(end - begin);
  if (most < 2 || most >= count) {
    std::move(begin, end, std::back_inserter(taken));
    return;
  }
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t rung = (i * (count - 1) + (most - 1) / 2) / (most - 1);
    taken.push_back(std::move(begin[static_cast<std::ptrdiff_t>(rung)]));
  }
}

Status add_peers(const SettingOptions& options, SettingChoice& choice) {
  auto found = make_peers(options.peers);
  if (!found) return tl::unexpected(std::move(found.error()));
  std::move(found->left_out.begin(), found->left_out.end(), std::back_inserter(choice.left_out));
  for (auto begin = found->peers.begin(); begin != found->peers.end();) {
    const std::string codec = (*begin)->codec();
    const auto end = std::find_if(begin, found->peers.end(),
                                  [&](const auto& peer) { return peer->codec() != codec; });
    take_spread(begin, end, options.settings_each, choice.peers);
    begin = end;
  }
  return {};
}

}  // namespace

Result<SettingChoice> make_settings(const SettingOptions& options, const DriveFiles& drive) {
  SettingChoice choice;
  choice.peers.push_back(std::make_unique<UncodedDrive>());
  for (const std::string& codec : options.codecs) {
    Status added;
    if (codec == "beam") {
      added = add_beam(drive, options.ratios, choice);
    } else if (codec == "rcpcc") {
      added = add_rcpcc(choice);
    } else {
      added = fail(ErrorCode::invalid_argument, codec + ": no such codec; give beam or rcpcc");
    }
    if (!added) return tl::unexpected(std::move(added.error()));
  }
  if (Status added = add_peers(options, choice); !added) {
    return tl::unexpected(std::move(added.error()));
  }
  return choice;
}

}  // namespace sweepcast::lab
