// The short forms of bench/soak.
#include <gtest/gtest.h>

#include "apps/tool_fixture.hpp"

namespace sweepcast::test {
namespace {

class Soak : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    make_recording(3);
  }
};

TEST_F(Soak, StreamingComesBackAfterFaults) {
  const Outcome outcome = shell("SWEEPCAST_BIN=$(dirname \"$SWEEPCAST\") '" SWEEPCAST_SOURCE
                                "/bench/soak/faults' --short room.sweep");
  EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
  for (const char* fault :
       {"receiver killed: streaming", "sender killed: streaming", "link cut for 2 s: streaming",
        "0 of 50 strangers were let in", "disk full: streaming", "sweeps decode"}) {
    EXPECT_NE(outcome.out.find(fault), std::string::npos) << fault << "\n" << outcome.out;
  }
}

TEST_F(Soak, SweepsArriveOverABadLink) {
  const Outcome outcome = shell("'" SWEEPCAST_SOURCE "/bench/soak/link' --short room.sweep");
  EXPECT_EQ(outcome.exit_status, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("dropped before they left"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace sweepcast::test
