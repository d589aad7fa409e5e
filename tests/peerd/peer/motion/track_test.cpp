#include "peerd/peer/motion/track.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/path_checks.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::motion::track_test {

using testing::HasSubstr;
using testing_support::ScratchFolder;

TEST(Track, HitsItsSamplesAndIsSmoothBetween) {
  const ScratchFolder folder;
  const auto loaded =
      load_track({folder.write("t.csv", "t,x,y,z\r\n0,1,2,3\r\n0.5, 2 ,2,3.25\n1.5,2,-1e1,3\n\n2,0,0,0\n")});
  ASSERT_TRUE(loaded.has_value()) << loaded.error().text;
  EXPECT_FALSE(loaded->turns);
  const MotionPath path(loaded->knots);
  EXPECT_LT((path.pose(0.5).position - Vec3(2, 2, 3.25)).norm(), 1e-12);
  EXPECT_LT((path.pose(1.5).position - Vec3(2, -10, 3)).norm(), 1e-12);
  EXPECT_EQ(path.pose(2.0).position, Vec3::Zero());
  path_checks::expect_continuous(path);
}

TEST(Track, OrientationsAreHitAndTurnSmoothly) {
  const ScratchFolder folder;
  std::string csv = "t,x,y,z,qw,qx,qy,qz\n";
  std::vector<Quat> orientations;
  for (int i = 0; i < 6; ++i) {
    Quat q = quat_exp(Vec3(0.2 * i * i, 0.5 * i, -0.3));
    // Either sign and any length is the same orientation.
    if (i % 2 == 1) q.coeffs() *= -3.0;
    orientations.push_back(q.normalized());
    csv += std::to_string(i) + ",0,0,0," + std::to_string(q.w()) + "," + std::to_string(q.x()) + "," +
           std::to_string(q.y()) + "," + std::to_string(q.z()) + "\n";
  }
  for (const bool corners : {false, true}) {
    const auto loaded = must(load_track({folder.write("t.csv", csv), false, corners}));
    EXPECT_TRUE(loaded.turns);
    const MotionPath path(loaded.knots);
    for (int i = 0; i < 6; ++i) {
      EXPECT_LT(turn_between(path.pose(i).orientation, orientations[static_cast<std::size_t>(i)]).norm(), 1e-5) << i;
    }
    path_checks::expect_derivatives(path, 0.0, 5.0, 200);
    if (!corners) path_checks::expect_continuous(path);
    const Vec3 mean_spin = turn_between(orientations[1], orientations[2]);
    if (corners) {
      EXPECT_LT((path.sample(1.4).angular_velocity_body - mean_spin).norm(), 1e-5) << "steady";
    }
  }
}

TEST(Track, WhatIsWrongIsNamedWithItsLine) {
  const ScratchFolder folder;
  const auto error = [&](const std::string& text, bool loop = false) {
    const auto loaded = load_track({folder.write("bad.csv", text), loop});
    return loaded ? "accepted" : loaded.error().text;
  };
  EXPECT_THAT(error("t;x;y;z\n"), HasSubstr("bad.csv:1: error: the first line must be t,x,y,z or"));
  EXPECT_THAT(error("t,x,y,z\n0,0,0\n"), HasSubstr("bad.csv:2: error: write 4 numbers"));
  EXPECT_THAT(error("t,x,y,z\n0,0,0,0\n1,0,nan,0\n"),
              HasSubstr("bad.csv:3: error: write 4 numbers with commas between them; nan is no finite number"));
  EXPECT_THAT(error("t,x,y,z\n0,0,0,0\n1,0,1e10,0\n"), HasSubstr("1e10 is out of range"));
  EXPECT_THAT(error("t,x,y,z\n0,0,0,0\n1,0,,0\n"), HasSubstr("bad.csv:3: "));
  EXPECT_THAT(error("t,x,y,z\n0,0,0,0\n\n0,0,0,0\n"), HasSubstr("bad.csv:4: error: each time must be later"));
  EXPECT_THAT(error("t,x,y,z\n0,0,0,0\n1,0,1,0\n2,1,0,0\n", true), HasSubstr("bad.csv:4: error: a loop ends"));
  EXPECT_THAT(error("t,x,y,z,qw,qx,qy,qz\n0,0,0,0,0,0,0,0\n"), HasSubstr("bad.csv:2: error: the orientation"));
  EXPECT_THAT(error("t,x,y,z\n"), HasSubstr("bad.csv: error: the track has no rows"));
  EXPECT_THAT(error(""), HasSubstr("bad.csv"));
  EXPECT_THAT(load_track({folder / "none.csv"}).error().text, HasSubstr("none.csv: error: there is no such file"));
}

}  // namespace peerd::motion::track_test
