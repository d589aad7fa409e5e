// A day in a world: what a body does has a closed form, and 24 h later that still says where it is.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::stress::day_test {

using namespace replication;
using namespace replication::test;

constexpr Duration kDay = 24h;
constexpr double kGravity = 9.81;

std::string body(const std::string& name, const std::string& geometry, const std::string& response) {
  return "DEF " + name + " Transform { collisionResponse CollisionResponse { responseType 2 " + response +
         " } children Shape { geometry " + geometry + " } }\n";
}
const std::string kFloor = box("FLOOR", "10 1 10", "0 -0.5 0") + interest("BODY", "\"FLOOR\"");

// A contact is at a whole nanosecond, rounded down: so much may each of them be early, and no more.
TEST(ADay, OfBouncingKeepsTime) {
  const World world(body("BODY", "Box { size 1 1 1 }", "mass 1 restitution 1 friction 0") + kFloor);
  MotionWorld motions(*world.model, sim(0s));
  const ObjectId id = world["BODY"];
  motions.declare(id, Role::kAuthoritative);
  constexpr double kHeight_m = 1.0;
  motions.set_base(id, sim(0s), moving({0, 0.5 + kHeight_m, 0}, Vec3::Zero(), {0, -kGravity, 0}));
  const double fall_s = std::sqrt(2.0 * kHeight_m / kGravity);
  std::uint64_t bounces = 0;
  double earliest_s = 0.0, latest_s = 0.0, energy_error = 0.0;
  for (Duration t = 0s; t < kDay; t += 60s) {
    motions.advance(sim(t + 60s));
    while (const auto event = motions.poll_event()) {
      const auto* const contact = std::get_if<ContactEvent>(&*event);
      if (contact == nullptr) continue;
      const double late_s = to_seconds(contact->at - sim(0s)) - fall_s * static_cast<double>(2 * bounces + 1);
      earliest_s = std::min(earliest_s, late_s);
      latest_s = std::max(latest_s, late_s);
      ++bounces;
      // A bounce is at most 1 ns above the floor, from where it goes up as fast as it came.
      const double speed = contact->collider_after.velocity.norm();
      energy_error = std::max(energy_error, std::abs(speed / std::sqrt(2.0 * kGravity * kHeight_m) - 1.0));
    }
  }
  std::printf("%llu bounces: at most %.3g s early and %.3g s late, speed within %.3g of itself\n",
              static_cast<unsigned long long>(bounces), -earliest_s, latest_s, energy_error);
  EXPECT_EQ(bounces, static_cast<std::uint64_t>((to_seconds(kDay) / fall_s + 1.0) / 2.0));
  EXPECT_GE(earliest_s, -1e-9 * static_cast<double>(2 * bounces));
  EXPECT_LT(latest_s, 1e-9);
  EXPECT_LT(energy_error, 5e-9);
}

// It slides for 100 s, and lies for the rest of the day.
TEST(ADay, OfSlidingEndsWhereFrictionSays) {
  const World world(body("BODY", "Box { size 1 1 1 }", "mass 1 restitution 0 friction 0.0625") +
                    box("FLOOR", "1000 1 10", "0 -0.5 0") + interest("BODY", "\"FLOOR\""));
  MotionWorld motions(*world.model, sim(0s));
  const ObjectId id = world["BODY"];
  motions.declare(id, Role::kAuthoritative);
  const double speed = 0.0625 * 100.0;
  motions.set_base(id, sim(0s), moving({0, 0.5, 0}, {speed, 0, 0}, {0, -kGravity, 0}));
  for (Duration t = 0s; t < kDay; t += 60s) motions.advance(sim(t + 60s));
  const KinematicState end = motions.at(id, sim(kDay));
  const double expected_m = 0.5 * speed * 100.0;
  std::printf("slid %.17g m, %.3g of it too far\n", end.position.x(), end.position.x() / expected_m - 1.0);
  EXPECT_NEAR(end.position.x() / expected_m, 1.0, 1e-15);
  EXPECT_EQ(end.position.y(), 0.5);
  EXPECT_EQ(end.velocity, Vec3(0, 0, 0));
  EXPECT_TRUE(motions.is_at_rest_from(id, sim(101s)));
}

// It turns by itself in the air for a day, some 41,000 times: an angle that binary64 knows to 2.9e-11 rad.
TEST(ADay, OfTurningEndsAtTheAngle) {
  const World world(body("BODY", "Box { size 1 2 3 }", "mass 1 restitution 1 friction 0") + kFloor);
  MotionWorld motions(*world.model, sim(0s));
  const ObjectId id = world["BODY"];
  motions.declare(id, Role::kAuthoritative);
  KinematicState start = moving({0, 50, 0}, {0.25, 0, 0});
  start.angular_velocity_body = {0, 3, 0};
  motions.set_base(id, sim(0s), start);
  for (Duration t = 0s; t < kDay; t += 60s) motions.advance(sim(t + 60s));
  const KinematicState end = motions.at(id, sim(kDay));
  const double angle = 3.0 * to_seconds(kDay);
  const Quat expected(std::cos(0.5 * angle), 0.0, std::sin(0.5 * angle), 0.0);
  const double error = std::min((end.orientation.coeffs() - expected.coeffs()).norm(),
                                (end.orientation.coeffs() + expected.coeffs()).norm());
  std::printf("turned by %g rad, and is %.3g rad from there\n", angle, 2.0 * error);
  EXPECT_LT(2.0 * error, 0x1p-35);
  EXPECT_EQ(end.position, Vec3(0.25 * to_seconds(kDay), 50, 0));
}

TEST(ADay, OfRestMovesNothingAndSearchesNothing) {
  const World world(body("BODY", "Sphere { radius 0.5 }", "mass 1 restitution 0.5 friction 0.3") + kFloor);
  MotionWorld motions(*world.model, sim(0s));
  const ObjectId id = world["BODY"];
  motions.declare(id, Role::kAuthoritative);
  motions.set_base(id, sim(0s), moving({0, 0.5, 0}, Vec3::Zero(), {0, -kGravity, 0}));
  motions.advance(sim(1s));
  const KinematicState lying = motions.at(id, sim(1s));
  const std::uint64_t searches = motions.counters().contact_searches, contacts = motions.counters().contacts;
  for (Duration t = 1s; t < kDay; t += 60s) motions.advance(sim(t + 60s));
  EXPECT_TRUE(same_bits(motions.at(id, sim(kDay)), lying));
  EXPECT_EQ(motions.counters().contact_searches, searches);
  EXPECT_EQ(motions.counters().contacts, contacts);
}

}  // namespace peerd::stress::day_test
