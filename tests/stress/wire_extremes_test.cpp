// Numbers from the ends of binary64 in datagrams: whatever passes the codec leaves a peer with finite states and
// bounded work.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <random>

#include "replication/wire/wire_limits.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::wire_extremes_test {

using namespace test;

constexpr double kLeast = std::numeric_limits<double>::denorm_min();
// Magnitudes that receivers take; codec_test.cpp has those that they refuse.
constexpr double kTaken[] = {0.0, kLeast, DBL_MIN, 1e-300, 1e-162, 1e-154, 1e-9, 1.0, 1e6, 1e9, 1e12};

// The moving objects are a box, a ball, and a surface that is not convex. All meet all, and the room that they are in.
std::string room() {
  const auto object = [](const char* name, const char* at, const char* geometry) {
    return std::string("DEF ") + name + " Transform { translation " + at + kBounces + " children Shape { geometry " +
           geometry + " } }\n";
  };
  return object("OWN", "0 0 0", "Box { size 1 1 1 }") + object("BOX", "3 0 0", "Box { size 1 1 1 }") +
         object("BALL", "-3 0 0", "Sphere { radius 0.5 }") +
         object("MESH", "0 3 0",
                "IndexedFaceSet { solid FALSE coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0, 0 0 1 ] } "
                "coordIndex [ 0 1 2 -1 0 1 3 -1 ] }") +
         box("WALL", "1 50 50", "6 0 0") + interest("OWN", "\"BOX\" \"BALL\" \"MESH\" \"WALL\"") +
         interest("BOX", "\"OWN\" \"BALL\" \"MESH\" \"WALL\"") + interest("BALL", "\"OWN\" \"MESH\" \"WALL\"") +
         interest("MESH", "\"OWN\" \"WALL\"");
}

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : rng_(seed) {}
  template <std::size_t N>
  double one_of(const double (&list)[N]) {
    const double x = list[rng_() % N];
    return rng_() % 2 == 0 ? x : -x;
  }
  std::size_t below(std::size_t n) { return rng_() % n; }
  // Mostly what is usual, so that things meet; else one of the list, no longer than `most`.
  double number(double most) {
    if (below(2) == 0) return std::min(most, 3.0) * (static_cast<double>(below(2001)) / 1000.0 - 1.0);
    return std::clamp(one_of(kTaken), -most, most);
  }
  Vec3 vector(double most) {
    const double x = number(most), y = number(most);
    return {x, y, number(most)};
  }
  Vec3 no_longer_than(double most) {
    Vec3 v = vector(most);
    while (v.norm() > most) v *= 0.5;
    return v;
  }
  Quat orientation() {
    for (;;) {
      const Vec3 v = vector(1.0);
      const Quat q(number(1.0), v.x(), v.y(), v.z());
      if (q.norm() > 0.1) return q.normalized();
    }
  }
  KinematicState state() {
    KinematicState s;
    s.position = vector(1e12);
    s.velocity = vector(1e12);
    s.acceleration = vector(1e12);
    s.orientation = orientation();
    s.angular_velocity_body = no_longer_than(kSpinMax);
    return s;
  }
  MotionModel model() {
    MotionModel m = state();
    m.kind = kMotionKinds[below(std::size(kMotionKinds))];
    if (m.kind == MotionKind::kFirst) m.state.acceleration.setZero();
    if (m.kind == MotionKind::kThird || m.kind == MotionKind::kOscillating) m.jerk = no_longer_than(kJerkMax_m_s3);
    if (m.kind == MotionKind::kTurning) m.rate_rad_s = no_longer_than(kRateMax_rad_s);
    if (m.kind == MotionKind::kOscillating) m.rate_rad_s = no_longer_than(kRateMax_rad_s).cwiseAbs();
    m.angular_acceleration_body = no_longer_than(kSpinAccelerationMax_rad_s2);
    return m;
  }

 private:
  std::mt19937_64 rng_;
};

bool sound(const KinematicState& s) {
  return s.position.allFinite() && s.velocity.allFinite() && s.acceleration.allFinite() &&
         s.angular_velocity_body.allFinite() && std::abs(s.orientation.norm() - 1.0) < 1e-9;
}

class WireExtremes : public testing::TestWithParam<int> {};

