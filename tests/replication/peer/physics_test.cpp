// Objects that answer by impulse, in a MotionWorld: they come to rest, pass momentum on, and two worlds with the same
// updates find the same, to the last bit.
#include <gtest/gtest.h>

#include "replication/physics/laws/response.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::physics_test {

using namespace test;

std::string answers(double restitution, double friction = 0.0) {
  return " collisionResponse CollisionResponse { responseType 2 restitution " + std::to_string(restitution) +
         " friction " + std::to_string(friction) + " } ";
}
std::string ball(const std::string& name, const std::string& at, const std::string& fields) {
  return "DEF " + name + " Transform { translation " + at + " " + fields +
         " children Shape { geometry Sphere { radius 0.1 } } }\n";
}
struct Dropped {
  const char* name;
  const char* geometry;
  double low_m;  // from its centre down
  double height_m, restitution, across_m_s;
};
class Drop : public testing::TestWithParam<Dropped> {};
TEST_P(Drop, ComesToRestOnTheFloorAndSlidesOn) {
  const Dropped& c = GetParam();
  auto&& [world, motions] =
      Started("DEF BALL Transform { translation 0 " + std::to_string(c.height_m + c.low_m) + " 0 " +
                  answers(c.restitution, 0.5) + " children Shape { geometry " + c.geometry + " } }\n" +
                  box("FLOOR", "60 0.2 60", "0 -0.1 0", answers(1.0)) + interest("BALL", "\"FLOOR\""),
              {{"BALL", Role::kAuthoritative}});
  const Vec3 from = world.scene.rigid_pose(world["BALL"]).position;
  motions.set_base(world["BALL"], sim(0s), moving(from, {c.across_m_s, 0, 0}, {0, -9.81, 0}));
  for (Duration t = 0s; t <= 40s; t += 7ms) {
    motions.advance(sim(t));
    ASSERT_GT(motions.at(world["BALL"], sim(t)).position.y(), c.low_m - 1e-5) << to_seconds(t);
  }
  const KinematicState end = motions.at(world["BALL"], sim(40s));
  EXPECT_EQ(end.velocity, Vec3::Zero());
  EXPECT_NEAR(end.position.y(), c.low_m, 1e-5);
  EXPECT_GT(end.position.x(), 0.0);
  EXPECT_GE(motions.counters().came_to_rest, 1u);
  EXPECT_LT(motions.counters().contacts, 200u);
  EXPECT_EQ(motions.counters().jammed, 0u);
  EXPECT_EQ(motions.counters().overlapped, 0u);
}
INSTANTIATE_TEST_SUITE_P(Table, Drop,
                         testing::Values(Dropped{"Ball", "Sphere { radius 0.1 }", 0.1, 1.0, 0.75, 0.9},
                                         Dropped{"BallFromHigh", "Sphere { radius 0.1 }", 0.1, 20.0, 0.8, 1.0},
                                         Dropped{"SmallBall", "Sphere { radius 0.0335 }", 0.0335, 1.3, 0.6, 1.0},
                                         Dropped{"DeadBall", "Sphere { radius 0.1 }", 0.1, 2.0, 0.0, 0.7},
                                         Dropped{"Cube", "Box { size 0.2 0.2 0.2 }", 0.1, 1.0, 0.75, 0.9},
                                         Dropped{"CubeFromHigh", "Box { size 0.2 0.2 0.2 }", 0.1, 10.0, 0.8, 2.0}),
                         [](const auto& c) { return std::string(c.param.name); });

