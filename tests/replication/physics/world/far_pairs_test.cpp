#include "replication/physics/world/far_pairs.hpp"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

#include "replication/physics/world/motion_world.hpp"
#include "tests/must.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::far_pairs_test {

using namespace test;

// Returns the collidees of all contacts, in order of time.
std::vector<ObjectId> take_met(MotionWorld& world) {
  std::vector<ObjectId> met;
  for (const ContactEvent& contact : contacts_of(world)) met.push_back(contact.collidee);
  return met;
}

// CAR among posts, 20 m apart along x.
std::string street(int posts) {
  std::string text = box("CAR", "2 1 1", "0 0 0"), all;
  for (int i = 0; i < posts; ++i) {
    const std::string name = "P" + std::to_string(i);
    text += box(name, "1 1 1", std::to_string(20 * i + 10) + " 0 5");
    all += " \"" + name + '"';
  }
  return text + interest("CAR", all);
}

// Drives CAR along x at 10 m/s for so long, with a sample at each of 60 ticks a second.
MotionWorld::Counters drive(int posts, double seconds) {
  auto&& [w, world] = Started(street(posts), {{"CAR", Role::kDriven}});
  for (int tick = 0; tick < 60 * seconds; ++tick) {
    const SimTime t = sim(Duration{1s} * tick / 60);
    world.set_base(w["CAR"], t, moving({10.0 * tick / 60.0, 0, 0}, {10, 0, 0}));
    world.advance(t);
  }
  return world.counters();
}

TEST(FarPairs, AreNotCheckedAtEachSampleOfADrivenObject) {
  const std::uint64_t few = drive(20, 3.0).searches_far, many = drive(400, 3.0).searches_far;
  EXPECT_LT(many, 400U * 180 / 20) << "of 400 pairs and 180 samples";
  EXPECT_EQ(few, many) << "the further ones are far from all its places";
}

// Returns how many searches of pairs it takes to move CAR along x at 10 m/s for 40 s, by one law.
std::uint64_t searches_of_a_passage(int posts) {
  auto&& [w, world] = Started(street(posts), {{"CAR", Role::kPredicted, moving({0, 0, 0}, {10, 0, 0})}});
  for (Duration t{0}; t <= 40s; t += 10ms) world.advance(sim(t));
  return world.counters().searches_far;
}

// CAR comes to none of the posts that the longer street has more. Opening all pairs at each place that it leaves takes
// 33 searches of each of them.
TEST(FarPairs, AreSearchedOnceWhereTheyStayFarFromAllPlaces) {
  const std::uint64_t few = searches_of_a_passage(50), many = searches_of_a_passage(400);
  EXPECT_LE(many, few + 350);
}

// Ten that fly side by side, 1 km apart, and leave their places at the same instants.
TEST(FarPairs, StayFarWhereBothLeaveTheirPlacesAtOnce) {
  static constexpr const char* kNames[] = {"A", "B", "C", "D", "E", "F", "G", "H", "I", "J"};
  std::string text, before;
  std::vector<Started::Mover> movers;
  for (int i = 0; i < 10; ++i) {
    text += box(kNames[i], "1 1 1", "0 0 " + std::to_string(1000 * i));
    if (i > 0) text += interest(kNames[i], before);
    before += std::string(" \"") + kNames[i] + '"';
    movers.push_back({kNames[i], Role::kPredicted, moving({0, 0, 1000.0 * i}, {10, 0, 0})});
  }
  auto&& [w, world] = Started(text, movers);
  for (Duration t{0}; t <= 40s; t += 10ms) world.advance(sim(t));
  ASSERT_EQ(world.known_pairs().size(), 45U);
  EXPECT_LE(world.counters().searches_far, 2 * 45U);
}

