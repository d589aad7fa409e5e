// Contacts that theory counts: Galperin's billiard and Newton's cradle.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::stress::counted_contacts_test {

using namespace replication;
using namespace replication::test;

std::string ball(const std::string& name, double mass_kg) {
  std::ostringstream text;
  text.precision(9);
  text << "DEF " << name << " Transform { collisionResponse CollisionResponse { responseType 2 mass " << mass_kg
       << " restitution 1 friction 0 } children Shape { geometry Sphere { radius 0.5 } } }\n";
  return text.str();
}

// G. Galperin, "Playing pool with pi", 2003: the contacts of a wall, a ball of 1 kg and one of 100^k kg that comes are
// the first k + 1 digits of pi.
class Galperin : public testing::TestWithParam<int> {};
TEST_P(Galperin, CountsTheDigitsOfPi) {
  const double ratio = std::pow(100.0, GetParam());
  const World world(ball("LIGHT", 1.0) + ball("HEAVY", ratio) + box("WALL", "1 8 8", "-0.5 0 0") +
                    interest("LIGHT", "\"WALL\" \"HEAVY\"") + interest("HEAVY", "\"LIGHT\" \"WALL\""));
  MotionWorld motions(*world.model, sim(0s));
  const ObjectId light = world["LIGHT"], heavy = world["HEAVY"];
  for (const ObjectId id : {light, heavy}) motions.declare(id, Role::kAuthoritative);
  const double speed = 1.0;
  motions.set_base(light, sim(0s), moving({5, 0, 0}));
  motions.set_base(heavy, sim(0s), moving({20, 0, 0}, {-speed, 0, 0}));
  motions.advance(sim(60s));
  const auto digits = static_cast<std::uint64_t>(std::pow(10.0, GetParam()) * 3.14159265358979);
  EXPECT_EQ(motions.counters().contacts, digits);
  EXPECT_EQ(motions.counters().jammed + motions.counters().capped + motions.counters().came_to_rest, 0u);
  // In velocities times the root of the mass each pair of contacts, wall and ball, turns by twice this angle.
  const double angle = std::atan(1.0 / std::sqrt(ratio));
  const double turned = 2.0 * angle * std::floor((static_cast<double>(digits) + 1.0) / 2.0);
  const double last_heavy = -speed * std::cos(turned);
  const bool at_the_wall_last = digits % 2 == 0;
  const double last_light = (at_the_wall_last ? 1.0 : -1.0) * std::sqrt(ratio) * speed * std::sin(turned);
  EXPECT_NEAR(motions.at(heavy, sim(60s)).velocity.x(), last_heavy, 1e-9);
  EXPECT_NEAR(motions.at(light, sim(60s)).velocity.x(), last_light, 1e-9);
  EXPECT_EQ(motions.at(heavy, sim(60s)).velocity.y(), 0.0);
}
INSTANTIATE_TEST_SUITE_P(Ratios, Galperin, testing::Values(0, 1, 2, 3, 4));

// Balls in a row, the first of which comes; `gap_m` apart.
void swing(int balls, double gap_m) {
  std::string text;
  std::string all;
  for (int i = 0; i < balls; ++i) {
    text += ball("B" + std::to_string(i), 1.0);
    all += "\"B" + std::to_string(i) + "\" ";
  }
  for (int i = 0; i < balls; ++i) {
    std::string others = all;
    others.erase(others.find("\"B" + std::to_string(i) + "\""), 3 + std::to_string(i).size());
    text += interest("B" + std::to_string(i), others);
  }
  const World world(text);
  MotionWorld motions(*world.model, sim(0s));
  std::vector<ObjectId> ids;
  for (int i = 0; i < balls; ++i) ids.push_back(world[("B" + std::to_string(i)).c_str()]);
  for (const ObjectId id : ids) motions.declare(id, Role::kAuthoritative);
  motions.set_base(ids[0], sim(0s), moving({-2, 0, 0}, {3, 0, 0}));
  for (int i = 1; i < balls; ++i)
    motions.set_base(ids[std::size_t(i)], sim(0s), moving({(1.0 + gap_m) * (i - 1), 0, 0}));
  motions.advance(sim(5s));
  for (int i = 0; i < balls; ++i) {
    const Vec3 expected(i == balls - 1 ? 3.0 : 0.0, 0, 0);
    EXPECT_EQ(motions.at(ids[std::size_t(i)], sim(5s)).velocity, expected) << i << " of " << balls << ", " << gap_m;
  }
  EXPECT_EQ(motions.counters().contacts, static_cast<std::uint64_t>(balls - 1));
  EXPECT_EQ(motions.counters().contacts_undone + motions.counters().jammed + motions.counters().came_to_rest, 0u);
}

TEST(Cradle, HandsOverExactly) {
  for (int balls = 2; balls <= 20; ++balls) {
    for (const double gap_m : {0.0, 1e-12, 1e-6, 0.125}) swing(balls, gap_m);
  }
}

}  // namespace peerd::stress::counted_contacts_test