// The result does not depend on how far each world had advanced when the update came, nor on how often it advanced.
TEST(Ghosts, AreTheSameBitsWhenTheUpdateComesLate) {
  const std::string text =
      ball("A", "0 0 0", answers(0.9, 0.3)) + ball("B", "1 0.02 0", answers(0.9, 0.3)) +
      ball("C", "2 0.01 0", answers(0.9, 0.3)) + box("WALL", "1 9 9", "3 0 0", answers(0.8)) +
      box("BACK", "1 9 9", "-1 0 0", answers(0.8)) + interest("A", "\"B\" \"C\" \"WALL\" \"BACK\"") +
      interest("B", "\"A\" \"C\" \"WALL\" \"BACK\"") + interest("C", "\"A\" \"B\" \"WALL\" \"BACK\"");
  const World world(text);
  const MotionModel shot = sliding_to_rest(moving({0, 0, 0}, {6.1, 0.07, 0}), 0.3);
  const SimTime at = sim(1234567891ns), end = sim(9s);
  const auto run = [&](Duration began, Duration step, Duration late) {
    auto motions = std::make_unique<MotionWorld>(*world.model, sim(began));
    for (const char* name : {"A", "B", "C"}) motions->declare(world[name], Role::kPredicted);
    bool updated = false;
    for (Duration t = began; sim(t) <= end; t += step) {
      if (!updated && sim(t) >= at + late) {
        motions->set_base(world["A"], at, shot);
        updated = true;
      }
      motions->advance(sim(t));
    }
    motions->advance(end);
    return motions;
  };
  const auto first = run(0s, 16666666ns, 0s);
  EXPECT_GT(first->counters().contacts, 4u);
  for (const auto& [began, step, late] : {std::tuple<Duration, Duration, Duration>{111ms, 6944444ns, 500ms},
                                          {777ms, 33333333ns, 5ms},
                                          {1s, 1s, 1s},
                                          {313131313ns, 3ms, 3s}}) {
    const auto other = run(began, step, late);
    for (const char* name : {"A", "B", "C"}) {
      EXPECT_GT(first->at(world[name], end).position.norm(), 0.1);
      EXPECT_TRUE(same_bits(first->at(world[name], end), other->at(world[name], end))) << name << " " << late.count();
    }
  }
}

// A peer that learns of an object's owner late searches from another instant on. This must not change anything, not
// even the last bit of the line of centres.
TEST(Ghosts, AreTheSameBitsWhereAnObjectIsDeclaredLate) {
  for (int i = 0; i < 50; ++i) {
    const World world(ball("A", "0 0 0", answers(0.9)) +
                      ball("B", "3 0.0" + std::to_string(10 + i) + " 0.03", answers(0.9)) + interest("A", "\"B\"") +
                      interest("B", "\"A\""));
    const auto run = [&](Duration declared) {
      MotionWorld motions(*world.model, sim(0s));
      motions.set_base(world["A"], sim(0s), moving({0, 0, 0}, {1.7, 0.01, 0}, {0.1, 0, 0}));
      motions.advance(sim(declared));
      motions.declare(world["A"], Role::kPredicted);
      motions.declare(world["B"], Role::kPredicted);
      motions.advance(sim(3s));
      EXPECT_EQ(motions.counters().contacts, 1u);
      return motions.at(world["B"], sim(3s));
    };
    const KinematicState first = run(0s);
    for (const Duration declared : {Duration(313131313), Duration(1511111111), Duration(1537000001)})
      EXPECT_TRUE(same_bits(first, run(declared))) << i;
  }
}

// A former defect: an object that slides for longer than models last turned around where it should have stopped.
TEST(Sliding, StopsHoweverLongItTakes) {
  const MotionModel law = sliding_to_rest(moving({0, 0, 0}, {4, 0, 0}), 0.1);  // 40 s, 80 m
  const Timeline timeline(sim(0s), law);
  EXPECT_NEAR(timeline.at(sim(39s)).position.x(), 79.95, 1e-9);
  EXPECT_NEAR(timeline.at(sim(60s)).position.x(), 80.0, 1e-6);
  EXPECT_EQ(timeline.at(sim(60s)).velocity, Vec3::Zero());
}

// With a one-sided interest only one object answers. A peer that receives the outcome must know that the other one
// slides on.
TEST(Outcome, ReportsSlidingObjectsWithoutAResponse) {
  const World world(ball("A", "0 0 0", answers(1.0)) + ball("B", "3 0 0.7", answers(1.0, 0.2)) +
                    interest("A", "\"B\""));
  int met = 0;
  for (int i = 0; i < 40; ++i) {
    MotionWorld motions(*world.model, sim(0s));
    motions.declare(world["A"], Role::kAuthoritative);
    motions.declare(world["B"], Role::kAuthoritative);
    motions.set_base(world["A"], sim(0s), moving({0, 0, 0}, {2, 0, 0}));
    const KinematicState slides = moving({3, 0, 0.7}, {-2.3 - 0.013 * i, 0, -1.1});
    motions.set_base(world["B"], sim(0s), sliding_to_rest(slides, 0.2F));
    motions.advance(sim(2s));
    for (const ContactEvent& contact : contacts_of(motions)) {
      ++met;
      const MotionModel law = law_of_outcome(world.model->response_of(world["B"]), contact.collidee_after);
      EXPECT_EQ(law.kind, MotionKind::kSliding) << i;
      EXPECT_EQ(contact.collidee_after.velocity, contact.collidee_before.velocity);
    }
  }
  EXPECT_GT(met, 10);
}

}  // namespace peerd::replication::physics_test