TEST(FarPairs, AreNotKeptUnlessTheyHaveTouchedLately) {
  const World w(street(2));
  MovingObjects objects(*w.model, sim(0s));
  WatchedPairs pairs(*w.model);
  for (const std::uint32_t number : {0U, 1U}) add_pairs(pairs, *w.model, number, sim(0s), true);
  FarPairs far(*w.model, sim(0s), objects);
  pairs[1].touched = sim(1s);
  ASSERT_TRUE(far.add(0, sim(5s), sim(2s), objects, pairs));
  ASSERT_TRUE(far.add(1, sim(5s), sim(1s), objects, pairs));
  EXPECT_FALSE(pairs.contains(0));
  EXPECT_TRUE(pairs.contains(1));
  const WatchedPair& made = far.known(0, sim(4s), pairs);
  EXPECT_TRUE(made.watched);
  EXPECT_TRUE(made.is_far);
  EXPECT_EQ(made.clear_until, sim(4s));
  std::vector<std::uint32_t> opened;
  far.open(pairs, opened);
  std::ranges::sort(opened);
  EXPECT_EQ(opened, (std::vector{0U, 1U}));
  ASSERT_TRUE(far.add(1, sim(5s), sim(2s), objects, pairs));
  EXPECT_FALSE(pairs.contains(1)) << "nothing looks back to 1 s any more";
}

// A far pair that has touched is forgotten once nothing looks back to that time.
TEST(FarPairs, ForgetTheirTouchesInTime) {
  const World w(street(1));
  MovingObjects objects(*w.model, sim(0s));
  WatchedPairs pairs(*w.model);
  add_pairs(pairs, *w.model, 0, sim(0s), true);
  FarPairs far(*w.model, sim(0s), objects);
  pairs[0].touched = sim(4s);
  ASSERT_TRUE(far.add(0, sim(5s), sim(2s), objects, pairs));
  far.forget_before(sim(4s), pairs);
  EXPECT_TRUE(pairs.contains(0));
  far.forget_before(sim(6s), pairs);
  EXPECT_FALSE(pairs.contains(0));
}

TEST(FarPairs, CostNothingWhereNothingMoves) {
  auto&& [w, world] = Started(street(50), {{"CAR", Role::kPredicted}});
  world.advance(sim(1s));
  const MotionWorld::Counters before = world.counters();
  for (int tick = 60; tick < 240; ++tick) world.advance(sim(Duration{1s} * tick / 60));
  EXPECT_EQ(world.counters().searches_far, before.searches_far);
  EXPECT_EQ(world.counters().contact_searches, before.contact_searches);
}

// The contacts of A, at 1 m/s, with B, 100 m away, after an update at 2 s says that at 0.5 s it was on its way to 148
// m.
std::vector<SimTime> met_in_the_past(Role of_b) {
  auto&& [w, world] = Started(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "100 0 0") + interest("A", "\"B\""),
                              {{"A", Role::kPredicted}});
  world.declare(w["B"], of_b);
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}, {1, 0, 0}));
  for (int tick = 0; tick <= 120; ++tick) world.advance(sim(Duration{1s} * tick / 60));
  world.set_base(w["A"], sim(500ms), moving({50, 0, 0}, {98, 0, 0}));
  world.advance(sim(3s));
  return contact_times(world);
}

TEST(FarPairs, AreOpenedByAnUpdateOfTheTimeBeforeTheyWereFar) {
  EXPECT_NEAR(to_seconds(only(met_in_the_past(Role::kScene)) - sim(0s)), 1.0, 1e-6);
  EXPECT_TRUE(met_in_the_past(Role::kDriven).empty()) << "what this peer moves meets nothing in the past";
}

// B bounces off A at 1 s and flies away, so that the two become far. Then an update says that A was not there.
TEST(FarPairs, TakeBackWhatTheyMetBeforeTheyWereFar) {
  auto&& [w, world] =
      Started(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "5 0 0", kBounces) + interest("B", "\"A\""),
              {{"A", Role::kPredicted}, {"B", Role::kPredicted, moving({5, 0, 0}, {-4, 0, 0})}});
  const auto advance_until = [&](Duration until) {
    for (Duration t = until - 1s; t <= until; t += 10ms) world.advance(sim(t));
  };
  for (const Duration until : {1s, 2s, 3s, 4s}) advance_until(until);
  const std::uint64_t checks = world.counters().searches_far;
  advance_until(5s);
  EXPECT_LE(world.counters().searches_far, checks + 1) << "the two are far, and nobody checks them";
  EXPECT_NEAR(world.at(w["B"], sim(5s)).position.x(), 17.0, 1e-5) << "bounced at 1 m";
  (void)events_of(world);

  world.set_base(w["A"], sim(500ms), moving({2, 20, 0}));
  world.advance(sim(5s));
  EXPECT_EQ(world.at(w["B"], sim(5s)).position, Vec3(-15, 0, 0));
  bool retracted = false;
  while (const auto event = world.poll_event()) {
    EXPECT_FALSE(std::holds_alternative<ContactEvent>(*event));
    if (const auto* back = std::get_if<ContactsRetracted>(&*event)) {
      retracted = retracted || back->retracts(sim(1s), w["B"], w["A"]);
    }
  }
  EXPECT_TRUE(retracted);
}

