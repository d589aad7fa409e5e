// Scene objects that answer contacts, on several peers: who strikes one owns it until it rests, and all peers have the
// same, whenever they came.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/peers.hpp"

namespace peerd::replication::peer_scene_test {

using namespace test;
using testing::Each;
using testing::SizeIs;

const char* const kSlides = " collisionResponse CollisionResponse { responseType 2 restitution 0.5 friction 3 } ";
const char* const kGlides = " collisionResponse CollisionResponse { responseType 2 restitution 1 } ";

// BALL lies at the origin, half a metre wide; the cars are 1 m long, A on its left and B on its right.
std::string ball_and_cars(const std::string& ball_fields = kSlides) {
  return box("BALL", "0.5 0.5 0.5", "0 0 0", ball_fields) + box("CAR_A", "1 1 1", "-12 0 0") +
         box("CAR_B", "1 1 1", "22 0 0") + box("WALL", "1 20 20", "30 0 0") +
         interest("BALL", "\"CAR_A\" \"CAR_B\" \"WALL\"");
}

double seconds_of(SimTime t) { return to_seconds(t.time_since_epoch() - kEpoch); }

// Stands at `from`, drives at that velocity from `begin` until `turn` [s], and back again.
Lan::Motion drives(const Vec3& from, const Vec3& velocity, double begin, double turn) {
  return [=](SimTime t) {
    const double s = seconds_of(t);
    if (s < begin || s >= 2.0 * turn - begin) return moving(from);
    if (s < turn) return moving(from + (s - begin) * velocity, velocity);
    return moving(from + (2.0 * turn - begin - s) * velocity, -velocity);
  };
}
// Car A comes to the ball at 5 s, at 4 m/s, and turns 0.1 s later: the ball goes at 6 m/s and lies 6 m farther at 7 s.
constexpr double kStrike_s = 5.0, kLies_s = 7.0, kLies_m = 6.0, kFaster = 1.5;
const Lan::Motion kStrikes = drives({-12, 0, 0}, {4, 0, 0}, kStrike_s - 11.25 / 4, kStrike_s + 0.1);

struct Conditions {
  DecisionPolicy policy = DecisionPolicy::kId;
  Duration latency = 20ms;
  double loss = 0.0;
  bool skips = false;  // no peer sees anything, and all skip that
};

class Scene : public Peers {
 protected:
  explicit Scene(const std::string& text = ball_and_cars(), const Conditions& with = {})
      : Peers(text, {"CAR_A", "CAR_B"}), conditions(with) {
    renew();
  }

  void renew() { lan = std::make_unique<Lan>(world, Link{.latency = conditions.latency, .loss = conditions.loss}, 5); }
  [[nodiscard]] PeerConfig with_policy(PeerConfig c) const {
    c.decisions.policy = conditions.policy;
    c.decisions.server = PeerId{3};
    c.sight.skip_unseen = conditions.skips;
    return c;
  }
  void add_owners(const Lan::Motion& a, const Lan::Motion& b) {
    lan->add(with_policy(config(1, {{world["CAR_A"], true}})), 0s, {{world["CAR_A"], a}});
    lan->add(with_policy(config(2, {{world["CAR_B"], true}})), 7s, {{world["CAR_B"], b}});
    lan->add(with_policy(config(3)), 3s);
  }
  // All peers have one ghost, so long ago, to the last bit; returns it.
  KinematicState same_everywhere(const char* object, Duration ago, std::size_t from = 0) {
    const SimTime t = lan->session_now(from) - ago;
    const KinematicState first = lan->peer(from).ghost(world[object], t);
    for (std::size_t i = from; i < lan->size(); ++i) {
      const KinematicState other = lan->peer(i).ghost(world[object], t);
      EXPECT_TRUE(same_bits(other, first)) << object << " of peer " << i << " at " << seconds_of(t) << ": "
                                           << other.position.transpose() << ", and not " << first.position.transpose();
      const KinematicState truth = lan->peer(i).truth(world[object], t);
      EXPECT_TRUE(same_bits(truth, first)) << object << " of peer " << i << " in truth at " << seconds_of(t) << ": "
                                           << truth.position.transpose() << ", and not " << first.position.transpose();
    }
    return first;
  }
  [[nodiscard]] std::uint64_t decisions() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < lan->size(); ++i) sum += lan->peer(i).counters().decisions;
    return sum;
  }

  Conditions conditions;
};
class All : public Scene, public testing::WithParamInterface<Conditions> {
 protected:
  All() : Scene(ball_and_cars(), GetParam()) {}
};

