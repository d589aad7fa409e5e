#include "replication/session/presence.hpp"

#include <gtest/gtest.h>

#include "replication/wire/operation.hpp"

namespace peerd::replication::presence_test {

SimTime at(double s) { return SimTime{from_seconds(s)}; }

TEST(Presence, BeginsWhereAPeerEnters) {
  Presence presence;
  presence.begin(at(10.0));
  EXPECT_FALSE(presence.was_there(at(9.999)));
  EXPECT_TRUE(presence.was_there(at(10.0)));
  EXPECT_TRUE(presence.was_there(at(1e6)));
}

// Chaos seed 20316: a message was under way when the session's time went ahead by 7 s, and was for nobody then, not
// even for its sender.
TEST(Presence, LastsWhereTheSessionsTimeStepsAhead) {
  Presence presence;
  presence.begin(at(26.0));
  presence.move(at(31.6), at(38.7));
  EXPECT_EQ(presence.since(), at(33.1));
  EXPECT_TRUE(presence.was_there(at(29.0))) << "by the time of then";
  EXPECT_TRUE(presence.was_there(at(33.2))) << "by the time of now";
  EXPECT_FALSE(presence.was_there(at(25.9)));
}

TEST(Presence, EndsNotWithASessionThatWasMuchLater) {
  Presence presence;
  presence.begin(at(5'000.0));
  presence.move(at(5'010.0), at(100.0));
  EXPECT_EQ(presence.since(), at(90.0));
  EXPECT_TRUE(presence.was_there(at(95.0)));
  EXPECT_FALSE(presence.was_there(at(89.0)));
  EXPECT_TRUE(presence.was_there(at(5'005.0)));
}

TEST(Presence, ForgetsStaysOfSessionsLongAgo) {
  Presence presence;
  presence.begin(at(0.0));
  for (int i = 0; i < 20; ++i) presence.move(at(100.0 * i + 1.0), at(100.0 * i + 100.0));
  EXPECT_FALSE(presence.was_there(at(0.5)));
  EXPECT_TRUE(presence.was_there(at(1'900.5)));
  presence.begin(at(5'000.0));
  EXPECT_FALSE(presence.was_there(at(1'900.5))) << "another life";
}

}  // namespace peerd::replication::presence_test