// Three boxes of which one is below a node that becomes a carrier later: what is far is so still, what has been
// answered can be retracted, though all indices change.
TEST(FarPairs, OutliveAChangeOfTheModel) {
  auto&& [w, world] =
      Started(box_with("BUS", "8 0.2 3", "0 9 0", "", box("DOOR", "1 2 0.1", "0 1 1.5")) + box("A", "1 1 1", "0 0 0") +
                  box("B", "1 1 1", "5 0 0", kBounces) + box("C", "1 1 1", "100 0 0") +
                  interest("B", "\"A\" \"C\" \"BUS\"") + interest("A", "\"C\" \"BUS\""),
              {{"A", Role::kPredicted}, {"B", Role::kPredicted, moving({5, 0, 0}, {-4, 0, 0})}});
  world.advance(sim(2s));
  EXPECT_GT(world.at(w["B"], sim(2s)).position.x(), 4.5) << "bounced at 1 s";
  const auto next = extended(*w.model, std::vector{w["BUS"], w["DOOR"]});
  ASSERT_GT(next->nodes.size(), w.model->nodes.size());
  world.change_model(*next);
  world.set_base(w["A"], sim(500ms), moving({2, 20, 0}));
  world.advance(sim(3s));
  EXPECT_EQ(world.at(w["B"], sim(3s)).position, Vec3(-7, 0, 0)) << "A was not there";
  (void)events_of(world);
  world.set_base(w["A"], sim(3s), moving({2, 20, 0}, {49, -10, 0}));  // meets C
  world.advance(sim(6s));
  EXPECT_EQ(take_met(world), std::vector{w["C"]});
}

void watch_all(MotionWorld& world) {
  world.watch_by([](const CollisionPair&) { return true; });
}

using Found = std::tuple<SimTime, ObjectId, ObjectId, double, double>;
// Twelve bodies that bounce in pairs of all with all; updates, some of the past, send them hither and thither.
std::vector<Found> run(const World& w, std::uint64_t seed, Duration step,
                       MotionWorld::Watched first = MotionWorld::Watched::kAll) {
  std::mt19937_64 rng(seed);
  const auto draw = [&](int most) { return static_cast<double>(rng() % 2001) / 1000.0 * most - most; };
  MotionWorld world(*w.model, sim(0s), first);
  watch_all(world);
  std::vector<ObjectId> objects;
  for (int i = 0; i < 12; ++i) objects.push_back(w["O" + std::to_string(i)]);
  for (const ObjectId o : objects) world.declare(o, Role::kPredicted);
  std::vector<Found> found;
  for (Duration t{0}; t <= 12s; t += 100ms) {
    for (Duration at = t - 100ms + step; at < t; at += step) world.advance(sim(std::max(at, Duration{0})));
    world.advance(sim(t));
    const ObjectId o = objects[rng() % objects.size()];
    const Vec3 velocity(draw(30), 0, draw(30));
    const SimTime of = sim(std::max(Duration{0}, t - std::chrono::milliseconds(rng() % 300)));
    world.set_base(o, of, moving(world.at(o, of).position, velocity));
  }
  world.advance(sim(13s));
  std::vector<ContactEvent> left;
  (void)standing(world, left);
  for (const ContactEvent& c : left) {
    found.emplace_back(c.at, c.collider, c.collidee, c.collider_after.position.x(), c.collider_after.velocity.x());
  }
  std::ranges::sort(found);
  for (const ObjectId o : objects) {
    const KinematicState s = world.at(o, sim(13s));
    found.emplace_back(sim(13s), o, o, s.position.x(), s.position.z());
  }
  return found;
}