const Lan::Motion kStands = drives({22, 0, 0}, Vec3::Zero(), 100, 100);

// One outcome, one owner until the ball lies, and then none: in every phase the same at all peers.
TEST_P(All, TheBallOfNobodyIsThePeersThatStrikesItUntilItLies) {
  add_owners(kStrikes, kStands);
  const Duration settled = GetParam().loss > 0.0 ? 1500ms : 2 * GetParam().latency + 100ms;
  lan->run_until(seconds(kStrike_s - 0.1));
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  lan->run_until(seconds(kStrike_s) + settled);
  EXPECT_THAT(owners_of("BALL"), Each(1u));
  (void)same_everywhere("BALL", settled - 50ms);
  lan->run_until(seconds(kLies_s) + 900ms);
  EXPECT_NEAR(same_everywhere("BALL", 500ms).position.x(), kLies_m, 0.1);
  lan->run_until(seconds(kLies_s) + 4s);
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  const KinematicState lies = same_everywhere("BALL", 100ms);
  EXPECT_NEAR(lies.position.x(), kLies_m, 0.1);
  EXPECT_TRUE(is_motionless(lies));
  EXPECT_EQ(decisions(), 1u);
  EXPECT_THAT(lan->contacts(0, ContactKind::kDecided), SizeIs(1));
  for (const std::size_t i : {1u, 2u}) EXPECT_THAT(lan->contacts(i, ContactKind::kApplied), SizeIs(1)) << i;
}

// The other peer's car meets it where it lies, and sends it back.
TEST_P(All, TheNextPeerThatStrikesItIsItsNextOwner) {
  // B's side comes to the ball, which ends at 6.25 m, at 12 s.
  add_owners(kStrikes, drives({22, 0, 0}, {-5, 0, 0}, 12 - 15.25 / 5, 12.1));
  lan->run_until(11800ms);
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  lan->run_until(12s + (GetParam().loss > 0.0 ? 1500ms : 2 * GetParam().latency + 100ms));
  EXPECT_THAT(owners_of("BALL"), Each(2u));
  lan->run_until(19s);
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  const KinematicState lies = same_everywhere("BALL", 100ms);
  EXPECT_TRUE(is_motionless(lies));
  const double speed = kFaster * 5, farther = speed * speed / 6;
  EXPECT_NEAR(lies.position.x(), kLies_m - farther, 0.2);
  EXPECT_THAT(lan->contacts(1, ContactKind::kDecided), SizeIs(1));
}

// Both cars strike it before either has the other's decision. All peers end with one way of the ball, and nobody has
// given it more than the faster car can.
TEST_P(All, TwoPeersThatStrikeItAtOnceAgree) {
  for (const double later_s : {-0.03, 0.0, 0.013, 0.05}) {
    SCOPED_TRACE(later_s);
    renew();
    const double at = kStrike_s + later_s;
    add_owners(kStrikes, drives({0, 22, 0}, {0, -4, 0}, at - 21.25 / 4, at + 0.1));
    double fastest = 0.0;
    for (Duration t = 5s; t < 8s; t += 50ms) {
      lan->run_until(t);
      for (std::size_t i = 0; i < 3; ++i) {
        fastest = std::max(fastest, lan->peer(i).truth(world["BALL"], lan->session_now(i)).velocity.norm());
      }
    }
    EXPECT_LE(fastest, 6.0 * std::sqrt(2.0) + 1e-9) << "6 m/s by each car";
    lan->run_until(14s);
    EXPECT_THAT(owners_of("BALL"), Each(0u));
    EXPECT_TRUE(is_motionless(same_everywhere("BALL", 100ms)));
  }
}

