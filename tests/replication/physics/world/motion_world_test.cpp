#include "replication/physics/world/motion_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "tests/must.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::motion_world_test {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

// ---- contact time, not contact tick ----

TEST(MotionCounters, OfTwoWorldsAddUp) {
  using C = MotionCounters;
  constexpr std::uint64_t C::*kAll[] = {
      &C::contact_searches, &C::searches_far, &C::searches_skipped, &C::searches_put_off, &C::contacts,
      &C::contacts_undone,  &C::came_to_rest, &C::jammed,           &C::overlapped,       &C::unsupported,
      &C::failed,           &C::capped,       &C::islands};
  static_assert(sizeof(C) == (std::size(kAll) + 1) * sizeof(std::uint64_t) + sizeof(double));
  MotionCounters sum, other;
  for (std::size_t i = 0; i < std::size(kAll); ++i) {
    sum.*kAll[i] = 100 + i;
    other.*kAll[i] = 10 * i + 1;
  }
  sum.rest_energy_j = 0.25;
  other.rest_energy_j = 0.5;
  sum.largest_island = 3;
  other.largest_island = 2;
  sum += other;
  for (std::size_t i = 0; i < std::size(kAll); ++i) EXPECT_EQ(sum.*kAll[i], 101 + 11 * i) << i;
  EXPECT_EQ(sum.rest_energy_j, 0.75);
  EXPECT_EQ(sum.largest_island, 3u) << "of two worlds the greater one";
}

TEST(MotionWorld, BouncesAtTheContactTimeWhereverTicksLie) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kPredicted, moving({0, 1, 0}, {2, 0.5, 0})}});
  (void)events_of(world);
  world.advance(sim(1700ms));
  const auto seen = only(contacts_of(world));
  EXPECT_EQ(seen.at, sim(1500ms));
  EXPECT_EQ(seen.collider, w["BALL"]);
  EXPECT_EQ(seen.collidee, w["RIGHT"]);
  EXPECT_EQ(seen.normal, -Vec3::UnitX());
  EXPECT_EQ(seen.collider_before.velocity, Vec3(2, 0.5, 0));
  EXPECT_EQ(seen.collider_after.velocity, Vec3(-2, 0.5, 0));
  EXPECT_EQ(seen.collider_after.position, seen.collider_before.position) << "a touch is not set back";
  EXPECT_NEAR(world.at(w["BALL"], sim(1700ms)).position.x(), 2.6, 1e-12);
  EXPECT_NEAR(world.at(w["BALL"], sim(1300ms)).position.x(), 2.6, 1e-12);
}

// Updates as a peer's ghosts receive them, late and out of order, in a world of several movers.
struct Update {
  Duration when;  // arrives
  const char* object;
  Duration at;  // says how it moves from then on
  KinematicState state;
};
struct Lived {
  std::vector<SimTime> contacts;
  std::vector<KinematicState> states;
};
Lived live(const World& w, const std::vector<Update>& updates, const std::function<Duration(Duration)>& next_tick,
           bool replays_bases = false) {
  MotionWorld world(*w.model, sim(0s));
  if (replays_bases) world.replay_bases();
  for (const char* mover : {"BALL", "CUBE"}) world.declare(w[mover], Role::kPredicted);
  Lived lived;
  auto next = updates.begin();
  Duration now = 0s;
  while (now < 6s) {
    const Duration tick = std::min<Duration>(next_tick(now), 6s);
    for (; next != updates.end() && next->when <= tick; ++next) {
      world.advance(sim(next->when));
      world.set_base(w[next->object], sim(next->at), next->state);
    }
    world.advance(sim(tick));
    now = tick;
  }
  lived.contacts = standing(world);
  for (Duration t = 2s; t <= 6s; t += 17ms) {
    for (const char* mover : {"BALL", "CUBE"}) lived.states.push_back(world.at(w[mover], sim(t)));
  }
  return lived;
}

TEST(MotionWorld, AnyFrameRateGivesTheSameBits) {
  const World w(corridor() + box("CUBE", "0.6 0.6 0.6", "1 0 0", kBounces) +
                interest("CUBE", "\"LEFT\" \"RIGHT\" \"BALL\"") + interest("BALL", "\"CUBE\""));
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    std::vector<Update> updates = {{0s, "BALL", 0s, moving({-1, 0, 0}, {3 * u(rng), 0, 0})},
                                   {0s, "CUBE", 0s, moving({1, 0, 0}, {3 * u(rng), 0, 0}, {u(rng), 0, 0})}};
    Duration when = 0s;
    for (int i = 0; i < 8; ++i) {
      when += 300ms + seconds(0.3 * (1 + u(rng)));
      const bool ball = i % 2 == 0;
      const Duration at = when - seconds(0.15 * (1 + u(rng)));
      updates.push_back({when, ball ? "BALL" : "CUBE", at, moving({ball ? -2.0 : 2.0, 0, 0}, {2 * u(rng), 0, 0})});
    }
    const auto every = [](Duration period) { return [=](Duration t) { return t + period; }; };
    const Lived expected = live(w, updates, every(seconds(1.0 / 60)));
    EXPECT_GE(expected.contacts.size(), 1u);
    const auto same = [&](const Lived& lived) {
      return lived.contacts == expected.contacts &&
             std::ranges::equal(lived.states, expected.states,
                                [](const auto& a, const auto& b) { return same_bits(a, b); });
    };
    EXPECT_TRUE(same(live(w, updates, every(seconds(1.0 / 30)))));
    EXPECT_TRUE(same(live(w, updates, every(seconds(1.0 / 144)))));
    EXPECT_TRUE(same(live(w, updates, every(7s))));
    std::mt19937_64 ticks(seed);
    EXPECT_TRUE(same(live(w, updates, [&](Duration t) { return t + 1us * (1 + ticks() % 200'000); })));
  }
}

// Two owners publish, and now and then both objects are set at once, as by a decision. Whatever is known first, those
// of one object in their order: in a world that replays bases it makes no difference.
TEST(MotionWorld, BasesCountByTheirTimesWhateverOrderTheyComeIn) {
  const World w(corridor() + box("CUBE", "0.6 0.6 0.6", "1 0 0", kBounces) +
                interest("CUBE", "\"LEFT\" \"RIGHT\" \"BALL\"") + interest("BALL", "\"CUBE\""));
  const auto every = [](Duration t) { return t + 50ms; };
  int differ_without = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    std::vector<Update> said = {{0s, "BALL", 0s, moving({-1, 0, 0}, {3 * u(rng), 0, 0})},
                                {0s, "CUBE", 0s, moving({1, 0, 0}, {3 * u(rng), 0, 0}, {u(rng), 0, 0})}};
    Duration at = 200ms;
    for (int i = 0; i < 9; ++i) {
      at += seconds(0.15 * (1 + u(rng)));
      const auto say = [&](const char* object, double x) {
        said.push_back({at, object, at, moving({x, 0, 0}, {4 * u(rng), 0, 0})});
      };
      if (i % 3 != 1) say("BALL", -1.5 + 0.5 * u(rng));
      if (i % 3 != 0) say("CUBE", 1.5 + 0.5 * u(rng));
    }
    // Each link has its own delays, by which nothing overtakes on it.
    const auto come = [&](std::uint64_t way) {
      std::mt19937_64 delays(way);
      std::vector<Update> arriving = said;
      std::map<std::string, Duration> last;
      for (Update& update : arriving) {
        if (update.at > 0s) update.when = update.at + 1ms * (delays() % 900);
        update.when = last[update.object] = std::max(update.when, last[update.object]);
      }
      std::ranges::stable_sort(arriving, {}, &Update::when);
      return arriving;
    };
    const auto same = [](const Lived& a, const Lived& b) {
      return a.contacts == b.contacts &&
             std::ranges::equal(a.states, b.states, [](const auto& x, const auto& y) { return same_bits(x, y); });
    };
    const Lived in_time = live(w, said, every, true), in_time_without = live(w, said, every);
    EXPECT_TRUE(same(in_time, in_time_without)) << "nothing is late";
    for (std::uint64_t way = 1; way <= 4; ++way) {
      EXPECT_TRUE(same(live(w, come(way), every, true), in_time)) << "way " << way;
      differ_without += same(live(w, come(way), every), in_time) ? 0 : 1;
    }
  }
  EXPECT_GT(differ_without, 0) << "else this test asks nothing";
}

// BALL is to meet CUBE, which its owner then publishes elsewhere; BALL turns out to have gone elsewhere before.
TEST(MotionWorld, AnAnswerWithoutCauseIsRetractedBeforeALaterBaseToo) {
  auto&& [w, world] = Started(box("BALL", "1 1 1", "-3 0 0", kBounces) + box("CUBE", "1 1 1", "0 0 0", kBounces) +
                              interest("BALL", "\"CUBE\"") + interest("CUBE", "\"BALL\""));
  world.replay_bases();
  for (const char* mover : {"BALL", "CUBE"}) world.declare(w[mover], Role::kPredicted);
  world.set_base(w["CUBE"], sim(0s), moving({0, 0, 0}, {-0.5, 0, 0}));
  world.set_base(w["BALL"], sim(0s), moving({-3, 0, 0}, {2, 0, 0}));  // they meet at 0.8 s
  world.advance(sim(2s));
  EXPECT_NEAR(world.at(w["CUBE"], sim(1500ms)).position.x(), -0.05, 1e-6);
  world.set_base(w["CUBE"], sim(2s), moving({0, 0, 7}));
  world.advance(sim(3s));
  world.set_base(w["BALL"], sim(500ms), moving({-2, 0, 0}, {0, 1, 0}));
  world.advance(sim(3s));
  EXPECT_EQ(world.at(w["CUBE"], sim(1500ms)).position, Vec3(-0.75, 0, 0));
  EXPECT_EQ(world.at(w["CUBE"], sim(3s)).position, Vec3(0, 0, 7));
  world.forget_bases(w["CUBE"], sim(2s));
  world.advance(sim(3s));
  EXPECT_EQ(world.at(w["CUBE"], sim(3s)).position, Vec3(-1.5, 0, 0)) << "that one is void";
}

// A ball between two walls is where the folding of its straight path puts it, however many bounces it has made.
TEST(MotionWorld, ABounceChainFollowsTheFoldedPath) {
  const World w(corridor());
  for (const double speed : {0.7, 5.0, 97.3}) {
    MotionWorld world(*w.model, sim(0s));
    world.declare(w["BALL"], Role::kAuthoritative);
    world.set_base(w["BALL"], sim(0s), moving({0, 0, 0}, {speed, 0, 0}));
    std::size_t bounces = 0;
    for (Duration t = 0s; t <= 20s; t += 50ms) {
      world.advance(sim(t));
      const double path = std::fmod(speed * to_seconds(t) + 3.0, 12.0);
      const double folded = path < 6.0 ? path - 3.0 : 9.0 - path;
      for (const ContactEvent& c : contacts_of(world)) {
        ++bounces;
        ASSERT_LE(std::abs(c.collider_before.position.x()), 3.0 + 1e-12) << "a contact is before, never inside";
      }
      // Each bounce is reported up to a nanosecond early.
      ASSERT_NEAR(world.at(w["BALL"], sim(t)).position.x(), folded,
                  1e-9 * speed * 2 * (1.0 + static_cast<double>(bounces)));
    }
    EXPECT_NEAR(static_cast<double>(bounces), (speed * 20.0 + 3.0) / 6.0, 1.0);
    EXPECT_EQ(world.counters().contacts, bounces);
  }
}

TEST(MotionWorld, StandingPairsAreSearchedOnce) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kPredicted}});
  for (int i = 1; i <= 600; ++i) world.advance(sim(i * 16ms));
  EXPECT_EQ(world.counters().contact_searches, 0u);
  EXPECT_EQ(world.counters().searches_far, 0u);
  world.set_base(w["BALL"], sim(10s), moving({0, 0, 0}, {0.1, 0, 0}));
  world.advance(sim(10s));
  EXPECT_EQ(world.counters().contact_searches, 2u);  // a pair each
  for (int i = 0; i < 240; ++i) world.advance(sim(10s + i * 1ms));
  EXPECT_EQ(world.counters().contact_searches, 2u);
}

// ---- roles ----

TEST(MotionWorld, ADrivenObjectsContactsAreReportedOnceEachWithoutAResponse) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kDriven}});
  std::size_t found = 0;
  for (int i = 0; i <= 300; ++i) {  // four times against the right wall
    const double t = i / 60.0, phase = std::fmod(t, 1.25);
    const double x = phase < 0.625 ? 2.0 + 2.0 * phase : 4.5 - 2.0 * phase;
    world.advance(sim(seconds(t)));
    world.set_base(w["BALL"], sim(seconds(t)), moving({x, 0, 0}, {phase < 0.625 ? 2.0 : -2.0, 0, 0}));
    for (const ContactEvent& c : contacts_of(world)) {
      EXPECT_NEAR(to_seconds(c.at.time_since_epoch()), 0.5 + 1.25 * static_cast<double>(found++), 1e-6);
      EXPECT_TRUE(same_bits(c.collider_after, c.collider_before));
    }
  }
  EXPECT_EQ(found, 4u);
}

TEST(MotionWorld, SceneObjectsMeetAndDoNotAnswer) {
  const World w(corridor());
  MotionWorld world(*w.model, sim(0s));  // nobody owns BALL
  world.set_base(w["BALL"], sim(0s), moving({0, 0, 0}, {2, 0, 0}));
  world.advance(sim(5s));
  EXPECT_THAT(contact_times(world), ElementsAre(sim(1500ms)));
  EXPECT_EQ(world.at(w["BALL"], sim(5s)).position, Vec3(10, 0, 0));
}

// Two movers that fly at each other along x and answer mutually: BALL comes from -2, CUBE stands at 0.
std::string two_movers() {
  return box("BALL", "0.5 0.5 0.5", "-2 0 0", kBounces) + box("CUBE", "0.5 0.5 0.5", "0 0 0", kBounces) +
         interest("BALL", "\"CUBE\"");
}

