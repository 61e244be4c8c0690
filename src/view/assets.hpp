// The page's files, within the program.
#pragma once

#include <span>
#include <string_view>

namespace sweepcast::view {

struct Asset {
  std::string_view path;  ///< as in "/index.html"
  std::string_view type;  ///< its media type
  std::string_view bytes;
};

/// The files of viewer/dist as they were when this was built; empty where there were none. In a
/// file that cmake/Assets.cmake makes.
[[nodiscard]] std::span<const Asset> embedded_assets();

}  // namespace sweepcast::view