// Twelve bodies that bounce, 8 m apart, and interests in all pairs.
std::string twelve() {
  std::string text;
  for (int i = 0; i < 12; ++i) {
    const std::string name = "O" + std::to_string(i);
    text += box(name, "2 2 2", std::to_string(8 * (i % 4)) + " 0 " + std::to_string(8 * (i / 4)), kBounces);
  }
  for (int i = 0; i < 12; ++i) {
    std::string others;
    for (int k = 0; k < 12; ++k) others += k == i ? "" : " \"O" + std::to_string(k) + '"';
    text += interest("O" + std::to_string(i), others);
  }
  return text;
}

TEST(FarPairs, GiveTheSameContactsHoweverOftenTheWorldAdvances) {
  const World w(twelve());
  std::size_t met = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Found> often = run(w, seed, 5ms), seldom = run(w, seed, 100ms);
    EXPECT_EQ(often, seldom) << "seed " << seed;
    met += often.size() - 12;
  }
  EXPECT_GT(met, 100U);
}

// Returns the contacts of twelve bodies that fly in a closed room for 12 s; each call of advance() goes on by `step`.
std::vector<Found> fly(const World& w, std::uint64_t seed, Duration step) {
  std::mt19937_64 rng(seed);
  const auto draw = [&] { return static_cast<double>(rng() % 2001) / 1000.0 * 8.0 - 8.0; };
  MotionWorld world(*w.model, sim(0s));
  std::vector<ObjectId> objects;
  for (int i = 0; i < 12; ++i) objects.push_back(w["O" + std::to_string(i)]);
  for (const ObjectId o : objects) world.declare(o, Role::kAuthoritative);
  for (const ObjectId o : objects) {
    world.set_base(o, sim(0s), moving(world.at(o, sim(0s)).position, {draw(), 0, draw()}));
  }
  for (Duration t = step; t <= 12s; t += step) world.advance(sim(t));
  std::vector<Found> found;
  for (const ContactEvent& c : contacts_of(world)) {
    found.emplace_back(c.at, c.collider, c.collidee, c.collider_after.position.x(), c.collider_after.velocity.x());
  }
  return found;
}

TEST(FarPairs, GiveTheSameContactsInACallOfManySeconds) {
  std::string walls;
  walls += box("W0", "2 50 50", "-7 0 8") + box("W1", "2 50 50", "31 0 8");
  walls += box("W2", "60 50 2", "12 0 -7") + box("W3", "60 50 2", "12 0 23");
  for (int i = 0; i < 12; ++i) walls += interest("O" + std::to_string(i), R"("W0" "W1" "W2" "W3")");
  const World w(twelve() + walls);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::vector<Found> often = fly(w, seed, 5ms);
    EXPECT_GT(often.size(), 50U);
    EXPECT_EQ(often, fly(w, seed, 3s)) << "seed " << seed;
  }
}

// A's update comes late: by what it says A flew through B, which has gone on since then.
TEST(FarPairs, OfAnOwnObjectMeetNothingInItsPast) {
  auto&& [w, world] =
      Started(box("A", "1 1 1", "0 9 0") + box("B", "1 1 1", "0 0 0", kBounces) + interest("B", "\"A\""),
              {{"A", Role::kPredicted}, {"B", Role::kAuthoritative, moving({0, 0, 0}, {0.1, 0, 0})}});
  for (int tick = 0; tick <= 120; ++tick) world.advance(sim(Duration{1s} * tick / 60));
  world.set_base(w["A"], sim(1s), moving({0.1, 5, 0}, {0, -10, 0}));
  world.advance(sim(3s));
  EXPECT_TRUE(contact_times(world).empty());
  EXPECT_NEAR(world.at(w["B"], sim(3s)).position.x(), 0.3, 1e-12);
}

TEST(WaitingPairs, GiveTheSameContactsAsThoseThatWereWatchedAllTheTime) {
  const World w(twelve());
  std::size_t met = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Found> all = run(w, seed, 100ms), waiting = run(w, seed, 100ms, MotionWorld::Watched::kNone);
    EXPECT_EQ(waiting, all) << "seed " << seed;
    met += all.size() - 12;
  }
  EXPECT_GT(met, 100U);
}

class WaitingPair : public testing::Test {
 protected:
  WaitingPair() { watch_all(world); }

  World w{box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "10 0 0") + interest("A", "\"B\"")};
  MotionWorld world{*w.model, sim(0s), MotionWorld::Watched::kNone};
};

