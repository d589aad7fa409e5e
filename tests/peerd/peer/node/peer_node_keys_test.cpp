// Keys that are pressed at one peer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/peer/node/lone_peer.hpp"

namespace peerd::peer_node_keys_test {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { velocityVector 1 0 0 children Shape { geometry Box { } } }
Transform { rotation 0 1 0 1.5707963 scale 2 2 2 children DEF TURNED Transform { children Shape { geometry Box { } } } }
DEF DRIVEN Transform { children Shape { geometry Box { } } }
DEF FREE Transform { children Shape { geometry Box { } } }
DEF MORE KeySensor { recipient "A" keyValue 65 value 2 0 0 consume FALSE }
KeySensor { recipient "DRIVEN" keyValue 65 value 2 0 0 consume FALSE }
DEF SET KeySensor { recipient "A" keyValue 66 value 0 5 0 absoluteValue TRUE }
DEF NEVER KeySensor { recipient "A" keyValue 66 value 0 100 0 }
DEF TURN KeySensor { recipient "TURNED" keyValue 67 value 0 0 1 }
DEF TABLE Transform { children DEF ON_TABLE Transform { children Shape { geometry Box { } } } }
CollisionInterest { objectPath "TABLE/ON_TABLE" interests "FREE" }
DEF CLOCK TimeSensor { loop TRUE startTime 0 cycleInterval 4 }
DEF HALF_TURN OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 3.14159 ] }
ROUTE CLOCK.fraction_changed TO HALF_TURN.set_fraction
ROUTE HALF_TURN.value_changed TO TABLE.rotation
DEF PUSH KeySensor { recipient "ON_TABLE" keyValue 71 value 0 0 1 absoluteValue TRUE }
DEF LOOSE KeySensor { recipient "FREE" keyValue 68 value 0 0 1 }
DEF WARP KeySensor { recipient "A" keyValue 69 value 6e5 0 0 }
DEF FAR KeySensor { recipient "A" keyValue 70 value 3e38 0 0 absoluteValue TRUE }
)";
constexpr KeyEvent kA{'A', 0}, kB{'B', 0}, kC{'C', 0}, kD{'D', 0};

class PeerNodeKeys : public testing::Test, public testing_support::LonePeer {
 protected:
  PeerNodeKeys() : LonePeer(kWorld, {"A", "TURNED", "DRIVEN"}) {}
};

TEST_F(PeerNodeKeys, AValueIsAddedOrSet) {
  make();
  run(1);
  const KeyReport a = node->on_key(now, kA);
  EXPECT_EQ(a.hits, 2u);
  EXPECT_FALSE(a.consumed);
  EXPECT_EQ(truth("A").velocity, Vec3(3, 0, 0)) << "the file's and the key's";
  (void)node->on_key(now, kA);
  EXPECT_EQ(truth("A").velocity, Vec3(5, 0, 0)) << "a repeat is a press";
  const KeyReport b = node->on_key(now, kB);
  EXPECT_EQ(truth("A").velocity, Vec3(0, 5, 0));
  EXPECT_TRUE(b.consumed);
  EXPECT_EQ(b.hits, 1u) << "NEVER stands behind one that consumes";
  EXPECT_TRUE(b.done());
}

TEST_F(PeerNodeKeys, AValueIsInTheFrameOfTheParent) {
  make();
  run(1);
  EXPECT_TRUE(node->on_key(now, kC).done());
  EXPECT_NEAR((truth("TURNED").velocity - Vec3(2, 0, 0)).norm(), 0, 1e-6) << "turned by 90 degrees, scaled by 2";
}

TEST_F(PeerNodeKeys, AParentThatTheFileMovesCountsAsItStands) {
  settings.owns.push_back("ON_TABLE");
  make();
  run(2);
  EXPECT_TRUE(node->on_key(now, {'G', 0}).done());
  EXPECT_NEAR((truth("ON_TABLE").velocity - Vec3(1, 0, 0)).norm(), 0, 0.02) << "after a quarter of a turn";
}

TEST_F(PeerNodeKeys, WhatThisPeerDoesNotMoveIsRefusedWithAReason) {
  make();
  run(1);
  const KeyReport a = node->on_key(now, kA);
  ASSERT_EQ(a.changes.size(), 2u);
  EXPECT_EQ(a.changes[0].refused, "");
  EXPECT_THAT(a.changes[1].refused, HasSubstr("a motion"));
  EXPECT_FALSE(a.done());
  const KeyReport d = node->on_key(now, kD);
  EXPECT_THAT(d.changes.at(0).refused, HasSubstr("no peer runs it"));
  EXPECT_TRUE(d.consumed) << "by the sensor, whatever comes of it";
  EXPECT_FALSE(node->on_key(now, {0x1013, 0}).done()) << "nobody listens";
  EXPECT_EQ(node->log().counters.at("keys"), 3u);
  EXPECT_EQ(node->log().counters.at("keys_unheard"), 1u);
  EXPECT_EQ(node->log().counters.at("key_changes"), 1u);
  EXPECT_EQ(node->log().counters.at("key_changes_refused"), 2u);
}

TEST_F(PeerNodeKeys, ASpeedBeyondTheWireLimitsIsRefused) {
  make();
  run(1);
  EXPECT_TRUE(node->on_key(now, {'E', 0}).done());
  EXPECT_THAT(node->on_key(now, {'E', 0}).changes.at(0).refused, HasSubstr("1e6 m/s"));
  EXPECT_THAT(node->on_key(now, {'F', 0}).changes.at(0).refused, HasSubstr("1e6 m/s"));
  EXPECT_EQ(truth("A").velocity, Vec3(600'001, 0, 0));
}

TEST_F(PeerNodeKeys, BeforeTheStartAreRefused) {
  make();
  EXPECT_THAT(node->on_key(now, kA).refused, HasSubstr("not begun"));
  while (!node->start()) run(-1e9);
  ASSERT_LT(since_start_s(), 0);
  EXPECT_THAT(node->on_key(now, kA).refused, HasSubstr("not begun"));
  run(1);
  EXPECT_EQ(truth("A").velocity, Vec3(1, 0, 0));
}

TEST_F(PeerNodeKeys, OfTheSettingsArePressedAtTheirTime) {
  make({{0.5, kA}, {0.75, kB}, {100, kB}});
  run(0.49);
  EXPECT_EQ(truth("A").velocity, Vec3(1, 0, 0));
  run(0.51);
  EXPECT_EQ(truth("A").velocity, Vec3(3, 0, 0));
  run(1);
  EXPECT_EQ(truth("A").velocity, Vec3(0, 5, 0));
  const auto first = node->poll_key_report(), second = node->poll_key_report();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->key, kA);
  EXPECT_EQ(second->key, kB);
  EXPECT_FALSE(node->poll_key_report());
}

TEST_F(PeerNodeKeys, TheNextKeyIsADeadline) {
  make({{0.5013, kA}});
  run(0.499);
  const double deadline_s = to_seconds(node->peer().clock().to_session(node->next_deadline()) - *node->start());
  EXPECT_LE(deadline_s, 0.5013);
  now = node->peer().clock().to_host(*node->start() + from_seconds(0.5013));
  node->on_tick(now);
  EXPECT_TRUE(node->poll_key_report());
}

}  // namespace peerd::peer_node_keys_test
