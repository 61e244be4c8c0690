// The files of tests/view/page, put into this program as those of the real page are into the tool.
#include "view/assets.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace sweepcast::test {
namespace {

TEST(Assets, AreTheFilesToTheByte) {
  const auto assets = view::embedded_assets();
  ASSERT_EQ(assets.size(), 3U);
  for (const view::Asset& asset : assets) {
    std::ifstream file(SWEEPCAST_PAGE + std::string(asset.path), std::ios::binary);
    ASSERT_TRUE(file) << asset.path;
    EXPECT_EQ(asset.bytes, std::string(std::istreambuf_iterator<char>(file), {})) << asset.path;
    EXPECT_FALSE(asset.bytes.empty());
  }
}

TEST(Assets, HaveTheirMediaTypes) {
  for (const view::Asset& asset : view::embedded_assets()) {
    const std::string_view type = asset.path == "/index.html" ? "text/html; charset=utf-8"
                                  : asset.path.ends_with(".wasm")
                                      ? "application/wasm"
                                      : "text/javascript; charset=utf-8";
    EXPECT_EQ(asset.type, type) << asset.path;
  }
}

}  // namespace
}  // namespace sweepcast::test
