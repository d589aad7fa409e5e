#include "replication/physics/world/tick_detection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision/engines/engine.hpp"
#include "replication/settings/output/tick_grid.hpp"
#include "tests/must.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::tick_detection_test {

using namespace test;
using testing::SizeIs;

std::unique_ptr<TickDetection> detection_by(const char* engine, std::uint32_t hz) {
  return std::make_unique<TickDetection>(collision::engines::make_engine(engine).value().narrow_phase, hz);
}

// The ball meets the right wall after exactly 1.5 s, between two ticks of 7 Hz.
TEST(TickDetection, FindsAContactAtTheNextTick) {
  const World w(corridor());
  for (const char* engine : {"obb", "kdop,k=14", "i-collide", "rapid-world"}) {
    const auto detection = detection_by(engine, 7);
    MotionWorld world(*w.model, sim(0s));
    world.set_tick_detection(*detection);
    world.declare(w["BALL"], Role::kPredicted);
    world.set_base(w["BALL"], sim(0s), moving({0, 1, 0}, {2, 0.5, 0}));
    world.advance(sim(2s));
    const auto contact = only(contacts_of(world));
    EXPECT_EQ(contact.at, TickGrid(7).time_of(11)) << engine;  // 1.571 s
    EXPECT_EQ(contact.collidee, w["RIGHT"]) << engine;
    EXPECT_EQ(contact.normal, -Vec3::UnitX()) << engine;
    EXPECT_EQ(contact.collider_after.velocity, Vec3(-2, 0.5, 0)) << engine;
  }
}

TEST(TickDetection, WhatIsAnsweredCrossesTheCorridor) {
  const World w(corridor());
  const auto detection = detection_by("obb", 50);
  MotionWorld world(*w.model, sim(0s));
  world.set_tick_detection(*detection);
  world.declare(w["BALL"], Role::kPredicted);
  world.set_base(w["BALL"], sim(0s), moving({2.9, 0, 0}, {6, -4, 3}));
  world.advance(sim(2s));
  const auto seen = contacts_of(world);
  ASSERT_THAT(seen, SizeIs(2));
  EXPECT_EQ(seen[0].at, sim(20ms));
  EXPECT_EQ(seen[0].collidee, w["RIGHT"]);
  EXPECT_EQ(seen[1].collidee, w["LEFT"]);
  EXPECT_EQ(world.at(w["BALL"], sim(2s)).velocity, Vec3(6, -4, 3));
}

TEST(TickDetection, WhatStopsInTheWallMeetsItOnce) {
  const World w(corridor(kStops));
  const auto detection = detection_by("obb", 10);
  MotionWorld world(*w.model, sim(0s));
  world.set_tick_detection(*detection);
  world.declare(w["BALL"], Role::kPredicted);
  world.set_base(w["BALL"], sim(0s), moving({2.5, 0, 0}, {6, 0, 0}));
  world.advance(sim(3s));
  EXPECT_THAT(contacts_of(world), SizeIs(1));
  EXPECT_NEAR(world.at(w["BALL"], sim(3s)).position.x(), 3.1, 1e-9);
}

// Beside the middle of the wall, in it to a part of its size: what goes out meets nothing, whatever its way along.
TEST(TickDetection, ThoseThatAnswerMeetOnlyWhatTheyComeTowards) {
  const World w(corridor());
  const auto detection = detection_by("obb", 10);
  const Timeline wall(sim(0s), moving({3.75, 0, 0}));
  const Timeline* const of_wall = &wall;
  const auto first = [&](const Vec3& velocity, collision::MeetAs as) {
    const Timeline ball(sim(0s), moving({3.1, 2, -1}, velocity));
    const Timeline* const of_ball = &ball;
    const MovingPart part_a{{&of_ball, 1}, w.model->body(w["BALL"])}, part_b{{&of_wall, 1}, w.model->body(w["RIGHT"])};
    std::uint64_t searches = 0;
    return detection->first_contact({{&part_a, 1}, {&part_b, 1}, CollisionType::kWitness, as}, sim(0s), sim(50ms),
                                    searches);
  };
  using collision::ContactState, collision::MeetAs;
  EXPECT_EQ(first({-0.1, 3, 2}, MeetAs::kSolids).contact.state, ContactState::kSeparated);
  EXPECT_EQ(first({0, 3, 2}, MeetAs::kSolids).contact.state, ContactState::kSeparated);
  EXPECT_EQ(first({-0.1, 3, 2}, MeetAs::kPolygons).contact.state, ContactState::kContact);
  const PartContact met = first({0.1, 3, 2}, MeetAs::kSolids);
  EXPECT_EQ(met.contact.state, ContactState::kContact);
  EXPECT_EQ(met.contact.normal_world, -Vec3::UnitX());
  EXPECT_EQ(met.at, sim(0s));
}