// An update of the middle of a contact, which had seemed to end after it.
TEST(MotionWorld, AContactThatEndedOnlyInARetractedFutureGoesOn) {
  auto&& [w, world] = Started(box("A", "1 1 1", "-5 0 0") + box("B", "1 1 1", "0 0 0") + interest("A", "\"B\""),
                              {{"A", Role::kPredicted, moving({-5, 0, 0}, {1, 0, 0})}});
  world.advance(sim(7s));
  ASSERT_EQ(contacts_of(world).size(), 1u) << "from 4 s to 6 s";
  world.set_base(w["A"], sim(5s), moving({0, 0, 0}));
  world.advance(sim(8s));
  EXPECT_TRUE(contacts_of(world).empty());
  EXPECT_TRUE(world.ends_touch(w["A"], w["B"], sim(8s)));
  world.set_base(w["A"], sim(8s), moving({0, 0, 0}, {0, 1, 0}));
  world.advance(sim(10s));
  EXPECT_FALSE(world.ends_touch(w["A"], w["B"], sim(10s)));
}

TEST(MotionWorld, OnlyTheRegisteredColliderAnswersUnlessMutual) {
  for (const bool mutual : {false, true}) {
    auto&& [w, world] = Started(two_movers() + (mutual ? interest("CUBE", "\"BALL\"") : ""),
                                {{"BALL", Role::kAuthoritative, moving({-2, 0, 0}, {1, 0, 0})},
                                 {"CUBE", Role::kAuthoritative, moving({0, 0, 0}, {-0.5, 0, 0})}});
    world.advance(sim(1100ms));
    const auto seen = only(contacts_of(world));
    EXPECT_EQ(seen.at, sim(1s));
    EXPECT_EQ(seen.collider_after.velocity, mutual ? Vec3(-1, 0, 0) : Vec3(-2, 0, 0));
    EXPECT_EQ(seen.collidee_after.velocity, mutual ? Vec3(0.5, 0, 0) : Vec3(-0.5, 0, 0));
  }
}

// It meets the face of the wall, is wholly within it for a while, and meets the wall's other face: polygons have no
// inside.
TEST(MotionWorld, AnObjectWithoutAResponseIsSeenButNotTurned) {
  auto&& [w, world] = Started(corridor(""), {{"BALL", Role::kAuthoritative, moving({0, 0, 0}, {2, 0, 0})}});
  for (int i = 0; i < 200; ++i) world.advance(sim(i * 16ms));
  const auto times = contact_times(world);
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0], sim(1500ms));
  EXPECT_LE(times[1], sim(2s));
  EXPECT_GE(times[1], sim(2s) - 1us) << "early by the tolerance at most";
  EXPECT_NEAR(world.at(w["BALL"], sim(3s)).position.x(), 6.0, 1e-12);
}

// ---- predictions ----

TEST(MotionWorld, APredictedContactIsRetractedWhenItsCauseMovedOtherwise) {
  auto&& [w, world] =
      Started(two_movers(), {{"BALL", Role::kPredicted, moving({-2, 0, 0}, {1, 0, 0})}, {"CUBE", Role::kPredicted}});
  (void)events_of(world);
  world.advance(sim(2s));
  EXPECT_THAT(contact_times(world), ElementsAre(sim(1500ms)));
  EXPECT_NEAR(world.at(w["BALL"], sim(2s)).position.x(), -1.0, 1e-9);

  world.set_base(w["CUBE"], sim(1s), moving({0, 0, 0}, {0, 5, 0}));  // it had left by then
  world.advance(sim(2s));
  bool retracted = false;
  for (const auto& e : events_of(world)) {
    EXPECT_FALSE(std::holds_alternative<ContactEvent>(e));
    const auto* back = std::get_if<ContactsRetracted>(&e);
    retracted = retracted || (back != nullptr && back->object == w["BALL"] && back->since < sim(1500ms));
  }
  EXPECT_TRUE(retracted);
  EXPECT_NEAR(world.at(w["BALL"], sim(2s)).position.x(), 0.0, 1e-9);
  EXPECT_EQ(world.counters().contacts_undone, 1u);

  world.set_base(w["CUBE"], sim(1100ms), moving({0.25, 0, 0}));  // and stood again, a little farther away
  world.advance(sim(2s));
  EXPECT_NEAR(to_seconds(only(standing(world)) - sim(1750ms)), 0.0, 1.1e-9);
  EXPECT_NEAR(world.at(w["BALL"], sim(2s)).position.x(), -0.5, 1e-8);
}

TEST(MotionWorld, ReportsChangedAndRestingObjects) {
  auto&& [w, world] = Started(two_movers(), {{"BALL", Role::kPredicted}, {"CUBE", Role::kPredicted}});
  const auto changed = [&] {
    std::vector<ObjectId> all;
    world.take_changed([&](ObjectId object) { all.push_back(object); });
    return all;
  };
  world.set_base(w["BALL"], sim(0s), moving({-2, 0, 0}, {1, 0, 0}));
  world.set_base(w["CUBE"], sim(0s), moving({0, 0, 0}));
  world.set_base(w["CUBE"], sim(0s), moving({0, 0, 0}));
  EXPECT_THAT(changed(), testing::UnorderedElementsAre(w["BALL"], w["CUBE"])) << "each once";
  world.advance(sim(1s));
  EXPECT_THAT(changed(), IsEmpty());
  EXPECT_TRUE(world.is_at_rest_from(w["CUBE"], sim(1s)));
  EXPECT_FALSE(world.is_at_rest_from(w["BALL"], sim(1s)));
  world.advance(sim(2s));  // the ball has hit the cube
  EXPECT_THAT(changed(), testing::Contains(w["BALL"]));
  world.set_base(w["CUBE"], sim(1s), moving({0, 0, 0}, {0, 5, 0}));  // it had left by then
  EXPECT_THAT(changed(), testing::UnorderedElementsAre(w["BALL"], w["CUBE"])) << "what followed is taken back";
  world.set_base(w["CUBE"], sim(3s), moving({0, 9, 0}));
  EXPECT_FALSE(world.is_at_rest_from(w["CUBE"], sim(2s)));
  EXPECT_TRUE(world.is_at_rest_from(w["CUBE"], sim(3s)));
  world.set_base(w["CUBE"], sim(3500ms), moving({0, 9, 0}, {1, 0, 0}));
  EXPECT_FALSE(world.is_at_rest_from(w["CUBE"], sim(3s))) << "not for long";
  MotionModel later = moving({0, 9, 0});
  later.kind = MotionKind::kThird;
  later.jerk = {1, 0, 0};
  world.set_base(w["CUBE"], sim(4s), later);
  EXPECT_FALSE(world.is_at_rest_from(w["CUBE"], sim(4s))) << "it is about to move";
}

// The consequences of a retracted prediction are retracted, too: BALL threw CUBE, and CUBE threw LAST.
TEST(MotionWorld, TakingBackFollowsTheChain) {
  const char* const elastic = " collisionResponse CollisionResponse { responseType 2 restitution 1 }";
  auto&& [w, world] = Started(box("BALL", "0.5 0.5 0.5", "-2 0 0") + box("CUBE", "0.5 0.5 0.5", "0 0 0", elastic) +
                                  box("LAST", "0.5 0.5 0.5", "2 0 0", elastic) + interest("CUBE", "\"BALL\" \"LAST\"") +
                                  interest("LAST", "\"CUBE\""),
                              {{"BALL", Role::kPredicted, moving({-2, 0, 0}, {1, 0, 0})},
                               {"CUBE", Role::kPredicted},
                               {"LAST", Role::kPredicted}});
  world.advance(sim(2900ms));
  EXPECT_THAT(standing(world), ElementsAre(sim(1500ms), sim(2250ms)));
  EXPECT_EQ(world.at(w["LAST"], sim(2900ms)).velocity, Vec3(2, 0, 0));
  world.set_base(w["BALL"], sim(1s), moving({-1, 0, 0}));  // it had stopped
  world.advance(sim(4s));
  EXPECT_THAT(standing(world), IsEmpty());
  EXPECT_EQ(world.at(w["CUBE"], sim(4s)).position, Vec3(0, 0, 0));
  EXPECT_EQ(world.at(w["LAST"], sim(4s)).position, Vec3(2, 0, 0));
  EXPECT_EQ(world.counters().contacts_undone, 2u);
}

TEST(MotionWorld, AnAuthoritativeResponseIsKept) {
  auto&& [w, world] = Started(
      two_movers(), {{"BALL", Role::kAuthoritative, moving({-2, 0, 0}, {1, 0, 0})}, {"CUBE", Role::kPredicted}});
  world.advance(sim(2s));
  EXPECT_EQ(contact_times(world).size(), 1u);
  world.set_base(w["CUBE"], sim(1s), moving({0, 0, 0}, {0, 5, 0}));
  world.advance(sim(2s));
  EXPECT_THAT(contacts_of(world), IsEmpty());
  EXPECT_NEAR(world.at(w["BALL"], sim(2s)).position.x(), -1.0, 1e-9);
  EXPECT_EQ(world.counters().contacts_undone, 0u);
}

// BALL, of another peer, is told late to fly at CUBE, which this peer moves; a wall throws it back before it is there.
TEST(MotionWorld, AContactThatAnEarlierOnePreventsIsNone) {
  const std::string cube_first = interest("CUBE", "\"BALL\"") + interest("BALL", "\"WALL\"");
  const std::string wall_first = interest("BALL", "\"WALL\"") + interest("CUBE", "\"BALL\"");
  for (const std::string& interests : {cube_first, wall_first}) {
    auto&& [w, world] = Started(
        box("CUBE", "1 1 1", "6 0 0", kBounces) + box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces) +
            box("WALL", "1 50 50", "3.75 0 0") + interests,
        {{"CUBE", Role::kAuthoritative, moving({6, 0, 0})}, {"BALL", Role::kPredicted, moving({0, 0, 0})}}, {"CUBE"});
    world.advance(sim(1200ms));
    world.set_base(w["CUBE"], sim(1200ms), moving({6, 0, 0}));  // it answers nothing of before
    world.advance(sim(2s));
    (void)events_of(world);
    world.set_base(w["BALL"], sim(1s), moving({0, 0, 0}, {10, 0, 0}));
    world.advance(sim(2s));
    const auto seen = only(contacts_of(world));
    EXPECT_EQ(seen.at, sim(1300ms));
    EXPECT_EQ(seen.collidee, w["WALL"]);
    EXPECT_EQ(world.at(w["CUBE"], sim(2s)).velocity, Vec3(0, 0, 0));
    EXPECT_NEAR(world.at(w["BALL"], sim(2s)).position.x(), 3 - 10 * 0.7, 1e-9);
  }
}

TEST(MotionWorld, AnAuthoritativeObjectIsNotSearchedInItsPast) {
  auto&& [w, world] = Started(two_movers(), {{"BALL", Role::kAuthoritative, moving({-2, 0, 0}, {1, 0, 0})},
                                             {"CUBE", Role::kPredicted, moving({0, 9, 0})}});
  world.advance(sim(4s));
  (void)events_of(world);
  world.set_base(w["CUBE"], sim(1s), moving({0, 0, 0}));  // it had stood in the way after all
  world.advance(sim(4s));
  EXPECT_THAT(contacts_of(world), IsEmpty());
  EXPECT_NEAR(world.at(w["BALL"], sim(4s)).position.x(), 2.0, 1e-12);
}

TEST(MotionWorld, ALateUpdateIsSearchedFromItsOwnTime) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kPredicted}});
  world.advance(sim(3s));
  world.set_base(w["BALL"], sim(500ms), moving({1, 0, 0}, {4, 0, 0}));  // right wall at 1 s, left wall at 2.5 s
  world.advance(sim(3s));
  EXPECT_THAT(standing(world), ElementsAre(sim(1s), sim(2500ms)));
  EXPECT_NEAR(world.at(w["BALL"], sim(3s)).position.x(), -1.0, 1e-8);
}

TEST(MotionWorld, AnUpdateAfterTheContactHoldsItsOutcome) {
  auto&& [w, world] =
      Started(two_movers(), {{"BALL", Role::kPredicted, moving({-2, 0, 0}, {1, 0, 0})}, {"CUBE", Role::kPredicted}});
  world.set_base(w["BALL"], sim(1900ms), moving({-0.9, 0, 0}, {-3, 0, 0}));  // its owner has bounced already
  world.advance(sim(3s));
  EXPECT_NEAR(world.at(w["BALL"], sim(3s)).position.x(), -4.2, 1e-12);
  EXPECT_EQ(world.base_time(w["BALL"]), sim(1900ms));
}

// A late update puts CUBE where BALL was before the last update of BALL's owner. Neither object answers that overlap
// any more.
TEST(MotionWorld, AnOverlapFromBeforeTheLastUpdateIsNotFoundOverAndOver) {
  auto&& [w, world] = Started(two_movers(), {{"BALL", Role::kPredicted, moving({-2, 0, 0}, {0.1, 0, 0})},
                                             {"CUBE", Role::kPredicted, moving({0, 9, 0})}});
  world.advance(sim(1s));
  world.set_base(w["BALL"], sim(2s), moving({-5, 0, 0}));
  world.advance(sim(3s));
  (void)events_of(world);
  world.set_base(w["CUBE"], sim(1s), moving({-1.8, 0, 0}));
  world.advance(sim(3s));
  EXPECT_THAT(contacts_of(world), IsEmpty());
  EXPECT_EQ(world.counters().capped, 0u);
  EXPECT_EQ(world.at(w["BALL"], sim(3s)).position, Vec3(-5, 0, 0));
}

// ---- overlap and rest ----

TEST(MotionWorld, SetBackOnlyOnOverlapAndOnlyWhereAsked) {
  for (const bool set_back : {true, false}) {
    auto&& [w, world] = Started(corridor(std::string(" collisionResponse CollisionResponse { setBack ") +
                                         (set_back ? "TRUE" : "FALSE") + " } "),
                                {{"BALL", Role::kAuthoritative, moving({0, 0, 0}, {1, 0, 0})}});
    world.advance(sim(100ms));
    (void)events_of(world);
    world.set_base(w["BALL"], sim(1s), moving({3.2, 0, 0}, {1, 0, 0}));  // put into the wall from outside
    world.advance(sim(1s));
    const auto contact = only(contacts_of(world));
    EXPECT_EQ(contact.collider_after.velocity, Vec3(-1, 0, 0));
    if (set_back) {
      EXPECT_LT(contact.collider_after.position.x(), 3.0);
    } else {
      EXPECT_EQ(contact.collider_after.position, Vec3(3.2, 0, 0));
    }
    EXPECT_GE(world.counters().overlapped, 1u);
  }
}

