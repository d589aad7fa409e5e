#include "replication/objects/sight/unseen_pairs.hpp"

#include <random>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::unseen_pairs_test {
namespace {

using namespace test;

// A world whose contacts are put off beside one whose are not; both are told the same.
struct Twins {
  Twins(const World& world, std::function<UnseenPairs::Standing(ObjectId)> standing)
      : all(*world.model, sim(0s)), some(*world.model, sim(0s)), pairs(*world.model) {
    pairs.restart(sim(0s));
    peer.standing = std::move(standing);
    peer.is_decided = [](ObjectId, ObjectId) { return false; };
    peer.in_sight = [this](const Vec3& center, double radius_m) { return sees && sees(center, radius_m); };
  }
  void declare(ObjectId object, Role role) {
    all.declare(object, role);
    some.declare(object, role);
  }
  void set_base(ObjectId object, SimTime t, const KinematicState& state) {
    if (pairs.others_depend_on(some, object)) {
      for (bool more = pairs.update(some, now, peer, object); more; more = pairs.update(some, now, peer, object)) {
        some.advance(now);
      }
    }
    all.set_base(object, t, state);
    some.set_base(object, t, state);
  }
  void advance(SimTime to) {
    now = to;
    all.advance(to);
    static_cast<void>(pairs.update(some, to, peer));
    do some.advance(to);
    while (pairs.update(some, to, peer));
  }
  // In steps of 16 ms, and this object never differs.
  void advance_alike(ObjectId object, int from_ms, int until_ms) {
    for (int ms = from_ms; ms < until_ms; ms += 16) {
      advance(sim(std::chrono::milliseconds(ms)));
      ASSERT_TRUE(agree_on(object)) << ms;
    }
  }
  void change_model(const WorldModel& next) {
    if (pairs.take_up_all(some)) some.advance(now);
    all.change_model(next);
    some.change_model(next);
    pairs = UnseenPairs(next);
    pairs.restart(now);
  }
  [[nodiscard]] bool agree_on(ObjectId object) const { return same_bits(all.at(object, now), some.at(object, now)); }

