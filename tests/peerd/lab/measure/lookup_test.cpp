#include "peerd/lab/measure/lookup.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::lookup_test {

using samples::kA, samples::kB, samples::kC, samples::kCar, samples::kCube, samples::kWall;

TEST(Lookup, NamesOrNumbers) {
  RunRecord run = samples::quiet_run();
  run.scene_paths[kWall] = "HOUSE/WALL";
  EXPECT_EQ(peer_name(run, kB), "b");
  EXPECT_EQ(peer_name(run, PeerId{7}), "#7");
  EXPECT_EQ(object_path(run, kCar), "CAR");
  EXPECT_EQ(object_path(run, kWall), "HOUSE/WALL");
  EXPECT_EQ(object_path(run, ObjectId{99}), "#99");
}

TEST(Lookup, SamplesOfOneObserverAndOneObject) {
  const RunRecord run = samples::zigzag_run(0.1, 20);
  const auto found = ghost_samples_of(run, kC, kCar);
  ASSERT_EQ(found.size(), 20u);
  for (const GhostSample& s : found) EXPECT_TRUE(s.observer == kC && s.object == kCar);
  EXPECT_LT(found.front().t_s, found.back().t_s);
  EXPECT_TRUE(ghost_samples_of(run, kB, kCube).empty()) << "the owner does not observe its own object";
}

TEST(Lookup, PresenceIncludesItsEnds) {
  const PeerInfo always{kA, "a"}, twice{kB, "b", {{0, 2}, {5, 6}}};
  EXPECT_TRUE(was_present(always, 100));
  for (const double t : {0.0, 2.0, 5.0, 6.0}) EXPECT_TRUE(was_present(twice, t)) << t;
  for (const double t : {-0.1, 2.1, 4.9, 6.1}) EXPECT_FALSE(was_present(twice, t)) << t;
}

TEST(Lookup, ErrorsAreDistances) {
  GhostSample s = samples::ghost_sample(0, kB, kCar, {0, 0, 0}, {3, 4, 0});
  s.shown.position = {0, 0, 2};
  s.seen.position = {0, 1, 2};
  EXPECT_EQ(ghost_error_m(s), 5.0);
  EXPECT_EQ(shown_error_m(s), 2.0);
  EXPECT_EQ(view_difference_m(s), 1.0);
}

TEST(SameSide, GoesByTheNormalsSignWhicheverWayThePairIsNamed) {
  const auto row = [](ObjectId collider, ObjectId collidee, const Vec3& normal) {
    return ContactRow{0, kA, "owner", collider, collidee, normal, 0};
  };
  const ContactRow right = row(kCar, kWall, {1, 0, 0});
  EXPECT_TRUE(same_side(right, row(kCar, kWall, {0.1, 5, 0})));
  EXPECT_FALSE(same_side(right, row(kCar, kWall, {-0.1, 5, 0})));
  EXPECT_FALSE(same_side(right, row(kCar, kWall, {0, 1, 0}))) << "a right angle is no agreement";
  EXPECT_TRUE(same_side(right, row(kWall, kCar, {-1, 0, 0})));
  EXPECT_FALSE(same_side(right, row(kWall, kCar, {1, 0, 0})));
  const ContactRow box = row(kCar, kWall, Vec3::Zero());
  EXPECT_TRUE(same_side(box, row(kWall, kCar, Vec3::Zero())));
  EXPECT_FALSE(same_side(box, right));
}

}  // namespace peerd::measure::lookup_test