TEST(MotionWorld, AnOverlapAtTheStartIsNamedAndAnsweredOnce) {
  for (const double inwards : {1.0, 0.0, -1.0}) {
    auto&& [w, world] = Started(corridor(), {{"BALL", Role::kAuthoritative, moving({3.2, 0, 0}, {inwards, 0, 0})}});
    std::vector<BodiesOverlap> named;
    std::size_t contacts = 0;
    for (int i = 1; i <= 100; ++i) {
      world.advance(sim(i * 10ms));
      while (const auto event = world.poll_event()) {
        if (const auto* overlap = std::get_if<BodiesOverlap>(&*event)) named.push_back(*overlap);
        contacts += std::holds_alternative<ContactEvent>(*event) ? 1 : 0;
      }
    }
    if (inwards == 0.0) {
      EXPECT_TRUE(named.empty()) << "nothing moves, so nothing is looked at";
    } else {
      ASSERT_EQ(named.size(), 1u);
      EXPECT_EQ(named[0].collidee, w["RIGHT"]);
    }
    EXPECT_EQ(contacts, inwards > 0.0 ? 1u : 0u) << "what parts, or stays, is left as it is";
    EXPECT_EQ(world.at(w["BALL"], sim(1s)).velocity, Vec3(-std::abs(inwards), 0, 0));
  }
}

// The same holds where the ball and the walls are meshes.
TEST(MotionWorld, WhatIsNotConvexAnswersAlike) {
  for (const char* response : {kBounces, kStops}) {
    const World w("DEF BALL Transform { " + std::string(response) +
                  "children Shape { geometry Sphere { radius 0.25 } } }" + box("LEFT", "1 50 50", "-3.75 0 0") +
                  box("RIGHT", "1 50 50", "3.75 0 0") + interest("BALL", "\"LEFT\" \"RIGHT\""));
    ASSERT_NE(w.model->body(w["BALL"])->not_convex_reason, "");
    MotionWorld world(*w.model, sim(0s));
    world.declare(w["BALL"], Role::kAuthoritative);
    world.set_base(w["BALL"], sim(0s), moving({0, 0, 0}, {2, 0.5, 0}));
    for (int i = 0; i < 600; ++i) world.advance(sim(i * 16ms));
    const auto seen = contacts_of(world);
    if (response == kStops) {
      ASSERT_EQ(seen.size(), 1u);
      EXPECT_EQ(seen[0].collider_after.velocity, Vec3(0, 0, 0));
      continue;
    }
    ASSERT_EQ(seen.size(), 3u);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      EXPECT_NEAR(to_seconds(seen[i].at - sim(0s)), 1.5 + 3.0 * static_cast<double>(i), 1e-5);
      EXPECT_EQ(seen[i].normal, Vec3(i == 1 ? 1.0 : -1.0, 0, 0));
    }
    EXPECT_EQ(world.counters().overlapped, 0u);
    EXPECT_EQ(world.counters().failed, 0u);
  }
}

std::string floor_world(const char* response) {
  return box("BALL", "0.5 0.5 0.5", "0 1.25 0", response) + box("FLOOR", "50 1 50", "0 -0.5 0") +
         interest("BALL", "\"FLOOR\"");
}

TEST(MotionWorld, WhatIsPressedAgainstAFloorComesToRestAndSlides) {
  auto&& [w, world] =
      Started(floor_world(kBounces), {{"BALL", Role::kPredicted, moving({0, 0.25, 0}, {1, 0, 0}, {0, -9.81, 0})}});
  for (int i = 0; i <= 180; ++i) world.advance(sim(i * 16ms));
  const KinematicState s = world.at(w["BALL"], sim(3s));
  EXPECT_NEAR(s.position.x(), 3.0, 1e-9);
  EXPECT_NEAR(s.position.y(), 0.25, 1e-6);
  EXPECT_EQ(world.counters().came_to_rest, 1u);
  EXPECT_LE(world.counters().contacts, 16u);
  EXPECT_EQ(world.counters().capped, 0u);
}

// It parts from the floor with half of what it comes with, until that is too little for a flight.
TEST(MotionWorld, CountsTheEnergyThatComingToRestTakes) {
  const std::string impulse = "collisionResponse CollisionResponse { responseType 2 mass 2 restitution 0.5 }";
  for (const Role role : {Role::kAuthoritative, Role::kPredicted}) {
    auto&& [w, world] =
        Started(floor_world(impulse.c_str()), {{"BALL", role, moving({0, 1.25, 0}, {0, 0, 0}, {0, -9.81, 0})}});
    for (int i = 0; i <= 180; ++i) world.advance(sim(i * 16ms));
    double parts = std::sqrt(2.0 * 9.81 * 1.0);
    while (2.0 * parts >= 9.81 * 1e-3) parts *= 0.5;
    EXPECT_EQ(world.counters().came_to_rest, 1u);
    EXPECT_NEAR(world.counters().rest_energy_j, role == Role::kAuthoritative ? parts * parts : 0.0, 1e-7);
    EXPECT_EQ(world.counters().largest_island, 1u);
    EXPECT_GE(world.counters().islands, 1u);
  }
}

// On a slope no number is round. The rounding error of the push must neither end the rest nor let the box sink.
TEST(MotionWorld, WhatRestsOnASlopeGoesOnSliding) {
  for (const double slope : {0.1, 0.3, 0.7}) {
    SCOPED_TRACE(slope);
    const std::string turned = " rotation 0 0 1 -" + std::to_string(slope) + " ";
    const World w(box("BALL", "0.5 0.5 0.5", "0 0 0", turned + kBounces) + box("FLOOR", "500 1 500", "0 0 0", turned) +
                  interest("BALL", "\"FLOOR\""));
    const Quat tilt = w.scene.rigid_pose(w["FLOOR"]).orientation;
    MotionWorld world(*w.model, sim(0s));
    world.declare(w["BALL"], Role::kPredicted);
    KinematicState s = moving(tilt * Vec3(0, 0.75, 0), Vec3::Zero(), {0, -9.81, 0});
    s.orientation = tilt;
    world.set_base(w["BALL"], sim(0s), s);
    for (int i = 0; i <= 300; ++i) world.advance(sim(i * 16ms));
    const Vec3 p = tilt.conjugate() * world.at(w["BALL"], sim(4s)).position;
    EXPECT_NEAR(p.y(), 0.75, 1e-6);
    EXPECT_NEAR(p.x(), 0.5 * 9.81 * std::sin(slope) * 16.0, 1e-3);
    EXPECT_LE(world.counters().contacts, 64u);
    EXPECT_EQ(world.counters().capped, 0u);
  }
}

// ---- what lasts ----

constexpr const char* kDead = " collisionResponse CollisionResponse { responseType 2 restitution 0 } ";

// A and B side by side: A accelerates by 2 m/s^2 and pushes B, so that each has 1 m/s^2. A post stands in A's way
// alone.
std::string pusher_and_pushed() {
  return box("A", "1 1 1", "0 0 0", kDead) + box("B", "1 1 1", "1 0 0", kDead) + box("POST", "1 1 1", "3 1 0") +
         interest("A", "\"B\" \"POST\"") + interest("B", "\"A\"");
}

TEST(LastingContact, WhatWasPushedGoesOnAloneWhenThePusherIsStopped) {
  auto&& [w, world] =
      Started(pusher_and_pushed(), {{"A", Role::kAuthoritative, moving({0, 0.5, 0}, Vec3::Zero(), {2, 0, 0})},
                                    {"B", Role::kAuthoritative, moving({1, 0.5, 0})}});
  world.advance(sim(7s));
  EXPECT_NEAR(world.at(w["B"], sim(1900ms)).velocity.x(), 1.9, 1e-9);
  EXPECT_EQ(world.at(w["A"], sim(7s)).velocity, Vec3::Zero().eval());
  EXPECT_NEAR(world.at(w["B"], sim(7s)).velocity.x(), 2.0, 1e-7) << "A met the post at 2 s";
  EXPECT_EQ(world.at(w["B"], sim(7s)).acceleration, Vec3::Zero().eval());
}

TEST(LastingContact, WhatWasPushedGoesOnAloneWhenAnInputStopsThePusher) {
  auto&& [w, world] =
      Started(pusher_and_pushed(), {{"A", Role::kAuthoritative, moving({0, 0, 0}, Vec3::Zero(), {2, 0, 0})},
                                    {"B", Role::kAuthoritative, moving({1, 0, 0})}});
  world.advance(sim(1s));
  world.set_free_acceleration(w["A"], Vec3::Zero());
  world.set_base(w["A"], sim(1s), moving(world.at(w["A"], sim(1s)).position));
  world.advance(sim(3s));
  EXPECT_EQ(world.at(w["B"], sim(3s)).velocity.x(), 1.0);
  EXPECT_EQ(world.at(w["B"], sim(3s)).acceleration, Vec3::Zero().eval());
}

// A train of three: the first is stopped by an input, and what it pushed through the second goes on, too.
TEST(LastingContact, ReleasesAllThatWasPushedThroughAnother) {
  auto&& [w, world] = Started(box("A", "1 1 1", "0 0 0", kDead) + box("B", "1 1 1", "1 0 0", kDead) +
                                  box("C", "1 1 1", "2 0 0", kDead) + interest("A", "\"B\"") +
                                  interest("B", "\"A\" \"C\"") + interest("C", "\"B\""),
                              {{"A", Role::kAuthoritative, moving({0, 0, 0}, Vec3::Zero(), {3, 0, 0})},
                               {"B", Role::kAuthoritative, moving({1, 0, 0})},
                               {"C", Role::kAuthoritative, moving({2, 0, 0})}});
  world.advance(sim(1s));
  for (const char* name : {"A", "B", "C"}) EXPECT_NEAR(world.at(w[name], sim(1s)).velocity.x(), 1.0, 1e-12) << name;
  world.set_free_acceleration(w["A"], Vec3::Zero());
  world.set_base(w["A"], sim(1s), moving(world.at(w["A"], sim(1s)).position));
  world.advance(sim(3s));
  for (const char* name : {"B", "C"}) {
    EXPECT_NEAR(world.at(w[name], sim(3s)).velocity.x(), 1.0, 1e-12) << name;
    EXPECT_EQ(world.at(w[name], sim(3s)).acceleration, Vec3::Zero().eval()) << name;
  }
}

// A box on a table follows it down, and falls by itself when the table drops faster than it.
TEST(LastingContact, FollowsWhatBearsItAsFarAsItFalls) {
  auto&& [w, world] =
      Started(box("TABLE", "4 1 4", "0 -0.5 0") + box("BOX", "1 1 1", "0 0.5 0", kDead) + interest("BOX", "\"TABLE\""),
              {{"TABLE", Role::kDriven, moving({0, -0.5, 0})},
               {"BOX", Role::kAuthoritative, moving({0, 0.5, 0}, Vec3::Zero(), {0, -9.81, 0})}});
  world.advance(sim(1s));
  EXPECT_EQ(world.at(w["BOX"], sim(1s)).position.y(), 0.5);
  world.set_base(w["TABLE"], sim(1s), moving({0, -0.5, 0}, Vec3::Zero(), {0, -4, 0}));
  world.advance(sim(1500ms));
  EXPECT_NEAR(world.at(w["BOX"], sim(1500ms)).position.y(), 0.5 - 0.5 * 4 * 0.25, 1e-6);
  world.set_base(w["TABLE"], sim(1500ms), moving({0, -1, 0}, {0, -2, 0}, {0, -20, 0}));
  world.advance(sim(2s));
  EXPECT_NEAR(world.at(w["BOX"], sim(2s)).position.y(), -2.0 * 0.5 - 0.5 * 9.81 * 0.25, 1e-5);
}

// A driven pusher is told each 0.1 s where it is, and jumps by as much as it has sped up since. Two boxes stand in its
// way, the first one a millimetre before it; then there is a wall.
TEST(LastingContact, WhatADrivenObjectJumpsIntoIsPushedAlong) {
  auto&& [w, world] = Started(box("PUSHER", "1 1 1", "0 0 0") + box("A", "1 1 1", "1.001 0 0", kDead) +
                                  box("B", "1 1 1", "2.001 0 0", kDead) + box("WALL", "1 9 9", "3.5 0 0") +
                                  interest("A", "\"PUSHER\" \"B\" \"WALL\"") + interest("B", "\"A\" \"WALL\""),
                              {{"PUSHER", Role::kDriven, moving({0, 0, 0})},
                               {"A", Role::kAuthoritative, moving({1.001, 0, 0})},
                               {"B", Role::kAuthoritative, moving({2.001, 0, 0})}});
  const auto x = [&](const char* name, SimTime t) { return world.at(w[name], t).position.x(); };
  world.advance(sim(1s));
  world.set_base(w["PUSHER"], sim(1s), moving({0.005, 0, 0}, {0.1, 0, 0}, {1, 0, 0}));
  world.advance(sim(1s));
  EXPECT_NEAR(x("A", sim(1s)), 1.005, 1e-9);
  EXPECT_NEAR(x("B", sim(1s)), 2.005, 1e-9) << "what is pushed pushes others";
  world.advance(sim(1100ms));
  world.set_base(w["PUSHER"], sim(1100ms), moving({0.02, 0, 0}, {0.2, 0, 0}, {1, 0, 0}));
  world.advance(sim(1200ms));
  for (SimTime t = sim(1100ms); t <= sim(1200ms); t += 10ms) {
    EXPECT_GE(x("A", t) - x("PUSHER", t), 1.0 - 1e-9) << to_seconds(t.time_since_epoch());
    EXPECT_GE(x("B", t) - x("A", t), 1.0 - 1e-9) << to_seconds(t.time_since_epoch());
  }
  world.set_base(w["PUSHER"], sim(1200ms), moving({0.6, 0, 0}, {0.3, 0, 0}, {50, 0, 0}));
  world.advance(sim(1200ms));
  EXPECT_LE(x("B", sim(1200ms)), 2.5 + 1e-9) << "nothing is pushed into a wall";
}

// A pusher that stands where it has jumped to leaves nothing to settle later.
TEST(LastingContact, WhatIsPushedByAJumpThatEndsAtRestStands) {
  auto&& [w, world] =
      Started(box("PUSHER", "1 1 1", "0 0 0") + box("A", "1 1 1", "1.001 0 0", kDead) + interest("A", "\"PUSHER\""),
              {{"PUSHER", Role::kDriven, moving({-0.25, 0, 0}, {0.1, 0, 0})},
               {"A", Role::kAuthoritative, moving({1.001, 0, 0})}});
  world.advance(sim(2s));
  world.set_base(w["PUSHER"], sim(2s), moving({0.005, 0, 0}));
  world.advance(sim(3s));
  EXPECT_NEAR(world.at(w["A"], sim(3s)).position.x(), 1.005, 1e-9);
  EXPECT_TRUE(is_motionless(world.at(w["A"], sim(3s))));
}