  MotionWorld all, some;
  UnseenPairs pairs;
  UnseenPairs::Peer peer;
  std::function<bool(const Vec3&, double)> sees;
  SimTime now{};
};

constexpr auto kRemote = UnseenPairs::Standing::kRemote;
constexpr auto kKept = UnseenPairs::Standing::kKept;
constexpr auto kScene = UnseenPairs::Standing::kScene;
constexpr auto kFree = UnseenPairs::Standing::kFree;
const char* const kImpulse = "collisionResponse CollisionResponse { responseType 2 }";

TEST(UnseenPairs, WhatComesIntoSightHasBeenSearchedSinceItWasPutOff) {
  const World world(corridor());
  const ObjectId ball = world["BALL"];
  Twins twins(world, [&](ObjectId object) { return object == ball ? kRemote : kScene; });
  twins.declare(ball, Role::kPredicted);
  twins.advance(sim(1s));
  EXPECT_EQ(twins.pairs.pairs_put_off(), 2u);
  twins.set_base(ball, sim(1s), moving({0, 0, 0}, {2, 0, 0}));
  twins.advance(sim(4s));
  EXPECT_EQ(twins.some.counters().contact_searches, 0u);
  EXPECT_GT(twins.some.counters().searches_put_off, 0u);
  EXPECT_FALSE(twins.agree_on(ball)) << "it has gone through a wall, as nobody looked";
  twins.sees = [](const Vec3&, double) { return true; };
  twins.advance(sim(4016ms));
  EXPECT_TRUE(twins.agree_on(ball));
  EXPECT_EQ(twins.pairs.pairs_put_off(), 0u);
  std::vector<ObjectId> woken;
  twins.pairs.take_woken([&](ObjectId object) { woken.push_back(object); });
  EXPECT_EQ(woken, std::vector{ball});
}

TEST(UnseenPairs, AnUpdateContainsWhatHappenedBefore) {
  const World world(corridor());
  const ObjectId ball = world["BALL"];
  Twins twins(world, [&](ObjectId object) { return object == ball ? kRemote : kScene; });
  twins.declare(ball, Role::kPredicted);
  for (int s = 1; s < 20; ++s) {
    twins.set_base(ball, sim(std::chrono::seconds(s)), moving({2, 0, 0}, {1, 0, 0}));
    twins.advance(sim(std::chrono::seconds(s) + 900ms));
  }
  EXPECT_EQ(twins.some.counters().contact_searches, 0u);
  twins.sees = [](const Vec3&, double) { return true; };
  twins.advance(sim(20s));
  EXPECT_TRUE(twins.agree_on(ball));
  EXPECT_LT(10 * twins.some.counters().contact_searches, twins.all.counters().contact_searches)
      << "those since the last update";
}

TEST(UnseenPairs, WhatNobodyOwnsIsNoPrediction) {
  const World world(corridor());
  Twins twins(world, [&](ObjectId) { return kScene; });
  twins.advance(sim(1s));
  EXPECT_EQ(twins.pairs.pairs_put_off(), 0u);
}

// A ball stands far off; what nobody sees hits another body, which hits the ball.
TEST(UnseenPairs, WhatReachesAKeptObjectByAnotherOneIsNotMissed) {
  const World world(box("FIRST", "1 1 1", "-9 0 0", kImpulse) + box("NEXT", "1 1 1", "-4 0 0", kImpulse) +
                    box("MINE", "1 1 1", "0 0 0", kImpulse) + interest("FIRST", "\"NEXT\" \"MINE\"") +
                    interest("NEXT", "\"FIRST\" \"MINE\"") + interest("MINE", "\"FIRST\" \"NEXT\""));
  const ObjectId mine = world["MINE"];
  Twins twins(world, [&](ObjectId object) { return object == mine ? kKept : kRemote; });
  twins.declare(mine, Role::kAuthoritative);
  for (const char* name : {"FIRST", "NEXT"}) twins.declare(world[name], Role::kPredicted);
  twins.set_base(world["FIRST"], sim(0s), moving({-9, 0, 0}, {4, 0, 0}));
  twins.advance_alike(mine, 0, 5000);
  EXPECT_GT(twins.some.at(mine, twins.now).velocity.x(), 1.0) << "it was hit";
}

// All of it happens within one step: the body between them stands until it is hit.
TEST(UnseenPairs, WhatReachesAKeptObjectByAnotherOneWithinAStepIsNotMissed) {
  const World world(box("FIRST", "1 1 1", "-4 0 0", kImpulse) + box("NEXT", "1 1 1", "0 0 0", kImpulse) +
                    box("MINE", "1 1 1", "9 0 0", kImpulse) + interest("FIRST", "\"NEXT\"") +
                    interest("NEXT", "\"FIRST\" \"MINE\"") + interest("MINE", "\"NEXT\""));
  const ObjectId mine = world["MINE"];
  Twins twins(world, [&](ObjectId object) { return object == mine ? kKept : kRemote; });
  twins.declare(mine, Role::kAuthoritative);
  for (const char* name : {"FIRST", "NEXT"}) twins.declare(world[name], Role::kPredicted);
  twins.advance(sim(10ms));
  twins.set_base(world["FIRST"], sim(10ms), moving({-4, 0, 0}, {20, 0, 0}));
  twins.advance(sim(1s));
  EXPECT_TRUE(twins.agree_on(mine));
  EXPECT_GT(twins.some.at(mine, twins.now).velocity.x(), 1.0) << "it was hit";
}

// What nobody saw bounce comes back, and its ghost does not.
TEST(UnseenPairs, WhatReachesAKeptObjectOffItsGhostsWayIsNotMissed) {
  const World world(box("BODY", "1 1 1", "0 0 0", kImpulse) + box("MINE", "1 1 1", "-9 0 0", kImpulse) +
                    box("WALL", "1 20 20", "5 0 0") + interest("BODY", "\"MINE\" \"WALL\"") +
                    interest("MINE", "\"BODY\""));
  const ObjectId body = world["BODY"], mine = world["MINE"];
  Twins twins(world, [&](ObjectId object) { return object == mine ? kKept : object == body ? kRemote : kScene; });
  twins.declare(body, Role::kPredicted);
  twins.declare(mine, Role::kAuthoritative);
  twins.advance(sim(10ms));
  twins.set_base(body, sim(10ms), moving({0, 0, 0}, {4, 0, 0}));
  bool astray = false;
  for (int ms = 16; ms < 5000; ms += 16) {
    twins.advance(sim(std::chrono::milliseconds(ms)));
    ASSERT_TRUE(twins.agree_on(mine)) << ms;
    astray |= !twins.agree_on(body);
  }
  EXPECT_TRUE(astray);
  EXPECT_LT(twins.some.at(mine, twins.now).velocity.x(), -1.0) << "it was hit";
}

// What a body has done to another one before an update of it is no part of that update.
TEST(UnseenPairs, AnUpdateOfOneDoesNotHideWhatAnotherHasMet) {
  const World world(box("BODY", "1 1 1", "0 0 0", kImpulse) + box("NEXT", "1 1 1", "-5 0 0", kImpulse) +
                    box("WALL", "1 20 20", "5 0 0") + interest("BODY", "\"NEXT\" \"WALL\"") +
                    interest("NEXT", "\"BODY\" \"WALL\""));
  const ObjectId body = world["BODY"], next = world["NEXT"];
  Twins twins(world, [&](ObjectId object) { return object == body || object == next ? kRemote : kScene; });
  for (const ObjectId object : {body, next}) twins.declare(object, Role::kPredicted);
  twins.advance(sim(10ms));
  twins.set_base(body, sim(10ms), moving({0, 0, 0}, {4, 0, 0}));
  for (int ms = 16; ms < 4000; ms += 16) twins.advance(sim(std::chrono::milliseconds(ms)));
  EXPECT_FALSE(twins.agree_on(body));
  EXPECT_FALSE(twins.agree_on(next)) << "the body has come back from the wall and hit it";
  twins.set_base(body, sim(4s), moving({0, 0, 20}, {0, 0, 0}));
  twins.advance(sim(5s));
  twins.sees = [](const Vec3&, double) { return true; };
  twins.advance(sim(5016ms));
  EXPECT_TRUE(twins.agree_on(next));
  EXPECT_LT(twins.all.at(next, twins.now).velocity.x(), -1.0);
}

// What no peer owns, and what a remote object drives into out of sight, comes into sight without that.
TEST(UnseenPairs, WhatAFreeObjectWasHitByIsSearchedWhenItComesIntoSight) {
  const World world(box("CAR", "1 1 1", "-9 0 0") + box("BALL", "1 1 1", "0 0 0", kImpulse) +
                    interest("BALL", "\"CAR\""));
  const ObjectId car = world["CAR"], ball = world["BALL"];
  Twins twins(world, [&](ObjectId object) { return object == car ? kRemote : kFree; });
  for (const ObjectId object : {car, ball}) twins.declare(object, Role::kPredicted);
  twins.advance(sim(10ms));
  twins.set_base(car, sim(10ms), moving({-9, 0, 0}, {4, 0, 0}));
  for (int ms = 16; ms < 4000; ms += 16) twins.advance(sim(std::chrono::milliseconds(ms)));
  EXPECT_EQ(twins.some.counters().contact_searches, 0u);
  EXPECT_FALSE(twins.agree_on(ball));
  EXPECT_TRUE(twins.pairs.is_in_doubt(ball));
  EXPECT_FALSE(twins.pairs.is_in_doubt(car)) << "nothing moves it";
  const Vec3 where = twins.all.at(ball, twins.now).position;
  twins.sees = [&](const Vec3& center, double radius_m) { return (center - where).norm() < 1.0 + radius_m; };
  twins.advance(sim(4s));
  EXPECT_TRUE(twins.agree_on(ball));
  EXPECT_GT(twins.some.at(ball, twins.now).velocity.x(), 5.0) << "it was hit";
}

TEST(UnseenPairs, WhatAFreeObjectCarriesOnToAKeptOneIsNotMissed) {
  const World world(box("CAR", "1 1 1", "-9 0 0") + box("BALL", "1 1 1", "-4 0 0", kImpulse) +
                    box("MINE", "1 1 1", "3 0 0", kImpulse) + interest("BALL", "\"CAR\" \"MINE\"") +
                    interest("MINE", "\"BALL\""));
  const ObjectId car = world["CAR"], mine = world["MINE"];
  Twins twins(world, [&](ObjectId object) { return object == mine ? kKept : object == car ? kRemote : kFree; });
  twins.declare(mine, Role::kAuthoritative);
  for (const char* name : {"CAR", "BALL"}) twins.declare(world[name], Role::kPredicted);
  twins.advance(sim(10ms));
  twins.set_base(car, sim(10ms), moving({-9, 0, 0}, {4, 0, 0}));
  twins.advance_alike(mine, 16, 4000);
  EXPECT_GT(twins.some.at(mine, twins.now).velocity.x(), 1.0) << "it was hit";
}

// The truck's board is nobody's, as the ball is: all peers compute what the board does to it, and so where the truck
// has bounced off a wall.
TEST(UnseenPairs, WhatMovesAnEndOfASceneContactIsKept) {
  const std::string truck = box_with("TRUCK", "1 1 1", "0 0 0", kImpulse, box("BOARD", "1 1 1", "0 3 0")),
                    others = box("WALL", "1 1 20", "5 0 0") + box("BALL", "1 1 1", "-4 3 0", kImpulse) +
                             interest("TRUCK", "\"WALL\"");
  for (const bool meets : {false, true}) {
    const World world(truck + others + (meets ? interest("BALL", "\"TRUCK/BOARD\"") : interest("BALL", "\"WALL\"")),
                      {"TRUCK"});
    const ObjectId of_peer = world["TRUCK"], ball = world["BALL"];
    Twins twins(world, [&](ObjectId object) { return object == of_peer ? kRemote : kScene; });
    for (const ObjectId object : {of_peer, ball}) twins.declare(object, Role::kPredicted);
    twins.advance(sim(10ms));
    twins.set_base(of_peer, sim(10ms), moving({0, 0, 0}, {4, 0, 0}));
    twins.advance_alike(ball, 16, 5000);
    EXPECT_EQ(twins.pairs.pairs_put_off(), meets ? 0u : 1u);
    EXPECT_EQ(twins.agree_on(of_peer), meets);
    EXPECT_EQ(twins.some.at(ball, twins.now).velocity.x() < -1.0, meets);
  }
}

// The numbers of part pairs change, and with a new carrier in the room the ball meets the rest of it anew.
TEST(UnseenPairs, AnotherModelHasWhatWasPutOffUnderTheLastOne) {
  const World world(box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces) + "DEF ROOM Group { children [ " +
                    box("LEFT", "1 50 50", "-3.75 0 0") + box("RIGHT", "1 50 50", "3.75 0 0") +
                    box("LAMP", "1 1 1", "0 9 0") + "] }\n" + interest("BALL", "\"ROOM\""));
  const ObjectId ball = world["BALL"], lamp = world["ROOM/LAMP"];
  Twins twins(world, [&](ObjectId object) { return object == ball || object == lamp ? kRemote : kScene; });
  twins.declare(ball, Role::kPredicted);
  twins.advance(sim(1s));
  twins.set_base(ball, sim(1s), moving({0, 0, 0}, {2, 0, 0}));
  twins.advance(sim(4s));
  EXPECT_FALSE(twins.some.stopped().empty());
  EXPECT_FALSE(twins.agree_on(ball));
  const auto next = extended(*world.model, {{lamp}});
  ASSERT_GT(next->part_pairs.size(), world.model->part_pairs.size());
  twins.change_model(*next);
  twins.advance(sim(4016ms));
  EXPECT_TRUE(twins.agree_on(ball));
  EXPECT_EQ(twins.pairs.pairs_put_off(), next->part_pairs.size());
  twins.advance(sim(7s));
  EXPECT_FALSE(twins.agree_on(ball)) << "it goes on as before";
  twins.sees = [](const Vec3&, double) { return true; };
  twins.advance(sim(7016ms));
  EXPECT_TRUE(twins.agree_on(ball));
}

