#include "replication/policy/bounded_latency.hpp"

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
}

}  // namespace peerd::replication::bounded_latency_test