// A body of 8 kg pushes one of 1 kg, which runs into another of 1 kg: all three go on together, although the two that
// met have more energy than they had. Whoever decides tells of the pair of pusher and pushed, too.
TEST(LastingContact, ABlowThatReachesAPusherKeepsTheMomentumOfAll) {
  const std::string heavy = " collisionResponse CollisionResponse { responseType 2 mass 8 restitution 0 } ";
  for (const ContactAuthority whose : {ContactAuthority::kAsPublished, ContactAuthority::kLocal}) {
    auto&& [w, world] = Started(box("HEAVY", "1 1 1", "0 0 0", heavy) + box("A", "1 1 1", "1.5 0 0", kDead) +
                                    box("B", "1 1 1", "3 0 0", kDead) + interest("HEAVY", "\"A\"") +
                                    interest("A", "\"HEAVY\" \"B\"") + interest("B", "\"A\""),
                                {{"HEAVY", Role::kAuthoritative, moving({0, 0, 0}, {2, 0, 0})},
                                 {"A", Role::kAuthoritative, moving({1.5, 0, 0})},
                                 {"B", Role::kAuthoritative, moving({3, 0, 0})}});
    world.set_authority({[whose](ObjectId, ObjectId, SimTime) { return whose; }, {}});
    world.advance(sim(1s));
    for (const char* each : {"HEAVY", "A", "B"}) {
      EXPECT_NEAR(world.at(w[each], sim(1s)).velocity.x(), 1.6, 1e-12) << each;
    }
    const auto contacts = contacts_of(world);
    const auto is_late = [](const ContactEvent& c) { return c.at > sim(300ms); };
    EXPECT_EQ(std::ranges::count_if(contacts, is_late), whose == ContactAuthority::kLocal ? 2 : 1);
  }
}

// A predicted outcome leaves in each other what it finds so: where the two were free last depends on when one searched.
TEST(LastingContact, AnImpulseSetsBackForItsOwnerAndForWhoDecides) {
  const auto place = [](Role role, ContactAuthority authority) {
    auto&& [w, world] = Started(box("A", "1 1 1", "0 0 0", kDead) + box("B", "1 1 1", "3 0 0") + interest("A", "\"B\""),
                                {{"A", role, moving({0, 0, 0})}});
    world.set_authority({[authority](ObjectId, ObjectId, SimTime) { return authority; }, {}});
    world.advance(sim(1s));
    world.set_base(w["A"], sim(1100ms), moving({2.2, 0, 0}, {1, 0, 0}));  // its owner puts it into the other
    world.advance(sim(1200ms));
    return world.at(w["A"], sim(1200ms)).position.x();
  };
  EXPECT_EQ(place(Role::kAuthoritative, ContactAuthority::kAsPublished), 0.0);
  EXPECT_EQ(place(Role::kPredicted, ContactAuthority::kLocal), 0.0);
  EXPECT_EQ(place(Role::kPredicted, ContactAuthority::kAsPublished), 2.2);
}

// A world that gets an update of what lies on a table knows by it what bears the object, and what drives it.
TEST(LastingContact, BeginsWithAnUpdateOfWhatIsBorne) {
  auto&& [w, world] =
      Started(box("TABLE", "4 1 4", "0 -0.5 0") + box("BOX", "1 1 1", "0 0.5 0", kDead) + interest("BOX", "\"TABLE\""),
              {{"TABLE", Role::kDriven, moving({0, -0.5, 0})}, {"BOX", Role::kPredicted, moving({0, 5, 0})}});
  world.advance(sim(1s));
  EXPECT_FALSE(world.is_borne(w["BOX"]));
  world.set_base(w["BOX"], sim(1s), moving({0, 0.5, 0}), std::nullopt, Vec3(0, -9.81, 0));
  world.advance(sim(2s));
  EXPECT_TRUE(world.is_borne(w["BOX"]));
  EXPECT_EQ(world.at(w["BOX"], sim(2s)).position.y(), 0.5);
  world.set_base(w["TABLE"], sim(2s), moving({0, -0.5, 0}, Vec3::Zero(), {0, -20, 0}));
  world.advance(sim(3s));
  EXPECT_NEAR(world.at(w["BOX"], sim(3s)).position.y(), 0.5 - 0.5 * 9.81, 1e-5);
}

// The support of the object is not in this world: the published law counts.
TEST(LastingContact, StandsAsPublishedWhereNothingIsKnownToBearIt) {
  auto&& [w, world] =
      Started(box("TABLE", "4 1 4", "0 -0.5 0") + box("BOX", "1 1 1", "0 0.5 0", kDead) + interest("BOX", "\"TABLE\""),
              {{"BOX", Role::kPredicted, moving({0, 5, 0})}});
  world.set_base(w["BOX"], sim(1s), moving({0, 5, 0}), std::nullopt, Vec3(0, -9.81, 0));
  world.advance(sim(3s));
  EXPECT_EQ(world.at(w["BOX"], sim(3s)).position.y(), 5.0);
}

// Two that press against each other, in a world that replays its bases and in one that does not: each update comes
// late, and of both objects there are bases of one instant.
TEST(LastingContact, FollowsWhatDrivesEither) {
  for (const bool replays : {false, true}) {
    SCOPED_TRACE(replays);
    const World w(box("A", "1 1 1", "0 0 0", kDead) + box("B", "1 1 1", "1 0 0", kDead) + interest("A", "\"B\"") +
                  interest("B", "\"A\""));
    MotionWorld world(*w.model, sim(0s));
    if (replays) world.replay_bases();
    for (const char* name : {"A", "B"}) world.declare(w[name], Role::kPredicted);
    world.advance(sim(2s));
    world.set_base(w["A"], sim(1s), moving({0, 0, 0}), std::nullopt, Vec3(2, 0, 0));
    world.advance(sim(2s));
    world.set_base(w["B"], sim(1s), moving({1, 0, 0}), std::nullopt, Vec3(-2, 0, 0));
    world.advance(sim(3s));
    EXPECT_EQ(world.at(w["A"], sim(3s)).position.x(), 0.0);
    EXPECT_EQ(world.at(w["B"], sim(3s)).position.x(), 1.0);
    world.set_base(w["B"], sim(2s), std::nullopt, std::nullopt, Vec3(-4, 0, 0));
    world.advance(sim(4s));
    EXPECT_NEAR(world.at(w["A"], sim(4s)).position.x(), -2.0, 1e-9) << "with -1 m/s^2 from 2 s on";
    EXPECT_NEAR(world.at(w["B"], sim(4s)).position.x(), -1.0, 1e-9);
  }
}

// Three balls lie on a floor, and a fourth drops on them: no contact adds energy.
TEST(LastingContact, ADropOnThreeBallsAddsNoEnergy) {
  const auto ball = [](const std::string& name, const std::string& at) {
    return "DEF " + name + " Transform { translation " + at + kDead +
           " children Shape { geometry Sphere { radius 0.5 } } }\n";
  };
  const Vec3 g(0, -9.81, 0);
  auto&& [w, world] =
      Started(box("FLOOR", "10 1 10", "0 -0.5 0") + ball("B0", "0 0 0") + ball("B1", "0 0 0") + ball("B2", "0 0 0") +
                  ball("T", "0 0 0") + interest("B0", "\"FLOOR\" \"T\" \"B1\" \"B2\"") +
                  interest("B1", "\"FLOOR\" \"T\" \"B0\" \"B2\"") + interest("B2", "\"FLOOR\" \"T\" \"B0\" \"B1\"") +
                  interest("T", "\"FLOOR\" \"B0\" \"B1\" \"B2\""),
              {{"B0", Role::kAuthoritative, moving({0.55, 0.5, 0}, Vec3::Zero(), g)},
               {"B1", Role::kAuthoritative, moving({-0.275, 0.5, 0.476313}, Vec3::Zero(), g)},
               {"B2", Role::kAuthoritative, moving({-0.274995, 0.5, -0.476317}, Vec3::Zero(), g)},
               {"T", Role::kAuthoritative, moving({0, 3, 0}, Vec3::Zero(), g)}});
  double before = 9.81 * (3 * 0.5 + 3.0);
  for (Duration t = 10ms; t <= 4s; t += 10ms) {
    world.advance(sim(t));
    double energy = 0.0;
    for (const char* name : {"B0", "B1", "B2", "T"}) {
      const KinematicState s = world.at(w[name], sim(t));
      energy += 0.5 * s.velocity.squaredNorm() + 9.81 * s.position.y();
    }
    EXPECT_LE(energy, before + 1e-9 * std::abs(before)) << to_seconds(t);
    before = energy;
  }
  EXPECT_GT(world.at(w["B0"], sim(2s)).position.x(), 1.0);
}

TEST(LastingContact, SlidesOverTheSeamOfTwoSlabsOfOneHeight) {
  for (const char* const second : {"2 -0.5 0", "2 -0.5 0.3"}) {
    auto&& [w, world] = Started(box("LEFT", "4 1 4", "-2 -0.5 0") + box("RIGHT", "4 1 4", second) +
                                    box("BOX", "1 1 1", "-2 0.5 0", kDead) + interest("BOX", "\"LEFT\" \"RIGHT\""),
                                {{"BOX", Role::kAuthoritative, moving({-2, 0.5, 0}, {1, 0, 0.1}, {0, -9.81, 0})}});
    world.advance(sim(5s));
    const KinematicState s = world.at(w["BOX"], sim(5s));
    EXPECT_NEAR((s.position - Vec3(3, 0.5, 0.5)).norm(), 0.0, 1e-9);
    EXPECT_EQ(s.velocity, Vec3(1, 0, 0.1));
  }
}

// ---- inside and outside ----

TEST(Inside, WhatBeginsInAClosedRoomStaysInIt) {
  const std::string balls = "DEF BALL Transform { translation 0 0 0 " + std::string(kDead) +
                            " children Shape { geometry Sphere { radius 0.2 } } }\n";
  for (const std::string& inner : {balls, box("BALL", "0.4 0.4 0.4", "0 0 0", kDead)}) {
    for (const std::string& room :
         {box("ROOM", "4 4 4", "0 0 0"),
          std::string("DEF ROOM Transform { children Shape { geometry Cylinder { radius 3 height 4 } } }\n"),
          std::string("DEF ROOM Transform { children Shape { geometry Sphere { radius 2 } } }\n")}) {
      auto&& [w, world] = Started(room + inner + interest("BALL", "\"ROOM\""),
                                  {{"BALL", Role::kAuthoritative, moving({0, 0, 0}, Vec3::Zero(), {0, -9.81, 0})}});
      world.advance(sim(3s));
      const bool round = room.find("Sphere") != std::string::npos;
      if (round && inner != balls) continue;  // the facets of the ball are nearer
      EXPECT_NEAR(world.at(w["BALL"], sim(3s)).position.y(), -1.8, 1e-5) << room << inner;
      EXPECT_EQ(world.at(w["BALL"], sim(3s)).velocity, Vec3::Zero().eval());
    }
  }
}

// It lies on the floor of the room from the beginning, or slides on it.
TEST(Inside, WhatBeginsAtAWallStaysInside) {
  for (const double speed : {0.0, 0.25}) {
    auto&& [w, world] =
        Started(box("ROOM", "8 4 8", "0 0 0") + box("BOX", "1 1 1", "0 -1.5 0", kDead) + interest("BOX", "\"ROOM\""),
                {{"BOX", Role::kAuthoritative, moving({0, -1.5, 0}, {speed, 0, 0}, {0, -9.81, 0})}});
    world.advance(sim(4s));
    EXPECT_LE((world.at(w["BOX"], sim(4s)).position - Vec3(4.0 * speed, -1.5, 0)).norm(), 1e-5) << speed;
  }
}

TEST(Inside, WhatSlidesAlongTheInsideOfASphereStaysInside) {
  auto&& [w, world] = Started(
      "DEF ROOM Transform { children Shape { geometry Sphere { radius 2 } } }\nDEF BALL Transform { " +
          std::string(kDead) + " children Shape { geometry Sphere { radius 0.2 } } }\n" + interest("BALL", "\"ROOM\""),
      {{"BALL", Role::kAuthoritative, moving({0, -1.8, 0}, {1, 0, 0}, {0, -9.81, 0})}});
  for (Duration t = 20ms; t <= 4s; t += 20ms) {
    world.advance(sim(t));
    ASSERT_LE(world.at(w["BALL"], sim(t)).position.norm(), 1.8 + 1e-3) << to_seconds(t);
  }
}

// An object that goes through because nothing answers has one contact until it has come out at the other side.
TEST(Inside, WhatIsNotAnsweredIsOneContactUntilItIsOut) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kScene, moving({0, 0, 0}, {2, 0, 0})}});
  world.advance(sim(5s));
  EXPECT_THAT(contact_times(world), ElementsAre(sim(1500ms)));
}

TEST(MotionWorld, ZeroStopsAtTheContact) {
  auto&& [w, world] = Started(corridor(kStops), {{"BALL", Role::kAuthoritative, moving({0, 0, 0}, {2, 1, 0})}});
  for (int i = 0; i < 300; ++i) world.advance(sim(i * 16ms));
  EXPECT_THAT(contact_times(world), ElementsAre(sim(1500ms)));
  EXPECT_EQ(world.at(w["BALL"], sim(4s)).position, Vec3(3, 1.5, 0));
}

// ---- watching, limits ----

TEST(MotionWorld, AnUnwatchedPairMeetsNothingAndAWatchedOneFromNowOn) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kAuthoritative}});
  bool is_watched = false;
  world.watch_by([&](const CollisionPair& pair) {
    return is_watched || (pair.collider != w["RIGHT"] && pair.collidee != w["RIGHT"]);
  });
  world.set_base(w["BALL"], sim(0s), moving({0, 0, 0}, {2, 0, 0}));
  world.advance(sim(2s));
  EXPECT_THAT(contacts_of(world), IsEmpty());
  world.set_base(w["BALL"], sim(2s), moving({0, 0, 0}, {2, 0, 0}));
  is_watched = true;
  world.watch_anew(w["RIGHT"]);
  world.advance(sim(4s));
  EXPECT_THAT(contact_times(world), ElementsAre(sim(3500ms)));
}