// Peer 5 runs OWN; peer 7, which is not there, says the others move in ways that no body could.
TEST_P(WireExtremes, AcceptedMessagesLeaveFiniteStates) {
  const World world(room());
  Numbers numbers(static_cast<std::uint64_t>(GetParam()));
  Lan lan(world);
  PeerConfig own = config(5, {{world["OWN"], false, Launch{{}, Vec3(1, 0, 0), Vec3::Zero()}}});
  own.convergence.method = ConvergenceMethod::kParabola;
  const std::size_t self = lan.add(own);
  lan.run_until(2s);
  const std::vector<ObjectId> others{world["BOX"], world["BALL"], world["MESH"]};
  std::uint32_t sequence = 0;
  std::uint64_t taken = 0;
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    if (round % 5 == 0) {
      ASSERT_TRUE(lan.inject(self, encode(hello_of(7, lan.host_now(self), others))).has_value());
    }
    const SimTime now = lan.session_now(self);
    Message m = message_of(7);
    for (const ObjectId object : others) {
      m.updates.push_back({object,
                           ++sequence,
                           now - Duration{static_cast<std::int64_t>(numbers.below(300'000'000))},
                           numbers.model(),
                           {},
                           {}});
    }
    const auto receive = [&](const Message& message) {
      const Bytes datagram = encode(message);
      const auto got = decode(datagram, now);
      ASSERT_TRUE(got.has_value()) << to_string(got.error());
      taken += lan.inject(self, datagram).has_value();
    };
    receive(m);
    if (round % 3 == 0) {  // of one of its objects with another: nobody else has a say there
      Message decides = message_of(7);
      decides.decisions.push_back({others[0],
                                   others[1],
                                   now - 20ms,
                                   Vec3::UnitX(),
                                   numbers.state(),
                                   numbers.state(),
                                   numbers.state(),
                                   numbers.state(),
                                   DecisionRule::kId,
                                   {}});
      receive(decides);
    }
    lan.run_until(lan.now() + 100ms);
    for (const Duration ahead : {0ns, Duration(7ms), Duration(1s), Duration(11s), Duration(24h)}) {
      const SimTime t = lan.session_now(self) + ahead;
      for (const ObjectId object : others) ASSERT_TRUE(sound(lan.peer(self).ghost(object, t))) << object.number;
      ASSERT_TRUE(sound(lan.peer(self).ghost(world["OWN"], t)));
      ASSERT_TRUE(sound(lan.peer(self).truth(world["OWN"], t)));
    }
    lan.peer(self).advance_ghosts(lan.session_now(self));
    for (const ObjectId object : others) {
      const Pose shown = lan.peer(self).shown(object, lan.session_now(self));
      ASSERT_TRUE(shown.position.allFinite() && std::abs(shown.orientation.norm() - 1.0) < 1e-9) << object.number;
    }
  }
  EXPECT_EQ(taken, 80u);
  EXPECT_GT(lan.peer(self).counters().updates_in, 150u);
  // A tick's work on ten pairs: what an overlap or a window of 250 ms asks for, not what the numbers are.
  EXPECT_LT(lan.peer(self).motion_counters().contact_searches, 200'000u);
}
INSTANTIATE_TEST_SUITE_P(Seeds, WireExtremes, testing::Range(1, 9));

// An update may make B spin as fast as can be, and ever faster: by the time it meets A no receiver would take its spin.
// The peer publishes the decision all the same, with B standing where they met.
TEST(WireExtremesDecided, WhatHasLeftTheLimitsIsDecidedAsStanding) {
  const auto ball = [](const char* name, const char* at) {
    return std::string("DEF ") + name + " Transform { translation " + at + kBounces +
           " children Shape { geometry Sphere { radius 0.5 } } }\n";
  };
  const World world(ball("A", "0 0 0") + ball("B", "3 0 0") + interest("A", "\"B\"") + interest("B", "\"A\""));
  Lan lan(world);
  const std::size_t decides = lan.add(config(5, {{world["A"], false}})), watches = lan.add(config(8));
  lan.run_until(3s);
  MotionModel model = moving({3, 0, 0}, {-4, 0, 0});
  model.state.angular_velocity_body = {0, 0, 9500};
  model.angular_acceleration_body = {0, 0, 2000};
  for (const std::size_t to : {decides, watches}) {
    ASSERT_TRUE(lan.inject(to, encode(hello_of(7, lan.host_now(to), {world["B"]}))).has_value());
    Message m = message_of(7);
    m.updates = {{world["B"], 1, lan.session_now(decides), model, {}, {}}};
    ASSERT_TRUE(lan.inject(to, encode(m)).has_value());
  }
  lan.run_until(4s);  // which fails where a datagram can't be decoded
  const auto decided = lan.contacts(decides, ContactKind::kDecided),
             applied = lan.contacts(watches, ContactKind::kApplied);
  ASSERT_EQ(decided.size(), 1u);
  ASSERT_EQ(applied.size(), 1u);
  EXPECT_EQ(applied[0].contact.at, decided[0].contact.at);
  EXPECT_TRUE(applied[0].contact.collidee_after.angular_velocity_body.isZero(0.0) &&
              applied[0].contact.collider_after.angular_velocity_body.isZero(0.0));
  EXPECT_GE(lan.peer(decides).counters().states_out_of_range, 2u);
}

}  // namespace peerd::replication::wire_extremes_test