TEST_F(WaitingPair, IsNotThereUntilOneOfTheTwoMoves) {
  world.declare(w["A"], Role::kPredicted);
  world.advance(sim(1s));
  EXPECT_TRUE(world.known_pairs().empty());
  EXPECT_TRUE(world.objects().empty()) << "nobody has asked for them either";
  world.set_base(w["A"], sim(1s), moving({0, 0, 0}, {3, 0, 0}));
  EXPECT_EQ(world.known_pairs().size(), 1u);
  world.advance(sim(3s));
  EXPECT_TRUE(take_met(world).empty());
  world.advance(sim(5s));
  EXPECT_EQ(take_met(world), std::vector{w["B"]});
  EXPECT_LT(world.at(w["A"], sim(5s)).velocity.x(), 0.0);
}

// A peer sets its own objects at rest where they are as it enters the session.
TEST_F(WaitingPair, IsNamedWhereTheFirstWayOfOneOfTheTwoBeginsInTheOther) {
  world.declare(w["A"], Role::kAuthoritative);
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}));
  world.advance(sim(1s));
  world.set_base(w["A"], sim(1s), moving({9.5, 0, 0}, {1, 0, 0}));
  world.advance(sim(2s));
  std::size_t named = 0;
  while (const auto event = world.poll_event()) named += std::holds_alternative<BodiesOverlap>(*event) ? 1 : 0;
  EXPECT_EQ(named, 1u);
}

TEST_F(WaitingPair, MeetsNothingOnceItIsNotWatched) {
  world.watch_by([](const CollisionPair&) { return false; });
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}, {3, 0, 0}));
  world.advance(sim(15s));
  EXPECT_TRUE(world.known_pairs().empty());
  EXPECT_TRUE(take_met(world).empty());
}

TEST_F(WaitingPair, WaitsOnBeyondAChangeOfTheModel) {
  world.advance(sim(1s));
  const auto next = extended(*w.model, {});
  world.change_model(*next);
  EXPECT_TRUE(world.known_pairs().empty());
  EXPECT_TRUE(world.objects().empty());
  world.declare(w["A"], Role::kPredicted);
  world.set_base(w["A"], sim(1s), moving({0, 0, 0}, {3, 0, 0}));
  world.advance(sim(5s));
  EXPECT_EQ(take_met(world), std::vector{w["B"]});
}

// Two whose boxes may overlap in the file are there from the begin on.
TEST(WaitingPairs, AreNoneThatMayTouchInTheFileOrHaveMoved) {
  const World near(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "1.5 0 0") + interest("A", "\"B\""));
  MotionWorld touching(*near.model, sim(0s), MotionWorld::Watched::kNone);
  watch_all(touching);
  EXPECT_EQ(touching.known_pairs().size(), 1u) << "their boxes may touch, however they turn";
  const World far(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "9 0 0") + interest("A", "\"B\""));
  MotionWorld moved(*far.model, sim(0s), MotionWorld::Watched::kNone);
  moved.set_base(far["A"], sim(0s), moving({0, 0, 0}, {1, 0, 0}));
  watch_all(moved);
  EXPECT_EQ(moved.known_pairs().size(), 1u);
}

// The same interests by name, and by group.
TEST(FarPairs, OfAGroupMeetAsThoseThatAreListed) {
  std::string bodies;
  for (int i = 0; i < 12; ++i) {
    bodies += box("O" + std::to_string(i), "2 2 2", std::to_string(8 * (i % 4)) + " 0 " + std::to_string(8 * (i / 4)),
                  kBounces);
  }
  const World listed(twelve()), grouped(bodies + interest("O*", "\"O*\""));
  ASSERT_TRUE(listed.model->groups.empty());
  ASSERT_EQ(grouped.model->groups.size(), 1U);
  std::size_t met = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Found> all = run(listed, seed, 100ms);
    EXPECT_EQ(run(grouped, seed, 100ms), all) << "seed " << seed;
    met += all.size() - 12;
  }
  EXPECT_GT(met, 100U);
}

// A pair that nobody watches is forgotten where its two are far from each other, and watched once the rule says so.
TEST(FarPairs, ThatNobodyWatchesAreNotKept) {
  const World w(street(40));
  MotionWorld world(*w.model, sim(0s), MotionWorld::Watched::kNone);
  world.set_base(w["CAR"], sim(0s), moving({0, 0, 5}, {10, 0, 0}));
  for (Duration t{0}; t <= 30s; t += 100ms) world.advance(sim(t));
  EXPECT_LE(world.known_pairs().size(), 2U) << "those that CAR is near now";
  EXPECT_TRUE(contacts_of(world).empty());
  watch_all(world);
  world.advance(sim(32s));
  EXPECT_FALSE(contacts_of(world).empty());
}