TEST(MotionWorld, WhatCannotBeAnsweredIsCountedOnceAndTheRestGoesOn) {
  auto&& [w, world] = Started(
      corridor() + "DEF EGG Transform { translation 1 0 0 children Shape { geometry Sphere { radius 1e18 } } }" +
          interest("BALL", "\"EGG\""),
      {{"BALL", Role::kAuthoritative, moving({0, 0, 0}, {2, 0, 0})}});
  for (int i = 0; i < 200; ++i) world.advance(sim(i * 16ms));
  EXPECT_EQ(world.counters().unsupported, 1u);
  EXPECT_THAT(contact_times(world), ElementsAre(sim(1500ms)));
}

TEST(MotionWorld, OneAdvanceDoesBoundedWork) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kAuthoritative}});
  world.set_base(w["BALL"], sim(0s), moving({0, 0, 0}, {30'000, 0, 0}));  // a wall every 0.2 ms
  world.advance(sim(1s));
  EXPECT_EQ(world.counters().capped, 0u) << "5,000 contacts are no reason to give up";
  EXPECT_GE(contacts_of(world).size(), 4'999u);
  world.advance(sim(31s));
  EXPECT_EQ(world.counters().capped, 1u);
  const Vec3 stopped = world.at(w["BALL"], sim(31s)).position;
  EXPECT_LE(std::abs(stopped.x()), 3.0 + 1e-9) << "giving up is no way through a wall";
  world.advance(sim(32s));
  EXPECT_EQ(world.counters().capped, 1u);
  EXPECT_EQ(world.at(w["BALL"], sim(32s)).position, stopped);
}

// What gives up is the advance: two balls that it stops are one.
TEST(MotionWorld, AnAdvanceGivesUpOnce) {
  auto&& [w, world] =
      Started(corridor() + box("TWIN", "0.5 0.5 0.5", "0 9 0", kBounces) + interest("TWIN", "\"LEFT\" \"RIGHT\""));
  for (const char* name : {"BALL", "TWIN"}) {
    world.declare(w[name], Role::kAuthoritative);
    world.set_base(w[name], sim(0s), moving({0, name[0] == 'T' ? 9.0 : 0.0, 0}, {30'000, 0, 0}));
  }
  world.advance(sim(31s));
  EXPECT_EQ(world.counters().capped, 1u);
  for (const char* name : {"BALL", "TWIN"}) {
    EXPECT_LE(std::abs(world.at(w[name], sim(31s)).position.x()), 3.0 + 1e-9) << name;
  }
}

// Between a wall and a press that does not give way there is no room for an answer: the box stands at the wall, and the
// press goes through it.
TEST(MotionWorld, WhatIsJammedStops) {
  auto&& [w, world] = Started(
      corridor() + box("PRESS", "0.5 0.5 0.5", "0 0 0") + interest("BALL", "\"PRESS\""),
      {{"BALL", Role::kPredicted, moving({2.9, 0, 0})}, {"PRESS", Role::kPredicted, moving({0, 0, 0}, {1, 0, 0})}});
  for (int i = 0; i <= 300; ++i) {
    world.advance(sim(i * 16ms));
    EXPECT_LE(world.at(w["BALL"], sim(i * 16ms)).position.x(), 3.0 + 1e-6);
  }
  EXPECT_EQ(world.counters().capped, 0u);
  EXPECT_GE(world.counters().jammed, 1u);
  EXPECT_LE(world.counters().contacts, 20'000u);
}

// A record that comes late may put a body where two that stand leave it 4 um: nothing there gives way, and a bounce
// would end nowhere.
TEST(MotionWorld, WhatIsTrappedStops) {
  auto&& [w, world] =
      Started(corridor() + box("STANDS", "0.5 0.5 0.5", "0 0 0", kBounces) + interest("BALL", "\"STANDS\""),
              {{"BALL", Role::kPredicted, moving({3.0 - 2e-6, 0, 0}, {0.65, 0, 0})},
               {"STANDS", Role::kPredicted, moving({2.5 - 4e-6, 0, 0})}});
  world.advance(sim(1s));
  EXPECT_EQ(world.counters().capped, 0u);
  EXPECT_GE(world.counters().jammed, 1u);
  EXPECT_LE(world.counters().contacts, 200u);
  EXPECT_EQ(world.at(w["BALL"], sim(1s)).velocity, Vec3::Zero().eval());
  EXPECT_LE(std::abs(world.at(w["BALL"], sim(1s)).position.x() - 3.0), 5e-6);
}

TEST(MotionWorld, HistoryReachesBackAndEnds) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kPredicted}});
  for (int i = 0; i <= 10; ++i) {
    world.advance(sim(i * 1s));
    world.set_base(w["BALL"], sim(i * 1s), moving({0.1 * i, 0, 0}));
  }
  world.advance(sim(10s));
  EXPECT_EQ(world.at(w["BALL"], sim(6500ms)).position.x(), 0.1 * 6);
  EXPECT_EQ(world.at(w["BALL"], sim(9500ms)).position.x(), 0.1 * 9);
  EXPECT_EQ(world.at(w["BALL"], sim(1s)).position.x(), 0.1 * 4) << "older pieces are forgotten";
  // An update from before all history: its contacts are searched as far back as history reaches, not to its begin.
  (void)events_of(world);
  world.set_base(w["BALL"], sim(-3600s), moving({0, 0, 0}, {1.0 / 4096, 0, 0}));
  const auto before = world.counters().contact_searches;
  world.advance(sim(10s));
  EXPECT_LE(world.counters().contact_searches - before, 60u);
}

// Objects that no interest names may be declared at any time; the indices of the pairs keep their meaning.
TEST(MotionWorld, ObjectsDeclaredLateLeaveThePairsAlone) {
  auto&& [w, world] = Started(box("FIRST", "1 1 1", "0 20 0") + corridor() + box("LAST", "1 1 1", "0 -20 0"),
                              {{"BALL", Role::kPredicted, moving({0, 0, 0}, {2, 0, 0})}});
  world.advance(sim(1s));
  EXPECT_FALSE(world.has(w["FIRST"]));
  world.declare(w["FIRST"], Role::kAuthoritative);
  world.declare(w["LAST"], Role::kPredicted);
  world.set_base(w["FIRST"], sim(1s), moving({0, 20, 0}, {1, 0, 0}));
  world.advance(sim(2s));
  const auto contact = only(contacts_of(world));
  EXPECT_EQ(contact.collider, w["BALL"]);
  EXPECT_EQ(contact.collidee, w["RIGHT"]);
  EXPECT_EQ(world.at(w["FIRST"], sim(2s)).position, Vec3(1, 20, 0));
  EXPECT_TRUE(world.has(w["LAST"]));
}

// ---- work that a scene does not need is not done ----

std::uint64_t looks(const MotionWorld& world) {
  const MotionWorld::Counters& c = world.counters();
  return c.contact_searches + c.searches_far + c.searches_skipped;
}

TEST(MotionWorld, AWorldWithoutInterestsChecksNothing) {
  auto&& [w, world] = Started(box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "0.5 0 0", kBounces),
                              {{"B", Role::kPredicted}, {"A", Role::kPredicted}});
  for (Duration t = 0s; t < 5s; t += 100ms) {
    world.set_base(w["A"], sim(t), moving({0, 0, 0}, {1, 0, 0}));
    world.advance(sim(t));
  }
  EXPECT_EQ(looks(world), 0u);
  EXPECT_THAT(contacts_of(world), IsEmpty());
  EXPECT_THAT(world.objects(), ElementsAre(w["A"], w["B"]));  // in the file's order, whatever that of declaring
}

TEST(MotionWorld, APairFarApartIsSparedItsSearch) {
  auto&& [w, world] =
      Started(two_movers(), {{"BALL", Role::kPredicted, moving({-20, 0, 0}, {4, 0, 0})}, {"CUBE", Role::kPredicted}});
  world.advance(sim(3s));
  EXPECT_EQ(world.counters().contact_searches, 0u);
  EXPECT_EQ(world.counters().searches_far, 0u) << "their places are apart";
  EXPECT_THAT(contacts_of(world), IsEmpty());
  world.advance(sim(6s));  // they meet at 4.875 s
  EXPECT_THAT(contact_times(world), ElementsAre(sim(4875ms)));
  EXPECT_GE(world.counters().contact_searches, 1u);
  EXPECT_LE(world.counters().contact_searches, 3u);
}

// A pair that the search skipped was apart. Its earlier overlap is over, and setBack returns to this place.
TEST(MotionWorld, APairThatWasSparedWasApart) {
  auto&& [w, world] = Started(two_movers(), {{"BALL", Role::kAuthoritative}, {"CUBE", Role::kAuthoritative}});
  bool answers = false;
  world.set_authority({[&](ObjectId, ObjectId, SimTime) {
                         return answers ? ContactAuthority::kAsPublished : ContactAuthority::kDeferred;
                       },
                       {}});
  world.set_base(w["BALL"], sim(0s), moving({-0.75, 0, 0}, {1, 0, 0}));
  world.advance(sim(300ms));
  EXPECT_EQ(contact_times(world).size(), 1u);  // held: another peer decides
  answers = true;
  world.set_base(w["BALL"], sim(1s), moving({-20, 0, 0}, {1, 0, 0}));
  world.advance(sim(1600ms));
  EXPECT_GE(world.counters().searches_far, 3u);
  world.set_base(w["BALL"], sim(1700ms), moving({-0.3, 0, 0}, {1, 0, 0}));  // its owner puts it into the other
  world.advance(sim(1800ms));
  const auto contact = only(contacts_of(world));
  EXPECT_EQ(contact.at, sim(1700ms));
  EXPECT_NEAR(contact.collider_after.position.x(), -19.5, 1e-12);  // where it was at 1.5 s
}

TEST(MotionWorld, AnUnwatchedPairIsNotChecked) {
  auto&& [w, world] = Started(two_movers(), {{"BALL", Role::kPredicted}, {"CUBE", Role::kPredicted}});
  world.watch_by([](const CollisionPair&) { return false; });
  world.set_base(w["BALL"], sim(0s), moving({-2, 0, 0}, {1, 0, 0}));
  world.advance(sim(5s));
  EXPECT_EQ(looks(world), 0u);
  EXPECT_THAT(contacts_of(world), IsEmpty());
}

// Each timeline forgets pieces that ended more than 4 s before the latest advance(), then and not later, in whatever
// order the updates came.
TEST(MotionWorld, ForgetsWhatIsOld) {
  const World w(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "9 0 0") + box("C", "1 1 1", "0 0 9") +
                interest("A", "\"B\""));
  std::mt19937_64 rng(5);
  MotionWorld world(*w.model, sim(0s));
  struct Line {
    ObjectId id;
    std::vector<SimTime> updates;
  };
  std::vector<Line> lines = {{w["A"], {sim(0s)}}, {w["B"], {sim(0s)}}, {w["C"], {sim(0s)}}};
  for (const Line& line : lines) world.declare(line.id, Role::kPredicted);
  for (Duration now = 0s; now < 60s; now += 1ms + Duration{rng() % 700'000'000}) {
    for (Line& line : lines) {
      for (auto count = rng() % 3; count > 0; --count) {
        const SimTime t = sim(now - Duration{rng() % 3'900'000'000});
        std::erase_if(line.updates, [&](SimTime updated) { return updated >= t; });
        line.updates.push_back(t);
        world.set_base(line.id, t, moving({0, 50, 0}));
      }
    }
    world.advance(sim(now));
    (void)events_of(world);
    for (Line& line : lines) {
      while (line.updates.size() > 1 && line.updates[1] <= sim(now - MotionWorld::kHistory))
        line.updates.erase(line.updates.begin());
      ASSERT_TRUE(world.has_history_at(line.id, line.updates.front()));
      ASSERT_FALSE(world.has_history_at(line.id, line.updates.front() - 1ns));
      ASSERT_EQ(world.law_since(line.id, sim(now)),
                line.updates.back() <= sim(now) ? line.updates.back() : line.updates.front());
    }
  }
}

TEST(MotionWorld, KeepsTheHistoryOfADrivenObjectAsLongAsConfigured) {
  const World w(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "9 0 0") + box("C", "1 1 1", "0 0 9") +
                box("WALL", "1 1 1", "0 0 -99") + interest("WALL", "\"A\" \"B\" \"C\""));
  MotionWorld usual(*w.model, sim(0s)), brief(*w.model, sim(0s));
  brief.keep_history_of_driven(500ms);
  for (MotionWorld* world : {&usual, &brief}) {
    world->declare(w["A"], Role::kDriven);
    world->declare(w["B"], Role::kAuthoritative);
    world->declare(w["C"], Role::kDriven);  // seldom updated
    for (Duration now = 0s; now <= 10s; now += 10ms) {
      for (const char* moved : {"A", "B"})
        world->set_base(w[moved], sim(now), moving({to_seconds(now), 9, 0}, {1, 0, 0}));
      if (now % 2s == 0s) world->set_base(w["C"], sim(now), moving({to_seconds(now), 99, 0}, {1, 0, 0}));
      world->advance(sim(now));
    }
  }
  for (const char* moved : {"A", "B"}) {
    const bool driven = moved == std::string_view("A");
    EXPECT_TRUE(usual.has_history_at(w[moved], sim(6s)));
    EXPECT_EQ(brief.has_history_at(w[moved], sim(9490ms)), !driven);
    for (const Duration t : {9500ms, 9777ms, 10000ms}) {
      EXPECT_TRUE(brief.has_history_at(w[moved], sim(t)));
      EXPECT_EQ(brief.at(w[moved], sim(t)).position, usual.at(w[moved], sim(t)).position);
    }
  }
  EXPECT_NEAR(brief.at(w["C"], sim(9500ms)).position.x(), 9.5, 1e-12);
  EXPECT_GT(brief.at(w["A"], sim(8s)).position.x(), 9.4) << "nothing is kept that nobody may ask for";
}

TEST(MotionWorld, KeepsOnlyTheLastSampleOfADrivenObjectWithoutPairs) {
  const World w(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "9 0 0"));
  MotionWorld usual(*w.model, sim(0s)), brief(*w.model, sim(0s));
  brief.keep_history_of_driven(500ms);
  for (MotionWorld* world : {&usual, &brief}) {
    world->declare(w["A"], Role::kDriven);
    world->declare(w["B"], Role::kAuthoritative);
    for (const char* moved : {"A", "B"}) {
      world->set_base(w[moved], sim(10ms), moving({1, 0, 0}, {1, 0, 0}));
      world->set_base(w[moved], sim(20ms), moving({2, 0, 0}, {1, 0, 0}));
    }
    world->advance(sim(20ms));
  }
  EXPECT_TRUE(usual.has_history_at(w["A"], sim(10ms)));
  EXPECT_TRUE(brief.has_history_at(w["B"], sim(10ms)));
  EXPECT_FALSE(brief.has_history_at(w["A"], sim(10ms)));
  EXPECT_TRUE(brief.has_history_at(w["A"], sim(20ms)));
  EXPECT_EQ(brief.at(w["A"], sim(10ms)).position.x(), 2.0) << "it has not moved before";
  EXPECT_EQ(brief.at(w["A"], sim(30ms)).position, usual.at(w["A"], sim(30ms)).position);
  EXPECT_EQ(brief.base_time(w["A"]), sim(20ms));
  EXPECT_EQ(brief.revision(w["A"]), usual.revision(w["A"]));
}

// The driver of A has given it to another peer. A late update of B is from before the history that is kept of A.
TEST(MotionWorld, FindsNoContactBeyondTheHistory) {
  auto&& [w, world] =
      Started(box("A", "1 1 1", "0 50 0") + box("B", "1 1 1", "-20 0 0", kBounces) + interest("B", "\"A\""));
  world.keep_history_of_driven(500ms);
  world.declare(w["A"], Role::kDriven);
  world.declare(w["B"], Role::kPredicted);
  for (Duration now = 0s; now <= 10s; now += 10ms) {
    world.set_base(w["A"], sim(now), moving({0, now < 9s ? 50.0 : 0.0, 0}));
    world.advance(sim(now));
  }
  world.declare(w["A"], Role::kPredicted);
  world.set_base(w["B"], sim(8s), moving({-8, 0, 0}, {10, 0, 0}));  // was at A's place before A was
  world.advance(sim(10100ms));
  EXPECT_THAT(contacts_of(world), IsEmpty());
  EXPECT_NEAR(world.at(w["B"], sim(10s)).position.x(), 12.0, 1e-12);
}

// ---- laws without a constant acceleration ----

MotionModel spring(double amplitude, double rate) {  // from x = 0 to the right, with a drift along z
  MotionModel m = moving({0, 0, 0}, {amplitude * rate, 0, 1});
  m.kind = MotionKind::kOscillating;
  m.jerk.x() = -amplitude * rate * rate * rate;
  m.rate_rad_s.x() = rate;
  return m;
}

// A spring of 4 m swings between walls 3 m to either side, and its law continues after each bounce as in a mirror. The
// contacts' times have the pieces' error, and no more after ten bounces than after one.
TEST(MotionWorld, ALawGoesOnAfterItsBounces) {
  const World w(corridor());
  const double rate = 0.9, hit = std::asin(0.75) / rate;  // 4 sin(rate t) = 3
  MotionWorld world(*w.model, sim(0s));
  world.declare(w["BALL"], Role::kPredicted);
  world.set_base(w["BALL"], sim(0s), spring(4, rate));
  std::vector<SimTime> contacts;
  for (Duration t = 0s; t <= 20 * seconds(hit); t += 10ms) {
    world.advance(sim(t));
    std::ranges::copy(contact_times(world), std::back_inserter(contacts));
    EXPECT_LE(std::abs(world.at(w["BALL"], sim(t)).position.x()), 3.0 + 1e-9);
    const double phase = std::fmod(to_seconds(t), 4 * hit);
    const double x = phase <= hit       ? 4 * std::sin(rate * phase)
                     : phase <= 3 * hit ? 4 * std::sin(rate * (2 * hit - phase))
                                        : 4 * std::sin(rate * (phase - 4 * hit));
    EXPECT_NEAR(world.at(w["BALL"], sim(t)).position.x(), x, 1e-3) << to_seconds(t);
  }
  ASSERT_EQ(contacts.size(), 10u);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_NEAR(to_seconds(contacts[i] - sim(0s)), (2.0 * static_cast<double>(i) + 1) * hit, 1e-4 * (i + 1.0)) << i;
  }
}

