// What the tool leaves behind where a signal ends it.
#include <gtest/gtest.h>

#include <csignal>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

using Names = std::vector<std::string>;

class Interruption : public ToolTest {
 protected:
  /// A recording, and a folder of sweeps that takes longer to encode than we take to look.
  void SetUp() override {
    ToolTest::SetUp();
    make_recording(1);
    std::filesystem::create_directory(path("many"));
    for (int i = 0; i < 3000; ++i) {
      std::filesystem::create_symlink("../sweeps/000000.bin",
                                      path("many/" + std::to_string(i) + ".bin"));
    }
  }
};

TEST_F(Interruption, KeepsTheOldFileAndNoOther) {
  const std::string before = read("room.sweep");
  const auto begun = [&] { return list(".").size() > 3; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EQ(interrupt({"encode", "many", "-o", "room.sweep"}, signal, begun), signal);
    EXPECT_EQ(list("."), (Names{"many", "room.sweep", "sweeps"}));
    EXPECT_EQ(read("room.sweep"), before);
  }
}

TEST_F(Interruption, ShowsInAShellsStatus) {
  const Outcome outcome = shell(
      "\"$SWEEPCAST\" encode many -o x.sweep & "
      "until [ -e x.sweep ] || ls .x.sweep.*.tmp >&2; do :; done; kill -TERM $!; wait $!; echo $?");
  EXPECT_EQ(outcome.out, "143\n");
  EXPECT_EQ(list("."), (Names{"many", "room.sweep", "sweeps"}));
}

}  // namespace
}  // namespace sweepcast::test