// A passed B while nobody watched the two. An update that comes late says that B drifted towards A then, without
// leaving its place.
TEST(FarPairs, ThatNobodyWatchedAreFoundByALateLaw) {
  const World w(box("A", "1 1 1", "-2 0 0", kBounces) + box("B", "1 1 1", "0 1.04 0") + interest("A", "\"B\""));
  MotionWorld world(*w.model, sim(0s), MotionWorld::Watched::kNone);
  for (const char* name : {"A", "B"}) world.declare(w[name], Role::kPredicted);
  world.set_base(w["A"], sim(0s), moving({-2, 0, 0}, {4, 0, 0}));
  world.set_base(w["B"], sim(0s), moving({0, 1.04, 0}, {0.1, 0, 0}));
  for (Duration t{0}; t <= 3s; t += 50ms) world.advance(sim(t));
  watch_all(world);
  world.set_base(w["B"], sim(300ms), moving({0.03, 1.04, 0}, {0, -0.16, 0}));
  world.advance(sim(3100ms));
  const std::vector<SimTime> met = contact_times(world);
  ASSERT_FALSE(met.empty());
  EXPECT_NEAR(to_seconds(met.front() - sim(0s)), 0.55, 1e-6);
}

// A has moved while nobody watched the pair, so the pair is known as soon as somebody watches it.
TEST(WaitingPairs, AreKnownOnceTheyAreWatched) {
  const World w(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "90 0 0") + interest("A", "\"B\""));
  MotionWorld world(*w.model, sim(0s), MotionWorld::Watched::kNone);
  EXPECT_TRUE(world.known_pairs().empty());
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}, {1, 0, 0}));
  world.advance(sim(1s));
  EXPECT_TRUE(world.known_pairs().empty());
  watch_all(world);
  EXPECT_EQ(world.known_pairs().size(), 1U);
}

void advance_in_ticks(MotionWorld& world, SimTime from, SimTime to) {
  for (SimTime t = from; t < to; t += 10ms) world.advance(t);
  world.advance(to);
}

// A bounces off B at 1 s. C runs into it from behind while the two are far from each other, or not yet.
std::vector<Found> struck_from_behind(const World& w, std::uint64_t seed, Duration step) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  MotionWorld world(*w.model, sim(0s));
  world.declare(w["A"], Role::kPredicted);
  world.declare(w["C"], Role::kDriven);
  const double v = 1.0 + 5.0 * unit(rng), hit_s = 3.2 + 0.55 * unit(rng), v_c = v * (2.0 + 5.0 * unit(rng));
  world.set_base(w["A"], sim(0s), moving({1.0 + v, 0, 0}, {-v, 0, 0}));
  world.set_base(w["C"], sim(0s), moving({2.0 + v * (hit_s - 1.0) + v_c * hit_s, 0, 0}, {-v_c, 0, 0}));
  for (Duration t = step; t <= 3990ms; t += step) world.advance(sim(t));
  std::vector<Found> found;
  for (const ContactEvent& c : contacts_of(world)) {
    found.emplace_back(c.at, c.collider, c.collidee, c.collider_after.position.x(), c.collider_after.velocity.x());
  }
  return found;
}

TEST(FarPairs, AreSearchedFromWhereTheyLeaveTheirPlacesHoweverFarOneCallAdvances) {
  const World w(box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "0 0 0") + box("C", "1 1 1", "50 0 0") +
                box("P", "1 1 1", "0 1000 0") + interest("A", R"("B" "C" "P")"));
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    ASSERT_EQ(struck_from_behind(w, seed, 3990ms), struck_from_behind(w, seed, 5ms)) << "seed " << seed;
  }
}

// A flies away from B and is far from it, when an update says that it was in it at 9.1 s.
struct BackInto {
  BackInto()
      : w(box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "1.5 0 0") + interest("A", "\"B\"")),
        world(*w.model, sim(0s)) {
    world.declare(w["A"], Role::kPredicted);
    world.set_base(w["A"], sim(0s), moving({0, 0, 0}, {-3, 0, 0}));
    advance_in_ticks(world, sim(0s), sim(10s));
    world.set_base(w["A"], sim(9100ms), moving({1.2, 0, 0}, {1, 0, 0}));
    world.advance(sim(11s));
  }
  World w;
  MotionWorld world;
};