// The result does not depend on when advance() is called, as for constant accelerations.
TEST(MotionWorld, LawsDoNotDependOnHowOftenTheyAreEvaluated) {
  const World w(corridor());
  const auto lived = [&](Duration step) {
    MotionWorld world(*w.model, sim(0s));
    world.declare(w["BALL"], Role::kPredicted);
    world.set_base(w["BALL"], sim(0s), spring(4, 0.9));
    for (Duration t = 0s; t < 12s; t += step) world.advance(sim(t));
    world.advance(sim(12s));
    return world.at(w["BALL"], sim(12s));
  };
  const KinematicState once = lived(12s);
  EXPECT_TRUE(same_bits(lived(7ms), once));
  EXPECT_TRUE(same_bits(lived(333ms), once));
}

// An object that slides stops short of the wall, and no search for a contact goes on for ever.
TEST(MotionWorld, WhatSlidesComesToRestAndCostsNothingThen) {
  auto&& [w, world] = Started(corridor(), {{"BALL", Role::kPredicted}});
  MotionModel m = moving({0, 0, 0}, {2, 0, 0}, {-1, 0, 0});
  m.kind = MotionKind::kSliding;
  world.set_base(w["BALL"], sim(0s), m);
  world.advance(sim(3s));
  EXPECT_EQ(world.at(w["BALL"], sim(3s)).position, Vec3(2, 0, 0));
  const std::uint64_t searches = world.counters().contact_searches;
  world.advance(sim(100s));
  EXPECT_EQ(world.counters().contact_searches, searches);
  EXPECT_EQ(world.counters().contacts, 0u);
}

// ---- carriers ----

// The times of one pair.
std::vector<SimTime> times_of(const std::vector<ContactEvent>& all, ObjectId a, ObjectId b) {
  std::vector<SimTime> times;
  for (const ContactEvent& c : all) {
    if ((c.collider == a && c.collidee == b) || (c.collider == b && c.collidee == a)) times.push_back(c.at);
  }
  return times;
}
// Whether there is one contact, at that time as rounded down to a nanosecond.
void expect_once(const std::vector<SimTime>& times, SimTime at) {
  ASSERT_EQ(times.size(), 1u);
  EXPECT_LE(times[0], at);
  EXPECT_GE(times[0], at - Duration{2});
}
KinematicState turning(KinematicState state, const Vec3& spin_rad_s) {
  state.angular_velocity_body = spin_rad_s;
  return state;
}

// The thesis's example (Ohlenburg 2003, 3.3). The wheel's front is at 1.5 m, that of the curb at 7.75 m.
std::string car_and_curb() {
  return car_and_wheel() + box("CURB", "0.5 0.6 4", "8 0.5 0") + interest("WHEEL", "\"CURB\"");
}

TEST(Carriers, TheWheelOfADrivenCarMeetsACurb) {
  const World w(car_and_curb(), {"CAR"});
  const SimTime meets = sim(seconds(6.25 / 3.0));
  for (const Duration sample : {Duration(10s), Duration(16ms), Duration(7ms)}) {
    SCOPED_TRACE(sample.count());
    MotionWorld world(*w.model, sim(0s));
    world.declare(w["CAR"], Role::kDriven);
    for (Duration t = 0s; t < 4s; t += sample) {
      world.set_base(w["CAR"], sim(t), moving({3 * to_seconds(t), 2, 0}, {3, 0, 0}));
      world.advance(sim(std::min<Duration>(t + sample, 4s)));
    }
    const auto met = only(contacts_of(world));
    EXPECT_EQ(met.collider, w["WHEEL"]);
    EXPECT_LE(met.at, meets);
    EXPECT_GT(met.at, meets - 1us);
    EXPECT_EQ(met.normal, -Vec3::UnitX());
    EXPECT_EQ(met.collider_before.velocity, Vec3(3, 0, 0)) << "in the world";
    EXPECT_EQ(world.relative_at(w["WHEEL"], sim(3s)).position, Vec3(1, -1, 0));
    EXPECT_NEAR(world.at(w["WHEEL"], sim(3s)).position.x(), 10.0, 1e-9);
  }
}

// The arm's far corner is at (3.25, 0.25) m from its axis, and the wall's front at -2 m.
TEST(Carriers, AHandOnATurningArmMeetsAWall) {
  const World w("DEF ARM Transform { children " + box("HAND", "0.5 0.5 0.5", "3 0 0") + "}\n" +
                    box("WALL", "1 50 50", "-2.5 0 0") + interest("HAND", "\"WALL\""),
                {"ARM"});
  const double corner_m = std::hypot(3.25, 0.25), angle_rad = std::acos(-2.0 / corner_m) - std::atan(0.25 / 3.25);
  for (const double spin_rad_s : {1.0, -1.0, 0.25, 7.0}) {
    SCOPED_TRACE(spin_rad_s);
    MotionWorld world(*w.model, sim(0s));
    world.declare(w["ARM"], Role::kPredicted);
    world.set_base(w["ARM"], sim(0s), turning(moving({0, 0, 0}), {0, spin_rad_s, 0}));
    const double meets_s = angle_rad / std::abs(spin_rad_s);
    world.advance(sim(seconds(meets_s + 0.01)));
    const auto met = only(contacts_of(world));
    EXPECT_LE(met.at, sim(seconds(meets_s)) + Duration{1}) << "never late";
    // 2e-6 m early at most: 1e-6 m, and the error of the fine piece.
    const double speed_m_s = corner_m * std::abs(spin_rad_s) * std::sin(std::acos(-2.0 / corner_m));
    EXPECT_GT(met.at, sim(seconds(meets_s - 2e-6 / speed_m_s)) - Duration{2});
    EXPECT_LT((met.normal - Vec3::UnitX()).norm(), 1e-9);
  }
}

std::string bus_and_lamp() {
  return "DEF BUS Transform { children [ " + box("DOOR", "1 2 0.1", "0 1 1.5") + box("POST", "0.1 2 0.1", "2 1 1.5") +
         "] }\n" + box("LAMP", "0.2 5 0.2", "12 1 1.6") + interest("DOOR", "\"POST\" \"LAMP\"");
}

// DOOR's edge is 1.45 m from the post, and it slides at 1 m/s.
std::vector<ContactEvent> ride(const World& w, const MotionModel& bus, Duration until,
                               MotionWorld::Counters* work = nullptr) {
  MotionWorld world(*w.model, sim(0s));
  for (const char* name : {"BUS", "DOOR"}) world.declare(w[name], Role::kPredicted);
  world.set_base(w["BUS"], sim(0s), bus);
  world.set_base(w["DOOR"], sim(0s), moving({0, 1, 1.5}, {1, 0, 0}));
  world.advance(sim(until));
  if (work != nullptr) *work = world.counters();
  return contacts_of(world);
}

TEST(Carriers, ADoorMeetsThePostOfItsBusAsIfTheBusStood) {
  const World w(bus_and_lamp(), {"BUS"});
  const auto stands = times_of(ride(w, moving({0, 0, 0}), 2s), w["DOOR"], w["POST"]);
  expect_once(stands, sim(1450ms));
  const KinematicState drives = moving({3, 0, 0}, {5, 0, 1}, {0, 0, 2});
  EXPECT_EQ(times_of(ride(w, drives, 2s), w["DOOR"], w["POST"]), stands);
  EXPECT_EQ(times_of(ride(w, turning(drives, {0.3, 1, 0.2}), 2s), w["DOOR"], w["POST"]), stands) << "to the bit";
}

TEST(Carriers, ADoorMeetsALampOutside) {
  const World w(bus_and_lamp(), {"BUS"});
  const auto met = ride(w, moving({0, 0, 0}, {5, 0, 0}), 3s);
  // The door's edge is at 0.5 m and goes at 6 m/s; the lamp's front is at 11.9 m.
  expect_once(times_of(met, w["DOOR"], w["LAMP"]), sim(1900ms));
  EXPECT_THAT(times_of(ride(w, moving({0, 0, 0}), 3s), w["DOOR"], w["LAMP"]), IsEmpty());
}

TEST(Carriers, WhatACarrierDoesIsNoWorkForWhatIsInside) {
  const World w("DEF BUS Transform { children [ " + box("DOOR", "1 2 0.1", "0 1 1.5") +
                    box("POST", "0.1 2 0.1", "2 1 1.5") + "] }\n" + interest("DOOR", "\"POST\""),
                {"BUS"});
  MotionWorld::Counters stands, drives;
  ride(w, moving({0, 0, 0}), 3s, &stands);
  ride(w, turning(moving({3, 0, 0}, {5, 0, 1}), {0.3, 1, 0.2}), 3s, &drives);
  EXPECT_EQ(drives.contact_searches, stands.contact_searches);
}

// An update of the bus comes late, of an instant before what its door has met.
TEST(Carriers, AnotherPastOfTheCarrierIsAnotherPastOfWhatItCarries) {
  const World w(bus_and_lamp(), {"BUS"});
  const KinematicState first = moving({0, 0, 0}, {5, 0, 0}),
                       then = turning(moving({2.5, 0, 0}, {3, 0, 0}), {0, -0.01, 0});
  MotionWorld knows(*w.model, sim(0s)), learns(*w.model, sim(0s));
  for (MotionWorld* world : {&knows, &learns}) {
    for (const char* name : {"BUS", "DOOR"}) world->declare(w[name], Role::kPredicted);
    world->set_base(w["BUS"], sim(0s), first);
    world->set_base(w["DOOR"], sim(0s), moving({0, 1, 1.5}, {1, 0, 0}));
  }
  knows.set_base(w["BUS"], sim(500ms), then);
  knows.advance(sim(5s));
  learns.advance(sim(2s));
  const auto before = contacts_of(learns);
  expect_once(times_of(before, w["DOOR"], w["LAMP"]), sim(1900ms));
  learns.set_base(w["BUS"], sim(500ms), then);
  bool retracted = false;
  for (const auto& event : events_of(learns)) {
    const auto* const back = std::get_if<ContactsRetracted>(&event);
    retracted = retracted || (back != nullptr && back->object == w["DOOR"] && back->since < sim(1800ms));
  }
  EXPECT_TRUE(retracted) << "what the door met is void";
  learns.advance(sim(5s));
  const auto after = contacts_of(learns);
  const auto lamp = times_of(after, w["DOOR"], w["LAMP"]);
  EXPECT_EQ(lamp.size(), 1u);
  EXPECT_EQ(lamp, times_of(contacts_of(knows), w["DOOR"], w["LAMP"]));
  EXPECT_TRUE(same_bits(learns.at(w["DOOR"], sim(5s)), knows.at(w["DOOR"], sim(5s))));
}

