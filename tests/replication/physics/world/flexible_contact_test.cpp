#include "replication/physics/world/flexible_contact.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::flexible_contact_test {

using namespace test;

// GROWS is a cube of 1 m whose scale along x goes from 1 to 4 in 2 s and back; WALL's face is at x = `face`.
std::string grows(double face, int type, const std::string& wall_fields = "", bool carried = false) {
  const std::string cube = box("GROWS", "1 1 1", "0 0 0");
  return (carried ? "DEF CART Transform { children " + cube + "}\n" : cube) +
         box("WALL", "1 4 4", std::to_string(face + 0.5) + " 0 0", wall_fields) +
         "CollisionInterest { objectPath \"GROWS\" interests [\"WALL\"] collisionType " + std::to_string(type) +
         " }\n" + kGrows;
}

struct Flexing {
  explicit Flexing(const std::string& text, const std::vector<const char*>& moved = {})
      : world(text, moved), flexible(*world.model), motion(*world.model, sim(0s)) {
    flexible.set_world_zero(sim(0s));
    motion.set_flexible(flexible);
  }
  std::vector<double> contacts_until_s(double until_s) {
    for (double t = 0.1; t <= until_s; t += 0.1) motion.advance(sim(seconds(t)));
    return contacts_s();
  }
  std::vector<double> contacts_s() {
    std::vector<double> times;
    for (const SimTime at : contact_times(motion)) times.push_back(to_seconds(at.time_since_epoch()));
    return times;
  }

  World world;
  FlexibleParts flexible;
  MotionWorld motion;
};

class Growing : public testing::TestWithParam<CollisionType> {};

// The half width is 0.5 + 0.75 t until 2 s, and shrinks from then on: one contact in each cycle of 4 s.
TEST_P(Growing, MeetsAWallWhenItIsWideEnough) {
  for (const double face : {0.75, 1.1, 1.9}) {
    Flexing f(grows(face, static_cast<int>(GetParam())));
    ASSERT_EQ(f.world.model->flexible.size(), 1u);
    const auto times = f.contacts_until_s(7.9);
    ASSERT_EQ(times.size(), 2u) << face;
    const double expected_s = (static_cast<double>(static_cast<float>(face + 0.5)) - 1.0) / 0.75;  // as the file has it
    for (std::size_t i = 0; i < 2; ++i) {
      const double at_s = expected_s + 4.0 * static_cast<double>(i);
      EXPECT_LE(times[i], at_s + 1e-9) << "never late";
      EXPECT_GE(times[i], at_s - 4e-6) << "early by a few micrometres at most";
    }
  }
}

TEST_P(Growing, MeetsNoWallThatIsTooFar) {
  Flexing f(grows(2.001, static_cast<int>(GetParam())));
  EXPECT_THAT(f.contacts_until_s(8.0), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Types, Growing, testing::Values(CollisionType::kBox, CollisionType::kWitness),
                         [](const auto& test) { return test.param == CollisionType::kBox ? "Box" : "Witness"; });

// The end of an arm that turns below a scale of (1, 3, 1) is at 3 m times (cos, 3 sin): it meets a wall at y = 6 where
// 9 sin + half its height does.
TEST(FlexibleContact, AShearedArmMeetsAWallInTime) {
  const std::string text =
      "DEF TOP Transform { scale 1 3 1 children DEF ARM Transform { children DEF TIP Transform { translation 3 0 0 "
      "children "
      "Shape { geometry IndexedFaceSet { solid FALSE coord Coordinate { point [ 0 0 -1, 0 0 1, -1 0 0 ] } "
      "coordIndex [ 0 1 2 -1 ] } } } } }" +
      box("WALL", "20 1 20", "0 6.5 0") + interest("TIP", "\"WALL\"") +
      R"(DEF T TimeSensor { cycleInterval 8 loop TRUE }
DEF O OrientationInterpolator { key [ 0 1 ] keyValue [ 0 0 1 0, 0 0 1 3 ] }
ROUTE T.fraction_changed TO O.set_fraction ROUTE O.value_changed TO ARM.set_rotation
)";
  Flexing f(text);
  const auto times = f.contacts_until_s(3.9);
  ASSERT_FALSE(times.empty());
  const double expected_s = std::asin(6.0 / 9.0) / (3.0 / 8.0);
  EXPECT_LE(times[0], expected_s + 1e-6) << "the wall and the arm are binary32";
  EXPECT_GE(times[0], expected_s - 4e-6);
}

// Its cart goes there and back at 2 m/s, and turns round at 0.5 s, where the cube ends at 1.875 m.
TEST(FlexibleContact, WhatACartBringsMeetsAWallOnTheWay) {
  for (const double face : {1.2, 1.6, 1.874}) {
    Flexing f(grows(face, 1, "", true), {"CART"});
    const ObjectId cart = f.world["CART"];
    f.motion.declare(cart, Role::kDriven);
    f.motion.set_base(cart, sim(0s), moving({0, 0, 0}, {2, 0, 0}));
    f.motion.set_base(cart, sim(500ms), moving({1, 0, 0}, {-2, 0, 0}));
    f.motion.advance(sim(2s));
    const double at_s = only(f.contacts_s());
    const double expected_s = (static_cast<double>(static_cast<float>(face + 0.5)) - 1.0) / 2.75;
    EXPECT_LE(at_s, expected_s + 1e-9) << face;
    EXPECT_GE(at_s, expected_s - 4e-6) << face;
  }
}

// A touch that lasts is checked by how deep it is, and not at every millisecond.
TEST(FlexibleContact, ATouchThatLastsCostsFewSearches) {
  Flexing f(grows(0.75, 1));
  static_cast<void>(f.contacts_until_s(3.0));
  EXPECT_LT(f.motion.counters().contact_searches, 400u);
}

}  // namespace peerd::replication::flexible_contact_test