// The oracle is the world that puts nothing off: bodies bounce about in a room, one of them is kept, and their owners
// publish them now and then. A ball-shaped region is looked at, which jumps.
struct RoomCase {
  int seed;
  int free = 0;  // so many of the bodies are nobody's
};
class UnseenRoom : public testing::TestWithParam<RoomCase> {};
TEST_P(UnseenRoom, KeptAndSeenStatesAreThoseOfAWorldThatPutsNothingOff) {
  constexpr int kBodies = 10;
  std::mt19937_64 rng(static_cast<std::uint64_t>(GetParam().seed));
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
  };
  std::string text, names;
  for (int i = 0; i < kBodies; ++i) names += " \"B" + std::to_string(i) + "\"";
  const auto place = [&] { return Vec3(between(-55, 55), 0, between(-55, 55)); };
  for (int i = 0; i < kBodies; ++i) {
    const std::string name = "B" + std::to_string(i);
    text += box(name, "1 1 1", std::to_string(12 * i - 54) + " 0 " + std::to_string(-50 + 9 * i),
                "collisionResponse CollisionResponse { responseType 2 mass " + std::to_string(1 + i % 3) + " }");
    std::string others = names;
    others.replace(others.find(" \"" + name + "\""), name.size() + 3, "");
    text += interest(name, others + " \"N\" \"S\" \"E\" \"W\"");
  }
  text += box("N", "120 1 1", "0 0 -60") + box("S", "120 1 1", "0 0 60") + box("E", "1 1 120", "60 0 0") +
          box("W", "1 1 120", "-60 0 0");
  const World world(text);
  const ObjectId mine = world["B0"];
  std::vector<ObjectId> bodies;
  for (int i = 0; i < kBodies; ++i) bodies.push_back(world["B" + std::to_string(i)]);
  Twins twins(world, [&](ObjectId object) {
    if (object == mine) return kKept;
    const auto at = std::ranges::find(bodies, object);
    if (at == bodies.end()) return kScene;
    return bodies.end() - at <= GetParam().free ? kFree : kRemote;
  });
  Vec3 looks_at = place();
  constexpr double kSeen_m = 12.0;
  twins.sees = [&](const Vec3& center, double radius_m) { return (center - looks_at).norm() <= kSeen_m + radius_m; };
  for (const ObjectId body : bodies) twins.declare(body, body == mine ? Role::kAuthoritative : Role::kPredicted);
  const auto throw_body = [&](ObjectId body, SimTime t) {
    const Vec3 from = twins.all.at(body, t).position;
    twins.set_base(body, t, moving(from, {between(-8, 8), 0, between(-8, 8)}));
  };
  twins.advance(sim(10ms));
  for (const ObjectId body : bodies) throw_body(body, sim(10ms));
  std::uint64_t seen = 0, wrong_unseen = 0;
  for (int tick = 1; tick < 1500; ++tick) {
    const SimTime t = sim(std::chrono::milliseconds(10 + 16 * tick));
    twins.advance(t);
    ASSERT_TRUE(twins.agree_on(mine)) << tick;
    for (const ObjectId body : bodies) {
      const bool in_sight = (twins.all.at(body, t).position - looks_at).norm() < kSeen_m;
      seen += in_sight ? 1 : 0;
      ASSERT_TRUE(!in_sight || twins.agree_on(body)) << tick << ", " << body.number;
      wrong_unseen += twins.agree_on(body) ? 0 : 1;
    }
    if (tick % 40 == 0) looks_at = place();
    // What an owner publishes is of a little before it arrives.
    const ObjectId body = bodies[1 + rng() % (kBodies - 1)];
    if (tick % 10 == 0) throw_body(body, t - std::chrono::milliseconds(rng() % 100));
  }
  EXPECT_GT(seen, 50u);
  EXPECT_GT(wrong_unseen, 0u) << "all was computed";
  EXPECT_LT(twins.some.counters().contact_searches, twins.all.counters().contact_searches);
}
std::vector<RoomCase> rooms() {
  std::vector<RoomCase> all;
  for (const int free : {0, 3}) {
    for (int seed = 1; seed < 9; ++seed) all.push_back({seed, free});
  }
  return all;
}
INSTANTIATE_TEST_SUITE_P(Seeds, UnseenRoom, testing::ValuesIn(rooms()), [](const auto& room) {
  return "Seed" + std::to_string(room.param.seed) + "With" + std::to_string(room.param.free) + "OfNobody";
});

}  // namespace
}  // namespace peerd::replication::unseen_pairs_test