// The door and its post meet in the bus, however that has driven: their contact still holds.
TEST(Carriers, WhatHoldsStandsWhenACarriersPastChanges) {
  auto&& [w, world] = Started(bus_and_lamp(),
                              {{"BUS", Role::kPredicted, moving({0, 0, 0}, {5, 0, 0})},
                               {"DOOR", Role::kPredicted, moving({0, 1, 1.5}, {1, 0, 0})}},
                              {"BUS"});
  world.advance(sim(2s));
  world.set_base(w["BUS"], sim(500ms), moving({2.5, 0, 0}, {3, 0, 0}));
  world.advance(sim(2s));
  expect_once(standing(world), sim(1450ms));
}

// The car's front and its wheel come to the wall one after the other: the car touches it since the first of them.
void expect_one_contact_of_the_car(Duration tick) {
  auto&& [w, world] = Started(
      car_and_wheel() + box("WALL", "1 9 9", "5 0 0") + interest("CAR", "\"WALL\"") + interest("WHEEL", "\"WALL\""),
      {{"CAR", Role::kDriven, moving({0, 2, 0}, {1, 0, 0})}}, {"CAR"});
  for (Duration t = tick; t <= 20s; t += tick) world.advance(sim(t));
  const auto met = contacts_of(world);
  expect_once(times_of(met, w["CAR"], w["WALL"]), sim(2500ms));
  expect_once(times_of(met, w["WHEEL"], w["WALL"]), sim(3s));  // another interest
}
TEST(Carriers, APartThatMeetsWhatItsEndTouchesAlreadyIsNoNewContact) {
  expect_one_contact_of_the_car(16ms);
  expect_one_contact_of_the_car(100ms);
}
TEST(Carriers, APartsContactIsNoNewOneHoweverFarOneCallAdvances) { expect_one_contact_of_the_car(20s); }

TEST(Carriers, WhatCarriesAndStandsCostsNothing) {
  auto&& [w, world] =
      Started(bus_and_lamp() + car_and_curb(), {{"BUS", Role::kPredicted}, {"CAR", Role::kPredicted}}, {"BUS", "CAR"});
  world.advance(sim(1s));
  const MotionWorld::Counters at_first = world.counters();
  world.advance(sim(60s));
  EXPECT_EQ(world.counters().contact_searches, 0u);
  EXPECT_EQ(world.counters().searches_far, at_first.searches_far);
  EXPECT_THAT(contacts_of(world), IsEmpty());
  EXPECT_TRUE(world.is_at_rest_from(w["WHEEL"], sim(60s)));
}

TEST(Carriers, WhatIsCarriedRestsOnlyWhereItsCarrierDoes) {
  auto&& [w, world] = Started(car_and_curb(), {{"CAR", Role::kPredicted}}, {"CAR"});
  EXPECT_TRUE(world.is_at_rest_from(w["WHEEL"], sim(0s)));
  world.set_base(w["CAR"], sim(0s), moving({0, 2, 0}, {0, 1, 0}));
  EXPECT_FALSE(world.is_at_rest_from(w["WHEEL"], sim(0s)));
  EXPECT_TRUE(world.is_carried(w["WHEEL"]));
  EXPECT_FALSE(world.is_carried(w["CAR"]));
}

TEST(Carriers, ChangesOfACarrierAreThoseOfWhatItCarries) {
  auto&& [w, world] = Started(car_and_curb(), {{"CAR", Role::kPredicted}}, {"CAR"});
  world.take_changed([](ObjectId) {});
  world.set_base(w["CAR"], sim(0s), moving({0, 2, 0}, {0, 1, 0}));
  std::vector<ObjectId> changed;
  world.take_changed([&](ObjectId id) { changed.push_back(id); });
  EXPECT_THAT(changed, testing::UnorderedElementsAre(w["CAR"], w["WHEEL"]));
}

TEST(Carriers, FramesAreEachOthersInverse) {
  auto&& [w, world] =
      Started(car_and_curb(),
              {{"CAR", Role::kPredicted, turning(moving({4, 2, 0}, {1, 0, 3}, {0, 0, 1}), {0.1, 2, 0.3})}}, {"CAR"});
  const SimTime t = sim(1700ms);
  const KinematicState is = turning(moving({7, 1, 2}, {0, 3, 1}, {2, 0, 0}), {0, 1, 0});
  const KinematicState back = composed(world.at(w["CAR"], t), world.in_carrier(w["WHEEL"], t, is));
  EXPECT_LT((back.position - is.position).norm(), 1e-12);
  EXPECT_LT((back.velocity - is.velocity).norm(), 1e-12);
  EXPECT_LT((back.acceleration - is.acceleration).norm(), 1e-11);
  EXPECT_LT((back.angular_velocity_body - is.angular_velocity_body).norm(), 1e-12);
  const Vec3 v(1, 2, 3);
  EXPECT_LT((world.vector_in_world(w["WHEEL"], t, world.vector_in_carrier(w["WHEEL"], t, v)) - v).norm(), 1e-12);
}

// ---- more carriers while it runs ----

// A bus with a door, of which nobody names the door: one body, until somebody moves the door.
const std::string kBusWithDoor =
    box_with("BUS", "8 0.2 3", "0 0 0", "",
             box_with("DOOR", "1 2 0.1", "0 1 1.5", "", box("HANDLE", "0.1 0.1 0.3", "0.4 0 0"))) +
    box("LAMP", "0.2 5 0.2", "12 1 1.5") + box("HOOK", "0.1 0.1 0.1", "12 1 1.65") + interest("BUS", "\"LAMP\"") +
    interest("HANDLE", "\"HOOK\"");
KinematicState driving(double t_s) { return turning(moving({2 * t_s, 0, 0}, {2, 0, 0}), Vec3::Zero()); }

TEST(ChangedModel, GoesOnAsOneThatKnewTheCarrierFromTheBeginning) {
  const World w(kBusWithDoor, {"BUS"});
  const std::vector owned{w["BUS"], w["DOOR"]};
  const auto known = make_world_model(w.scene, owned), next = extended(*w.model, owned);
  MotionWorld early(*known, sim(0s)), late(*w.model, sim(0s));
  for (MotionWorld* world : {&early, &late}) {
    world->declare(w["BUS"], Role::kDriven);
    world->set_base(w["BUS"], sim(0s), driving(0));
    world->advance(sim(1s));
  }
  EXPECT_LT((late.relative_at(w["HANDLE"], sim(1s)).position - Vec3(0.4, 1, 1.5)).norm(), 1e-6) << "in the bus";
  late.change_model(*next);
  EXPECT_LT((late.relative_at(w["HANDLE"], sim(1s)).position - Vec3(0.4, 0, 0)).norm(), 1e-6) << "in the door";
  for (const Duration t : {Duration(250ms), Duration(1s)}) {
    for (const char* path : {"BUS", "HANDLE", "DOOR"}) {
      EXPECT_LT((late.at(w[path], sim(t)).position - early.at(w[path], sim(t)).position).norm(), 1e-12) << path;
    }
  }
  std::vector<std::vector<ContactEvent>> met;
  for (MotionWorld* world : {&early, &late}) {
    world->declare(w["DOOR"], Role::kDriven);
    world->set_base(w["DOOR"], sim(1s), moving({0, 1, 1.5}, {0.5, 0, 0}));
    world->advance(sim(9s));
    met.push_back(contacts_of(*world));
  }
  ASSERT_EQ(met[0].size(), met[1].size());
  ASSERT_GE(met[0].size(), 2u);
  for (std::size_t i = 0; i < met[0].size(); ++i) {
    EXPECT_EQ(met[0][i].at, met[1][i].at);
    EXPECT_EQ(met[0][i].collider, met[1][i].collider);
    EXPECT_EQ(met[0][i].normal, met[1][i].normal);
  }
}

TEST(ChangedModel, AContactThatGoesOnIsNoNewOne) {
  const World w(kBusWithDoor, {"BUS"});
  const std::vector owned{w["BUS"], w["DOOR"]};
  const auto next = extended(*w.model, owned);
  MotionWorld world(*w.model, sim(0s));
  world.declare(w["BUS"], Role::kDriven);
  world.set_base(w["BUS"], sim(0s), driving(0));
  world.advance(sim(5s));
  EXPECT_EQ(times_of(contacts_of(world), w["BUS"], w["LAMP"]).size(), 1u) << "the lamp is above the floor of the bus";
  world.change_model(*next);
  EXPECT_TRUE(world.ends_touch(w["BUS"], w["LAMP"], sim(5s)));
  world.advance(sim(5500ms));
  EXPECT_TRUE(times_of(contacts_of(world), w["BUS"], w["LAMP"]).empty());
}

// A ball lies on a slab of a floor. When the slab becomes a part of its own, the ball goes on to lie.
TEST(ChangedModel, WhatRestsOnWhatBecomesACarrierGoesOnToRest) {
  auto&& [w, world] = Started(
      "DEF FLOOR Transform { children [ " + box("SLAB", "4 1 4", "0 -0.5 0") + box("EDGE", "1 1 4", "9 -0.5 0") +
          "] }\n" +
          box("BALL", "1 1 1", "0 2 0", "collisionResponse CollisionResponse { responseType 2 restitution 0 } ") +
          interest("BALL", "\"FLOOR\""),
      {{"BALL", Role::kAuthoritative, moving({0, 2, 0}, Vec3::Zero(), {0, -9.81, 0})}});
  world.advance(sim(3s));
  ASSERT_TRUE(world.is_at_rest_from(w["BALL"], sim(3s)));
  const Vec3 lies = world.at(w["BALL"], sim(3s)).position;
  const auto next = extended(*w.model, std::vector{w["SLAB"]});
  world.change_model(*next);
  world.advance(sim(5s));
  EXPECT_TRUE(world.is_at_rest_from(w["BALL"], sim(5s)));
  EXPECT_LT((world.at(w["BALL"], sim(5s)).position - lies).norm(), 1e-6);
  EXPECT_GE(lies.y(), 0.5);
  world.declare(w["SLAB"], Role::kDriven);
  world.set_base(w["SLAB"], sim(5s), moving({0, -0.5, 0}, {0, -20, 0}));
  world.advance(sim(5500ms));
  EXPECT_LT(world.at(w["BALL"], sim(5500ms)).position.y(), lies.y() - 1.0) << "nothing bears it any more";
}

TEST(ChangedModel, PartsThatWereFixedToEachOtherAndTouchGoOnToTouch) {
  auto&& [w, world] = Started("DEF BUS Transform { children [ DEF INNER Group { children " +
                                  box("DOOR", "1 2 0.1", "0 1 1.5") + "} DEF OUTER Group { children " +
                                  box("POST", "0.2 2 0.2", "0.55 1 1.5") + "} ] }\n" + interest("INNER", "\"OUTER\""),
                              {}, {"BUS"});
  world.advance(sim(1s));
  ASSERT_TRUE(world.ends_touch(w["INNER"], w["OUTER"], sim(1s)));
  const auto next = extended(*w.model, std::vector{w["DOOR"]});
  world.change_model(*next);
  world.declare(w["DOOR"], Role::kDriven);
  world.set_base(w["DOOR"], sim(1s), moving({0, 1, 1.5}));
  world.advance(sim(2s));
  EXPECT_TRUE(contacts_of(world).empty()) << "they have always touched";
  world.set_base(w["DOOR"], sim(2s), moving({0, 1, 1.5}, {-1, 0, 0}));
  world.advance(sim(2020ms));
  EXPECT_TRUE(world.ends_touch(w["INNER"], w["OUTER"], sim(2020ms))) << "for 50 ms yet";
  world.advance(sim(4s));
  EXPECT_TRUE(contacts_of(world).empty());
  EXPECT_FALSE(world.ends_touch(w["INNER"], w["OUTER"], sim(4s)));
}

// A car of a peer that has gone stands where that has left it, and somebody else owns its wheel.
TEST(ChangedModel, ANewCarrierIsWhereItStands) {
  auto&& [w, world] = Started(car_and_wheel(), {{"CAR", Role::kPredicted}, {"CAR/WHEEL", Role::kPredicted}});
  world.set_base(w["CAR"], sim(1s), moving({10, 2, 0}));
  world.set_base(w["CAR/WHEEL"], sim(1s), moving({11, 1, 3}));
  world.advance(sim(2s));
  const auto next = extended(*w.model, std::vector{w["CAR"], w["CAR/WHEEL"]});
  world.change_model(*next);
  EXPECT_EQ(world.at(w["CAR/WHEEL"], sim(2s)).position, Vec3(11, 1, 3));
  EXPECT_EQ(world.relative_at(w["CAR/WHEEL"], sim(2s)).position, Vec3(1, -1, 3));
}

// A ball in a bus bounces off a wall outside, and then the bus turns out to have stood.
TEST(Carriers, WhatIsCarriedUndoesItsAnswerToWhatItsCarrierDidNotMeet) {
  auto&& [w, world] = Started(
      "DEF BUS Transform { children [ " + box("BALL", "1 1 1", "0 2 0", kBounces) + box("CASE", "1 1 1", "0 4 0") +
          "] }\n" + "DEF WALL Group { children [ " + box("LOW", "1 9 9", "8 0 0") + box("HIGH", "1 9 9", "9 9 0") +
          "] }\n" + interest("BUS/BALL", "\"WALL\"") + interest("BUS/CASE", "\"WALL\""),
      {{"BUS", Role::kPredicted, moving({0, 0, 0}, {2, 0, 0})}, {"BUS/BALL", Role::kPredicted}}, {"BUS"});
  world.advance(sim(5s));
  ASSERT_FALSE(contacts_of(world).empty());
  ASSERT_NE(world.relative_at(w["BUS/BALL"], sim(5s)).velocity, Vec3(Vec3::Zero()));
  world.set_base(w["BUS"], sim(1s), moving({2, 0, 0}));
  EXPECT_EQ(world.relative_at(w["BUS/BALL"], sim(5s)).velocity, Vec3(Vec3::Zero()));
  EXPECT_EQ(world.relative_at(w["BUS/BALL"], sim(5s)).position, Vec3(0, 2, 0));
  std::size_t of_case = 0;
  while (const auto event = world.poll_event()) {
    const auto* retracted = std::get_if<ContactsRetracted>(&*event);
    of_case += retracted != nullptr && retracted->object == w["BUS/CASE"] ? 1 : 0;
  }
  EXPECT_EQ(of_case, 1u) << "once, of however many parts the wall is";
}