// Two cubes of one size on one line share the planes of four sides.
TEST(TickDetection, SidesInOnePlaneAreNotWhatIsMet) {
  const World w(box("A", "1 1 1", "-2 0 0", kBounces) + box("B", "1 1 1", "2 0 0", kBounces) + interest("A", "\"B\"") +
                interest("B", "\"A\""));
  const auto detection = detection_by("aabb", 60);
  MotionWorld world(*w.model, sim(0s));
  world.set_tick_detection(*detection);
  for (const char* name : {"A", "B"}) world.declare(w[name], Role::kPredicted);
  world.set_base(w["A"], sim(0s), moving({-2, 0, 0}, {1, 0, 0}));
  world.set_base(w["B"], sim(0s), moving({2, 0, 0}, {-1, 0, 0}));
  world.advance(sim(3s));
  const auto seen = only(contacts_of(world));
  EXPECT_EQ(seen.normal.cwiseAbs(), Vec3::UnitX());
  EXPECT_GE(seen.at, sim(1500ms));
  EXPECT_LT(seen.at, sim(1500ms) + 17ms);
  EXPECT_EQ(world.at(w["A"], sim(3s)).velocity, Vec3(-1, 0, 0));
}

// Nobody answers: a contact lasts from the first tick at which the two touch, and the next one needs a parting.
TEST(TickDetection, WithoutAnAnswerAContactLastsFromTickToTick) {
  const World w(box("A", "1 1 1", "-5 0 0") + box("B", "1 1 1", "0 0.25 0.25") + interest("A", "\"B\""));
  const auto detection = detection_by("obb", 10);
  MotionWorld world(*w.model, sim(0s));
  world.set_tick_detection(*detection);
  world.declare(w["A"], Role::kDriven);
  world.set_base(w["A"], sim(0s), moving({-5, 0, 0}, {3, 0, 0}));
  world.advance(sim(4s));
  const auto seen = only(contacts_of(world));
  EXPECT_EQ(seen.at, sim(1400ms));  // it touches from 1.333 s to 2 s
}

// What is found hangs on the timelines alone.
TEST(TickDetection, AnyFrameRateGivesTheSameContacts) {
  const World w(corridor());
  std::vector<std::vector<SimTime>> all;
  for (const Duration step : {Duration(3ms), Duration(16ms), Duration(77ms), Duration(4s)}) {
    const auto detection = detection_by("quickcd", 30);
    MotionWorld world(*w.model, sim(0s));
    world.set_tick_detection(*detection);
    world.declare(w["BALL"], Role::kPredicted);
    world.set_base(w["BALL"], sim(0s), moving({0, 1, 0}, {7, 0.5, 0.25}));
    for (Duration t = step; t <= 4s; t += step) world.advance(sim(t));
    world.advance(sim(4s));
    all.push_back(contact_times(world));
  }
  EXPECT_THAT(all[0], SizeIs(testing::Ge(4u)));
  for (const auto& times : all) EXPECT_EQ(times, all[0]);
}

TEST(TickDetection, TicksAreThoseOfTheGrid) {
  const World w(corridor());
  for (const std::uint32_t hz : {1u, 7u, 60u, 144u, 1000u}) {
    const auto detection = detection_by("obb", hz);
    const TickGrid grid(hz);
    for (std::int64_t k = -200; k < 400; ++k) {
      const SimTime t = grid.time_of(k);
      EXPECT_EQ(detection->next_tick_after(t), grid.time_of(k + 1)) << hz;
      EXPECT_EQ(detection->next_tick_after(t - Duration{1}), t) << hz;
      EXPECT_EQ(detection->next_tick_after(t + Duration{1}), grid.time_of(k + 1)) << hz;
    }
  }
}

}  // namespace peerd::replication::tick_detection_test