TEST(FarPairs, AreSetBackToWhereTheyWereApartLast) {
  BackInto back;
  const auto met = only(contacts_of(back.world));
  EXPECT_EQ(met.at, sim(9100ms));
  EXPECT_EQ(met.collider_after.position.x(), -3.0 * 9.0)
      << "checks are at multiples of 250 ms: the last one before is at 9.0 s";
}

TEST(FarPairs, AreNotNamedAsBegunInEachOtherOnceTheyHaveBeenApart) {
  BackInto back;
  std::size_t named = 0;
  while (const auto event = back.world.poll_event()) named += std::holds_alternative<BodiesOverlap>(*event) ? 1 : 0;
  EXPECT_EQ(named, 0U) << "the two have been apart";
}

// Its first law comes late, and would have led it into B, which this peer moves, before now.
TEST(WaitingPairs, MeetNothingInThePastOfWhatThisPeerMoves) {
  for (const auto first : {MotionWorld::Watched::kAll, MotionWorld::Watched::kNone}) {
    const World w(box("A", "1 1 1", "0 0 90") + box("B", "1 1 1", "0 0 0", kBounces) + interest("B", "\"A\""));
    MotionWorld world(*w.model, sim(0s), first);
    watch_all(world);
    world.declare(w["A"], Role::kPredicted);
    world.declare(w["B"], Role::kAuthoritative);
    for (Duration t{0}; t <= 2s; t += 10ms) world.advance(sim(t));
    world.set_base(w["A"], sim(1s), moving({0, 0, 20}, {0, 0, -20}));
    world.advance(sim(3s));
    const auto met = contacts_of(world);
    ASSERT_FALSE(met.empty());
    EXPECT_GE(met.front().at, sim(2s));
  }
}

// A is a box, and a part that grows.
TEST(FarPairs, OfAnEndWithAFlexiblePartAreFoundInEach) {
  const World w("DEF A Transform { children [ Shape { geometry Box { size 1 1 1 } } " + box("GROWS", "1 1 1", "0 3 0") +
                    " ] }\n" + box("WALL", "1 1 1", "20 0 0") + interest("A", "\"WALL\"") + kGrows,
                {"A", "WALL"});
  ASSERT_GT(w.model->part_pairs.size(), 1U);
  FlexibleParts flexible(*w.model);
  flexible.set_world_zero(sim(0s));
  MotionWorld world(*w.model, sim(0s));
  world.set_flexible(flexible);
  world.declare(w["A"], Role::kPredicted);
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}, {1, 0, 0}));
  for (Duration t{0}; t <= 25s; t += 100ms) world.advance(sim(t));
  EXPECT_EQ(only(contacts_of(world)).at, sim(19s));
}

constexpr const char* kElastic = " collisionResponse CollisionResponse { responseType 2 restitution 1 } ";

// A wall and a press that comes at 1 m/s from -52 m on: what an update puts between them, at -50 m and 1.0003 s, has
// 0.1 mm of room on either side, and there is none left 0.2 ms later.
std::string vice(const std::string& object) {
  return box("WALL", "1 1 1", "-48.9999 500 0") + box("PRESS", "1 1 1", "-52.0004 500 0") +
         interest(object, "\"WALL\" \"PRESS\"");
}