TEST(MotionWorldPutOff, APairStopsWhereCollisionWouldBeAskedAndGoesOnFromThere) {
  const World world(corridor());
  const ObjectId ball = world["BALL"];
  MotionWorld all(*world.model, sim(0s)), late(*world.model, sim(0s));
  for (MotionWorld* const each : {&all, &late}) each->declare(ball, Role::kPredicted);
  for (std::uint32_t i = 0; i < world.model->part_pairs.size(); ++i) late.put_off(i, true);
  for (MotionWorld* const each : {&all, &late}) {
    each->set_base(ball, sim(100ms), moving({0, 0, 0}, {1, 0, 0}));
    each->advance(sim(5s));
  }
  EXPECT_EQ(late.counters().contact_searches, 0u);
  EXPECT_EQ(late.counters().searches_put_off, late.stopped().size());
  ASSERT_FALSE(late.stopped().empty());
  EXPECT_FALSE(same_bits(all.at(ball, sim(5s)), late.at(ball, sim(5s))));
  for (std::uint32_t i = 0; i < world.model->part_pairs.size(); ++i) late.put_off(i, false);
  EXPECT_TRUE(late.stopped().empty());
  late.catch_up();
  EXPECT_TRUE(same_bits(all.at(ball, sim(5s)), late.at(ball, sim(5s))));
}

// What an update contains is not looked for again; nor is what is to be forgotten.
TEST(MotionWorldPutOff, APairGoesOnFromItsLastBaseOrFromNow) {
  const World world(corridor());
  const ObjectId ball = world["BALL"];
  MotionWorld late(*world.model, sim(0s));
  late.declare(ball, Role::kPredicted);
  for (std::uint32_t i = 0; i < world.model->part_pairs.size(); ++i) late.put_off(i, true);
  late.set_base(ball, sim(100ms), moving({2, 0, 0}, {1, 0, 0}));
  late.advance(sim(4s));
  late.set_base(ball, sim(4s), moving({0, 0, 0}, {0.1, 0, 0}));
  for (std::uint32_t i = 0; i < world.model->part_pairs.size(); ++i) late.put_off(i, false, i == 0);
  late.advance(sim(5s));
  EXPECT_EQ(late.counters().contacts, 0u) << "the one at 0.85 s is past";
}

// ---- driven supports ----

// Samples of a lift are a jerk apart from where the one before led. Of a shove nothing leads there.
TEST(MotionWorldLift, CarriesAStackAtAnyTickRate) {
  const std::string by_impulse = " collisionResponse CollisionResponse { responseType 2 restitution 0.5 } ";
  for (const double hz : {20.0, 60.0, 144.0}) {
    SCOPED_TRACE(hz);
    const KinematicState falls = moving({0, 1, 0}, {0, 0, 0}, {0, -9.81, 0});
    KinematicState above = falls;
    above.position.y() = 2.0;
    auto&& [w, world] =
        Started(box("LIFT", "4 1 4", "0 0 0") + box("A", "1 1 1", "0 1 0", by_impulse) +
                    box("B", "1 1 1", "0 2 0", by_impulse) + interest("A", R"("LIFT" "B")") + interest("B", "\"A\""),
                {{"LIFT", Role::kDriven}, {"A", Role::kAuthoritative, falls}, {"B", Role::kAuthoritative, above}});
    std::size_t contacts = 0;
    for (int k = 0; k <= 8 * static_cast<int>(hz); ++k) {
      const double t = k / hz, turn = 3.0 * t;
      const SimTime at = sim(from_seconds(t));
      world.advance(at);
      world.set_base(
          w["LIFT"], at,
          moving({0, 0.5 * (1.0 - std::cos(turn)), 0}, {0, 1.5 * std::sin(turn), 0}, {0, 4.5 * std::cos(turn), 0}));
      contacts += contacts_of(world).size();
      const double lift = world.at(w["LIFT"], at).position.y();
      ASSERT_NEAR(world.at(w["A"], at).position.y(), lift + 1.0, 1e-12) << t;
      ASSERT_NEAR(world.at(w["B"], at).position.y(), lift + 2.0, 1e-12) << t;
    }
    EXPECT_LE(contacts, 2u) << "they are there at the start, and go on";
    const SimTime end = world.advanced();
    world.set_base(w["LIFT"], end, moving({0, -50, 0}, {0, 0, 0}));
    world.advance(end + 100ms);
    EXPECT_GT(world.at(w["A"], end + 100ms).position.y(), 0.5) << "it falls, and is not carried away";
  }
}

// A box stands on a lift.
std::string box_on_lift(const char* restitution) {
  const std::string response = " collisionResponse CollisionResponse { responseType 2 restitution ";
  return box("LIFT", "4 1 4", "0 0 0") + box("A", "1 1 1", "0 1 0", response + restitution + " } ") +
         interest("A", R"("LIFT")");
}
const KinematicState kFalls = moving({0, 1, 0}, {0, 0, 0}, {0, -9.81, 0});

// A lift that goes down and stops between two samples is further up than its last law led: it pushes the box out.
TEST(MotionWorldLift, PushesOutWhatItsStopHasRunInto) {
  auto&& [w, world] = Started(box_on_lift("0.3"), {{"LIFT", Role::kDriven}, {"A", Role::kAuthoritative, kFalls}});
  for (int k = 0; k <= 300; ++k) {
    const double t = k / 60.0, stop = 3.01;
    const SimTime at = sim(from_seconds(t));
    world.advance(at);
    world.set_base(w["LIFT"], at, moving({0, -std::min(t, stop), 0}, {0, t < stop ? -1.0 : 0.0, 0}));
    ASSERT_GE(world.at(w["A"], at).position.y() - world.at(w["LIFT"], at).position.y(), 1.0 - 1e-8) << t;
  }
  // They met at a whole nanosecond, at 1 m/s.
  EXPECT_NEAR(world.at(w["A"], sim(5s)).position.y(), 1.0 - 3.01, 1e-9);
  EXPECT_TRUE(world.is_at_rest_from(w["A"], sim(5s)));
}

// Differences that give a stop its velocity leave their rounding, and the body's acceleration has that of its own.
TEST(MotionWorldLift, BearsWhatItBoreWhereItsLawIsNothingButRounding) {
  auto&& [w, world] = Started(box_on_lift("0.5"), {{"LIFT", Role::kDriven}, {"A", Role::kAuthoritative, kFalls}});
  for (int k = 0; k <= 1000; ++k) {
    const SimTime at = sim(k * 10ms);
    const double turn = 0.02 * std::numbers::pi * std::min(k, 50), rate = 2.0 * std::numbers::pi;
    world.advance(at);
    world.set_base(w["LIFT"], at,
                   k < 50 ? moving({0, -0.1 * (1.0 - std::cos(turn)), 0}, {0, -0.1 * rate * std::sin(turn), 0},
                                   {0, -0.1 * rate * rate * std::cos(turn), 0})
                          : moving({0, -0.2, 0}, {0, -7.6e-14, 0}, {0, 1.94e-11, 0}));
    ASSERT_NEAR(world.at(w["A"], at).position.y() - world.at(w["LIFT"], at).position.y(), 1.0, 1e-8) << k;
  }
}

// ---- what others have published of what is borne ----

// It rested on its ghost of the support. Its owner, whose own ghost of that is a little higher, says that it is borne.
TEST(MotionWorldBorne, GoesOnAsPublishedWhereNothingTouchesIt) {
  auto&& [w, world] = Started(box_on_lift("0"), {{"LIFT", Role::kPredicted}, {"A", Role::kPredicted, kFalls}});
  world.advance(sim(1s));
  (void)events_of(world);
  world.set_base(w["LIFT"], sim(1s), moving({0, 0, 0}, {0, 0.1, 0}, {0, 0.5, 0}));
  const KinematicState published = moving({0, 1.0001, 0}, {0, 0.1, 0}, {0, 0.5, 0});
  world.set_base(w["A"], sim(1s), published, {}, Vec3(0, -9.81, 0));
  world.advance(sim(2s));
  EXPECT_NEAR(world.at(w["A"], sim(2s)).position.y(), advance(published, 1.0).position.y(), 1e-12);
  EXPECT_TRUE(contacts_of(world).empty());
}

// Its support was rounded when it was published, and is a little higher here, and a little faster downwards.
TEST(MotionWorldBorne, KeepsUpWithADrivenSupportThatIsOffByItsRounding) {
  auto&& [w, world] = Started(box_on_lift("0"), {{"LIFT", Role::kPredicted}, {"A", Role::kPredicted, kFalls}});
  world.advance(sim(1s));
  world.set_base(w["LIFT"], sim(1s), moving({0, 0, 0}, {0, -0.492188, 0}, {0, 1.14844, 0}));
  world.set_base(w["A"], sim(1s), moving({0, 1.0 - 2.1e-4, 0}, {0, -0.490269, 0}, {0, 1.14603, 0}), {},
                 Vec3(0, -9.81, 0));
  for (Duration t = 1s; t <= 1400ms; t += 10ms) {
    world.advance(sim(t));
    EXPECT_NEAR(world.at(w["A"], sim(t)).position.y() - world.at(w["LIFT"], sim(t)).position.y(), 1.0 - 2.1e-4, 1e-9);
  }
}

// An update comes late that lets it fall on a lift of this peer, on which it stood.
TEST(MotionWorldBorne, RestsOnWhatIsDrivenHereFromItsLateUpdateOn) {
  auto&& [w, world] = Started(box_on_lift("0.2"), {{"LIFT", Role::kDriven}, {"A", Role::kPredicted}});
  world.advance(sim(2s));
  world.set_base(w["A"], sim(1s), kFalls);
  world.advance(sim(2s));
  EXPECT_EQ(world.at(w["A"], sim(2s)).position.y(), 1.0);
}

// Its owner found a contact in another nanosecond.
TEST(MotionWorldBorne, RestsWhereItIsPublishedButForRounding) {
  const std::string by_impulse = " collisionResponse CollisionResponse { responseType 2 } ";
  for (const double off : {-2e-11, 2e-11}) {
    SCOPED_TRACE(off);
    auto&& [w, world] =
        Started(box("TABLE", "4 1 4", "0 0 0") + box("A", "1 1 1", "0 1 0", by_impulse) +
                    box("B", "1 1 1", "0 2 0", by_impulse) + interest("A", R"("TABLE" "B")") + interest("B", R"("A")"),
                {{"A", Role::kPredicted, moving({0, 1, 0}, {0, 0, 0}, {0, -9.81, 0})},
                 {"B", Role::kPredicted, moving({0, 2, 0}, {0, 0, 0}, {0, -9.81, 0})}});
    world.advance(sim(1s));
    (void)events_of(world);
    world.set_base(w["A"], sim(1s), moving({0, 1.0 + off, 0}), {}, Vec3(0, -9.81, 0));
    world.advance(sim(3s));
    EXPECT_EQ(world.at(w["B"], sim(3s)).position.y(), 2.0);
    EXPECT_TRUE(contacts_of(world).empty());
  }
}

// One solution for all that is struck: others, who know of two at a time, would find another one.
TEST(MotionWorldBorne, AContactThatIsDecidedHereTellsOfAllThatItStrikes) {
  const std::string by_impulse = " collisionResponse CollisionResponse { responseType 2 restitution 0.5 } ";
  auto&& [w, world] =
      Started(box("A", "1 1 1", "-1 0 0", by_impulse) + box("B", "1 1 1", "0 0 0", by_impulse) +
                  box("C", "1 1 1", "3 0 0", by_impulse) + interest("A", R"("B")") + interest("B", R"("A" "C")") +
                  interest("C", R"("B")"),
              {{"A", Role::kPredicted, moving({-1, 0, 0}, {0, 0, 0}, {1, 0, 0})},
               {"B", Role::kPredicted, moving({0, 0, 0}, {0, 0, 0}, {-1, 0, 0})},  // they press each other
               {"C", Role::kPredicted, moving({3, 0, 0}, {-2, 0, 0})}});
  world.set_authority({[](ObjectId, ObjectId, SimTime t) {
                         return t > sim(500ms) ? ContactAuthority::kLocal : ContactAuthority::kAsPublished;
                       },
                       {}});
  world.advance(sim(1010ms));
  std::vector<ContactEvent> decided;
  for (const ContactEvent& each : contacts_of(world)) {
    if (each.at > sim(500ms)) decided.push_back(each);
  }
  ASSERT_EQ(decided.size(), 2u);
  EXPECT_EQ(decided[0].at, decided[1].at);
  const auto of_a = [&](const ContactEvent& c) { return c.collider == w["A"] || c.collidee == w["A"]; };
  EXPECT_FALSE(of_a(decided[0]));
  ASSERT_TRUE(of_a(decided[1]));
  const KinematicState& after = decided[1].collider == w["A"] ? decided[1].collider_after : decided[1].collidee_after;
  EXPECT_LT(after.velocity.x(), -0.5);
  EXPECT_EQ(after.velocity, world.at(w["A"], decided[1].at).velocity);
}

// Both are let go at 0 s towards each other. This world has found that A presses a B at rest when B's law comes.
TEST(MotionWorldBorne, ALawOfTheInstantAtWhichItIsPressedCounts) {
  const std::string dead = " collisionResponse CollisionResponse { responseType 2 restitution 0 } ";
  auto&& [w, world] = Started(box("A", "1 1 1", "0 0 0", dead) + box("B", "1 1 1", "1 0 0", dead) +
                                  interest("A", R"("B")") + interest("B", R"("A")"),
                              {{"A", Role::kAuthoritative}, {"B", Role::kPredicted, moving({1, 0, 0})}});
  world.set_authority({[](ObjectId, ObjectId, SimTime) { return ContactAuthority::kLocal; }, {}});
  world.set_free_acceleration(w["A"], Vec3(2, 0, 0));
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}, {0, 0, 0}, {2, 0, 0}));
  world.advance(sim(0s));
  ASSERT_EQ(only(contacts_of(world)).at, sim(0s));
  world.set_base(w["B"], sim(0s), moving({1, 0, 0}, {0, 0, 0}, {-2, 0, 0}));
  world.advance(sim(1s));
  const auto pressed = only(contacts_of(world));
  EXPECT_EQ(pressed.at, sim(0s));
  EXPECT_TRUE(pressed.rests);
  for (const char* each : {"A", "B"}) {
    EXPECT_EQ(world.at(w[each], sim(1s)).acceleration.x(), 0.0) << each;
    EXPECT_EQ(world.at(w[each], sim(1s)).velocity.x(), 0.0) << each;
  }
}

}  // namespace peerd::replication::motion_world_test