// The cars come from both sides, and leave the ball no room for a while. Each of them is a racket: what comes at u goes
// at 4 + (4 + u) / 2, so at 12 m/s at most. Nothing makes the two peers decide for ever.
TEST_P(All, BetweenTwoCarsItHasOneOutcome) {
  for (const double later_s : {0.0, 0.013}) {
    SCOPED_TRACE(later_s);
    renew();
    const double at = kStrike_s + later_s;
    add_owners(kStrikes, drives({22, 0, 0}, {-4, 0, 0}, at - 21.25 / 4, at + 0.1));
    for (Duration t = 5s; t < 8s; t += 50ms) {
      lan->run_until(t);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LE(lan->peer(i).truth(world["BALL"], lan->session_now(i)).velocity.norm(), 12.0 + 1e-9);
      }
    }
    lan->run_until(18s);
    EXPECT_THAT(owners_of("BALL"), Each(0u));
    EXPECT_TRUE(is_motionless(same_everywhere("BALL", 100ms)));
    EXPECT_LE(decisions(), 400u) << "one at each tick would be more";
  }
}

// A peer that comes before the strike, while the ball rolls, while it lies and has its owner still, and long after.
TEST_P(All, AJoiningPeerHasTheSame) {
  add_owners(kStrikes, kStands);
  for (const Duration came : {3500ms, 5300ms, 7400ms, 14000ms}) {
    lan->run_until(came);
    if (came > 6s) (void)same_everywhere("BALL", 300ms);
    lan->add(with_policy(config(static_cast<std::uint32_t>(lan->size()) + 1)), 11s);
  }
  lan->run_until(22s);
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  EXPECT_NEAR(same_everywhere("BALL", 100ms).position.x(), kLies_m, 0.1);
}

// The last one that strikes it has left when the first one that needs to know comes; and a peer with the lowest id of
// all, which leads then, knows nothing.
TEST_P(All, WhatItsOwnerHasLeftStaysThere) {
  lan->add(with_policy(config(11, {{world["CAR_A"], true}})), 0s, {{world["CAR_A"], kStrikes}});
  lan->add(with_policy(config(12)), 7s);
  lan->run_until(11s);
  lan->leave(0);
  lan->run_until(13s);
  lan->add(with_policy(config(1)), 3s);
  lan->run_until(20s);
  const KinematicState lies = same_everywhere("BALL", 100ms, 1);
  EXPECT_NEAR(lies.position.x(), kLies_m, 0.1);
  lan->leave(1);
  lan->run_until(21s);
  lan->add(with_policy(config(2)), 3s);
  lan->run_until(27s);
  EXPECT_TRUE(same_bits(same_everywhere("BALL", 100ms, 2), lies));
}

