// What the fuzz targets of the cloud formats share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "io/formats.hpp"

namespace sweepcast::fuzz {

using Parse = Status (*)(std::span<const std::byte>, PointCloud&);
using Serialize = void (*)(const PointCloud&, CloudEncoding, std::vector<std::byte>&);

inline void require(bool holds) {
  if (!holds) std::abort();
}

/// Parses the input. Where it is a cloud, its columns must fit, and what is written of it must be
/// read with as many points.
inline int check_cloud(const std::uint8_t* data, std::size_t size, Parse parse,
                       Serialize serialize) {
  PointCloud cloud;
  const Status status = parse(std::as_bytes(std::span(data, size)), cloud);
  require(status.has_value() || !status.error().message.empty());
  if (!status) return 0;
  const auto fits = [&](std::size_t column) { return column == 0 || column == cloud.size(); };
  require(cloud.y.size() == cloud.size() && cloud.z.size() == cloud.size());
  require(fits(cloud.intensity.size()) && fits(cloud.ring.size()) && fits(cloud.time_ns.size()));

  std::vector<std::byte> written;
  PointCloud again;
  serialize(cloud, CloudEncoding::binary, written);
  require(parse(written, again).has_value() && again.size() == cloud.size());
  return 0;
}

}  // namespace sweepcast::fuzz
