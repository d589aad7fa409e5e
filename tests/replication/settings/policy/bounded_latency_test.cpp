#include "replication/settings/policy/bounded_latency.hpp"

#include <gtest/gtest.h>

namespace peerd::replication::bounded_latency_test {

using namespace std::chrono_literals;

TEST(BoundedLatency, PeersWithAnotherBoundAreOfAnotherSession) {
  EXPECT_EQ((BoundedLatency{}.session_hash(77)), 77u) << "as ever";
  EXPECT_FALSE(BoundedLatency{}.is_on());
  const BoundedLatency fixed{120ms, false}, longer{121ms, false}, measured{120ms, true}, free{0ms, true};
  EXPECT_TRUE(fixed.is_on() && measured.is_on() && free.is_on());
  EXPECT_EQ(fixed.session_hash(77), fixed.session_hash(77));
  EXPECT_NE(fixed.session_hash(77), 77u);
  EXPECT_NE(fixed.session_hash(77), fixed.session_hash(78));
  EXPECT_NE(fixed.session_hash(77), longer.session_hash(77));
  EXPECT_NE(fixed.session_hash(77), measured.session_hash(77));
  EXPECT_NE(free.session_hash(77), measured.session_hash(77));
  const BoundedLatency slow_fixed{120ms, false, 30}, slow_measured{120ms, true, 30};
  EXPECT_EQ(slow_fixed.session_hash(77), fixed.session_hash(77)) << "their ticks do not matter";
  EXPECT_NE(slow_measured.session_hash(77), measured.session_hash(77));
}

TEST(BoundedLatency, AMeasuredBoundHasRoomForTwoTicks) {
  EXPECT_EQ(BoundedLatency{}.margin(), 35ms);
  EXPECT_EQ((BoundedLatency{0ms, true, 30}.margin()), 70ms);
  EXPECT_EQ((BoundedLatency{0ms, true, 1000}.margin()), 2100us);
}

}  // namespace peerd::replication::bounded_latency_test