// A lift kicks B upwards at 1 s, and C runs into B 0.2 ms later, so that B flies away from both. An update, which comes
// when B and LIFT are far, says that C was in a vice 0.1 ms after that. What has no room there touches, by way of B,
// the lift, and that gives way to nothing either.
struct Kicked {
  explicit Kicked(Duration update_comes)
      : w(box("B", "1 1 1", "0 0 0", kElastic) + box("C", "1 1 1", "-101.02 0 0", kElastic) +
          box("LIFT", "10 1 10", "0 -11 0") + interest("B", "\"LIFT\" \"C\" \"END\"") + interest("C", "\"B\"") +
          box("END", "1 999 999", "701 0 0") + vice("C")),
        world(*w.model, sim(0s)) {
    for (const char* path : {"B", "C", "LIFT", "PRESS"}) world.declare(w[path], Role::kPredicted);
    world.set_base(w["LIFT"], sim(0s), moving({0, -11, 0}, {0, 10, 0}));
    world.set_base(w["C"], sim(0s), moving({-101.02, 0, 0}, {100, 0, 0}));
    world.set_base(w["PRESS"], sim(0s), moving({-52.0004, 500, 0}, {1, 0, 0}));
    advance_in_ticks(world, sim(0s), sim(update_comes));
    jammed_before = world.counters().jammed;
    world.set_base(w["C"], sim(1'000'300us), moving({-50, 500, 0}));
    advance_in_ticks(world, sim(update_comes), sim(9s));
    std::ranges::copy_if(contacts_of(world), std::back_inserter(met),
                         [&](const ContactEvent& c) { return c.collider == w["B"]; });
  }
  World w;
  MotionWorld world;
  std::uint64_t jammed_before = 0;
  std::vector<ContactEvent> met;  // by B
};

TEST(FarPairs, StayFarWhereThePastIsSqueezedThroughThem) {
  const Kicked in_time(1'000'300us), late(4s);
  for (const Kicked* k : {&in_time, &late}) {
    EXPECT_EQ(k->jammed_before, 0U);
    EXPECT_GE(k->world.counters().jammed, 1U);
    ASSERT_EQ(k->met.size(), 3U);
    EXPECT_EQ(k->met[0].collidee, k->w["LIFT"]);
    EXPECT_EQ(k->met[1].collidee, k->w["C"]);
    EXPECT_EQ(k->met[2].collidee, k->w["END"]);
    EXPECT_NEAR(to_seconds(k->met[2].at - sim(0s)), 8.0, 1e-3);
  }
  EXPECT_TRUE(same_bits(in_time.world.at(in_time.w["B"], sim(9s)), late.world.at(late.w["B"], sim(9s))));
}

// B has met a lift, and a light barrier that goes ahead of it, when an update says that it was in a vice, far from
// both. It stops at the wall, and what presses it goes through it; the two that are far do not.
TEST(FarPairs, AreNoneThatPressWhatIsHeldAtAWall) {
  auto&& [w, world] = Started(box("B", "1 1 1", "0 0 0", kBounces) + box("LIFT", "10 1 10", "0 -11 0") +
                                  box("LIGHT", "10 1 10", "0 -10.999 0") + interest("B", "\"LIFT\"") +
                                  interest("LIGHT", "\"B\"") + vice("B"),
                              {{"B", Role::kPredicted},
                               {"LIFT", Role::kPredicted, moving({0, -11, 0}, {0, 10, 0})},
                               {"LIGHT", Role::kPredicted},
                               {"PRESS", Role::kPredicted}});
  world.set_base(w["LIGHT"], sim(0s), moving({0, -10.999, 0}, {0, 10, 0}));  // 0.1 ms earlier
  world.set_base(w["PRESS"], sim(0s), moving({-52.0004, 500, 0}, {1, 0, 0}));
  advance_in_ticks(world, sim(0s), sim(1'000'200us));
  EXPECT_EQ(world.counters().contacts, 2U);
  world.set_base(w["B"], sim(1'000'300us), moving({-50, 500, 0}));
  advance_in_ticks(world, sim(1'000'300us), sim(1'100ms));
  EXPECT_GE(world.counters().jammed, 1U);
  EXPECT_NEAR(world.at(w["B"], sim(1'100ms)).position.x(), -49.9999, 1e-5) << "at the wall";
  (void)events_of(world);
  // A later update puts the two below B again, 1 s away.
  world.set_base(w["LIFT"], sim(1'200ms), moving({-50, 489, 0}, {0, 10, 0}));
  world.set_base(w["LIGHT"], sim(1'200ms), moving({-50, 489.001, 0}, {0, 10, 0}));
  advance_in_ticks(world, sim(1'200ms), sim(2'300ms));
  std::vector<ObjectId> met;
  for (const ContactEvent& c : contacts_of(world)) met.push_back(c.collider == w["B"] ? c.collidee : c.collider);
  EXPECT_EQ(std::ranges::count(met, w["LIFT"]), 1);
  EXPECT_EQ(std::ranges::count(met, w["LIGHT"]), 1);
}

}  // namespace peerd::replication::far_pairs_test