// The owner leaves, or is killed, while the ball rolls: it rolls on, and lies where it would.
TEST_P(All, ABallWhoseOwnerLeavesRollsOn) {
  for (const bool killed : {false, true}) {
    SCOPED_TRACE(killed);
    renew();
    add_owners(kStrikes, kStands);
    lan->run_until(seconds(kStrike_s + (GetParam().loss > 0.0 ? 1.2 : 0.8)));
    killed ? lan->kill(0) : lan->leave(0);
    lan->run_until(9s);
    lan->add(with_policy(config(4)), 1s);
    lan->run_until(15s);
    for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(lan->peer(i).owner(world["BALL"]), kNobody) << i;
    const KinematicState lies = same_everywhere("BALL", 100ms, 1);
    EXPECT_TRUE(is_motionless(lies));
    EXPECT_NEAR(lies.position.x(), kLies_m, 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(
    PoliciesAndNetworks, All,
    testing::Values(Conditions{}, Conditions{DecisionPolicy::kVelocity}, Conditions{DecisionPolicy::kFieldOfView},
                    Conditions{DecisionPolicy::kExpectedError}, Conditions{DecisionPolicy::kServer},
                    Conditions{DecisionPolicy::kId, 0ms}, Conditions{DecisionPolicy::kId, 200ms},
                    Conditions{DecisionPolicy::kVelocity, 200ms}, Conditions{DecisionPolicy::kServer, 100ms},
                    Conditions{DecisionPolicy::kId, 50ms, 0.1}, Conditions{DecisionPolicy::kExpectedError, 20ms, 0.2},
                    Conditions{DecisionPolicy::kId, 20ms, 0.0, true},
                    Conditions{DecisionPolicy::kFieldOfView, 100ms, 0.0, true},
                    Conditions{DecisionPolicy::kVelocity, 200ms, 0.0, true},
                    Conditions{DecisionPolicy::kExpectedError, 20ms, 0.2, true}),
    [](const auto& conditions) {
      const Conditions& c = conditions.param;
      return "Policy" + std::to_string(static_cast<int>(c.policy)) + "At" + std::to_string(c.latency / 1ms) + "msLoss" +
             std::to_string(static_cast<int>(100 * c.loss)) + (c.skips ? "Unseen" : "");
    });

// ---- what nobody sees ----

class Unseen : public Scene {
 protected:
  Unseen() : Scene(ball_and_cars(kGlides), {DecisionPolicy::kId, 20ms, 0.0, true}) {
    add_owners(kStrikes, drives({22, 9, 0}, Vec3::Zero(), 100, 100));
    lan->add(config(4));  // it computes all
  }
};

// The ball has come back from the wall when its owner leaves: all go on by what that peer would have.
TEST_F(Unseen, ABallWhoseOwnerLeavesGoesOnFromWhereEverybodyHasIt) {
  lan->run_until(9500ms);
  ASSERT_GT(lan->peer(2).ghost(world["BALL"], lan->session_now(2)).position.x(), 29.5) << "it is behind the wall there";
  lan->leave(0);
  lan->run_until(9700ms);
  EXPECT_THAT(owners_of("BALL"), testing::ElementsAre(1u, 0u, 0u, 0u));
  EXPECT_EQ(same_everywhere("BALL", 100ms, 1).velocity.x(), -8.0);
}

// ---- what is predicted and does not happen ----

class FarAway : public Scene {
 protected:
  FarAway() : Scene(ball_and_cars(), {DecisionPolicy::kId, 200ms}) {}
};

// The others see the car go on, and predict that it strikes the ball. It has turned before.
TEST_F(FarAway, AStrikeThatWasOnlyPredictedIsTakenBack) {
  add_owners(drives({-12, 0, 0}, {4, 0, 0}, kStrike_s - 11.25 / 4, kStrike_s - 0.02), kStands);
  lan->run_until(5400ms);
  EXPECT_THAT(lan->contacts(1, ContactKind::kPredicted), SizeIs(1));
  EXPECT_GT(lan->peer(1).ghost(world["BALL"], lan->session_now(1)).position.x(), 0.1);
  EXPECT_TRUE(is_motionless(lan->peer(1).truth(world["BALL"], lan->session_now(1))));
  lan->run_until(9s);
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  EXPECT_EQ(same_everywhere("BALL", 100ms).position, Vec3(0, 0, 0));
  EXPECT_EQ(decisions(), 0u);
}

// Both sides of a partition strike the ball. When they meet again, the later decision counts.
TEST_F(FarAway, AfterAPartitionOneOfBothOutcomesIsLeft) {
  add_owners(kStrikes, drives({0, 22, 0}, {0, -4, 0}, 7 - 21.25 / 4, 7.1));
  lan->run_until(3s);
  lan->part({1});
  lan->run_until(13s);
  EXPECT_NEAR(lan->peer(0).truth(world["BALL"], lan->session_now(0)).position.x(), kLies_m, 0.1);
  EXPECT_NEAR(lan->peer(1).truth(world["BALL"], lan->session_now(1)).position.y(), -kLies_m, 0.1);
  lan->part({});
  lan->run_until(20s);
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  EXPECT_NEAR(same_everywhere("BALL", 100ms).position.y(), -kLies_m, 0.1);
}

class Gliding : public Scene {
 protected:
  Gliding() : Scene(ball_and_cars(kGlides)) {}
};

// One peer has not received the ball's owner for a while, and thinks that it goes on as nobody's.
TEST_F(Gliding, ALoanGoesOnWhenAPeerHasTakenItsOwnerForGone) {
  add_owners(kStrikes, drives({22, 9, 0}, Vec3::Zero(), 100, 100));
  lan->add(with_policy(config(4)), 1s);
  lan->run_until(6s);
  ASSERT_THAT(owners_of("BALL"), Each(1u));
  lan->part({2});
  lan->run_until(10s);
  ASSERT_THAT(owners_of("BALL"), testing::ElementsAre(1u, 1u, 0u, 1u));
  lan->part({});
  for (Duration t = 13s; t <= 19s; t += 1s) {
    lan->run_until(t);
    EXPECT_THAT(owners_of("BALL"), Each(1u)) << "at " << t / 1s << " s";
  }
  (void)same_everywhere("BALL", 500ms);
}

// ---- from one to the next ----

class Row : public Scene {
 protected:
  static std::string row() {
    return ball_and_cars() + box("NEXT", "0.5 0.5 0.5", "0.52 0 0", kSlides) +
           box("LAST", "0.5 0.5 0.5", "1.6 0 0", kSlides) + interest("BALL", "\"NEXT\"") +
           interest("NEXT", "\"BALL\" \"LAST\"") + interest("LAST", "\"NEXT\"");
  }
  Row() : Scene(row()) {}
};

// The first tick after the strike has two contacts: what an adopted object moves is decided, too.
TEST_F(Row, WhatAStruckBallStrikesIsTheSamePeers) {
  add_owners(kStrikes, kStands);
  lan->run_until(5500ms);
  for (const char* ball : {"BALL", "NEXT", "LAST"}) EXPECT_THAT(owners_of(ball), Each(1u)) << ball;
  lan->add(config(4), 9s);
  lan->run_until(14s);
  for (const char* ball : {"BALL", "NEXT", "LAST"}) {
    EXPECT_THAT(owners_of(ball), Each(0u)) << ball;
    EXPECT_TRUE(is_motionless(same_everywhere(ball, 100ms))) << ball;
  }
  EXPECT_EQ(decisions(), 3u);
}

// ---- scene objects among themselves ----

class Billiards : public Scene {
 protected:
  static std::string billiards() {
    const auto ball = [](const char* name, const char* at, const char* velocity) {
      return box(name, "1 1 1", at, std::string(kGlides) + "velocityVector " + velocity + " ");
    };
    return ball("ONE", "-5 0 0", "2 0 0") + ball("TWO", "5 0 0", "-1 0 0") + box("LEFT", "1 9 9", "-10 0 0") +
           box("RIGHT", "1 9 9", "10 0 0") + box("CAR_A", "1 1 1", "0 9 0") + box("CAR_B", "1 1 1", "0 20 0") +
           interest("ONE", "\"TWO\" \"LEFT\" \"RIGHT\" \"CAR_A\"") +
           interest("TWO", "\"ONE\" \"LEFT\" \"RIGHT\" \"CAR_A\"");
  }
  Billiards() : Scene(billiards()) {}
  void begin(const Lan::Motion& a = drives({0, 9, 0}, Vec3::Zero(), 99, 99)) {
    add_owners(a, drives({0, 20, 0}, Vec3::Zero(), 99, 99));
    lan->run_until(2s);
    lan->peer(0).announce_start(lan->session_now(0) + 1s);
  }
};

TEST_F(Billiards, WhatTheyDoIsAFunctionOfWorldTimeThatCostsNothing) {
  begin();
  for (Duration t = 4s; t < 30s; t += 1700ms) {
    lan->run_until(t);
    for (const char* ball : {"ONE", "TWO"}) (void)same_everywhere(ball, 60ms);
  }
  EXPECT_EQ(decisions(), 0u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LE(lan->peer(i).counters().updates_out, 8u) << "of the cars that stand";
  EXPECT_THAT(owners_of("ONE"), Each(0u));
  // They meet after 3 s and exchange velocities.
  const double s = seconds_of(*lan->peer(0).world_zero());
  std::vector<double> met;
  for (const ContactSeen& c : lan->contacts(2, ContactKind::kScene)) met.push_back(seconds_of(c.contact.at) - s);
  ASSERT_GT(met.size(), 3u);
  EXPECT_NEAR(met[0], 3.0, 1e-6);
  const KinematicState one = same_everywhere("ONE", 60ms), two = same_everywhere("TWO", 60ms);
  EXPECT_NEAR(one.velocity.squaredNorm() + two.velocity.squaredNorm(), 5.0, 1e-9) << "no energy comes or goes";
}

// The car comes from above, into the way of ONE.
TEST_F(Billiards, AStrikeTakesOneOutOfTheFunctionOfTime) {
  begin(drives({-3, 9, 0}, {0, -5, 0}, 8.4, 10.15));
  lan->run_until(12s);
  EXPECT_EQ(decisions(), 1u);
  EXPECT_THAT(owners_of("ONE"), Each(1u)) << "it flies for ever";
  EXPECT_THAT(owners_of("TWO"), Each(0u));
  for (const char* ball : {"ONE", "TWO"}) (void)same_everywhere(ball, 300ms);
  lan->add(config(4), 9s);
  lan->run_until(20s);
  for (const char* ball : {"ONE", "TWO"}) (void)same_everywhere(ball, 300ms);
}

// ---- what a ROUTE moves ----

class Driven : public Scene {
 protected:
  // BALL comes from x = 10 at 1 m/s, to 4 and back, every 12 s.
  static std::string driven(double wall_x) {
    return box("BALL", "0.5 0.5 0.5", "10 0 0", kSlides) + box("WALL", "1 9 9", std::to_string(wall_x) + " 0 0") +
           box("CAR_A", "1 1 1", "6 0 0") + box("CAR_B", "1 1 1", "0 20 0") + interest("BALL", "\"WALL\" \"CAR_A\"") +
           shuttles("BALL");
  }
  explicit Driven(double wall_x = -20) : Scene(driven(wall_x)) {}
  void begin(double car_x) {
    add_owners(drives({car_x, 0, 0}, Vec3::Zero(), 99, 99), drives({0, 20, 0}, Vec3::Zero(), 99, 99));
    lan->run_until(2s);
    lan->peer(0).announce_start(lan->session_now(0) + 1s);
  }
};

// The ball meets the car that stands at 6 m when its middle is at 6.75, goes back at 0.5 m/s and comes to rest.
TEST_F(Driven, ABallThatARouteDrivesLeavesItWhenItIsStruck) {
  begin(6);
  lan->run_until(7s);
  EXPECT_THAT(owners_of("BALL"), Each(1u));
  lan->add(config(4), 9s);
  lan->run_until(25s);
  EXPECT_THAT(owners_of("BALL"), Each(0u));
  const KinematicState lies = same_everywhere("BALL", 100ms);
  EXPECT_TRUE(is_motionless(lies)) << "the ROUTE does not take it back";
  EXPECT_NEAR(lies.position.x(), 6.75 + 0.25 / 6, 1e-3);
  EXPECT_EQ(decisions(), 1u);
}

class DrivenAtAWall : public Driven {
 protected:
  DrivenAtAWall() : Driven(5) {}
};

// The same with a wall of the scene: nobody owns it ever, and no datagram says so but to the peer that comes later.
TEST_F(DrivenAtAWall, ABallThatARouteDrivesLeavesItAtAWall) {
  begin(-90);
  lan->run_until(9s);
  lan->add(config(4), 9s);
  lan->run_until(25s);
  const KinematicState lies = same_everywhere("BALL", 100ms);
  EXPECT_TRUE(is_motionless(lies));
  EXPECT_NEAR(lies.position.x(), 5.75 + 0.25 / 6, 1e-3);
  EXPECT_EQ(decisions(), 0u);
}

// ---- what a configuration gives to a peer is no scene object ----

TEST_F(Scene, WhatAConfigurationGivesToAPeerIsTakenFromItsFinder) {
  // Peer 2's ball, of which peer 1 hears only when peer 2 comes.
  lan->add(config(1, {{world["CAR_A"], true}}), 0s, {{world["CAR_A"], kStrikes}});
  lan->run_until(5500ms);
  EXPECT_THAT(owners_of("BALL"), Each(1u));
  lan->add(config(2, {{world["BALL"], false}}), 7s);
  lan->run_until(10s);
  EXPECT_THAT(owners_of("BALL"), Each(2u));
  (void)same_everywhere("BALL", 100ms);
  lan->leave(1);
  lan->run_until(12s);
  EXPECT_THAT(lan->peer(0).owner(world["BALL"]), kNobody);
  EXPECT_THAT(lan->seen<ObjectOrphaned>(0), SizeIs(1));
}

TEST_F(Scene, NoHelloSpeaksOfSceneObjectsThatLieWhereTheFileHasThem) {
  std::size_t with_digest = 0, with_states = 0;
  lan->on_send = [&](std::size_t, RegionId, const Message& m) {
    with_digest += m.hello && m.hello->scene_digest != 0;
    with_states += !m.scene.states.empty();
  };
  add_owners(kStrikes, kStands);
  lan->run_until(4900ms);
  EXPECT_EQ(with_digest, 0u);
  lan->run_until(20s);
  EXPECT_GT(with_digest, 0u);
  EXPECT_LE(with_states, 3u) << "what the owner leaves, and no more where nobody joins and nothing is lost";
}

}  // namespace peerd::replication::peer_scene_test
