#include "peerd/lab/live/scene_outlines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "peerd/peer/config/peer_settings.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::scene_outlines_test {

constexpr PeerId kA{1}, kB{2};

class SceneOutlinesTest : public testing::Test {
 protected:
  SceneOutlines outlines(const std::string& world) {
    const auto loaded = config::load_world(folder.write("w.wrl", "#VRML V2.0 utf8\n" + world));
    if (!loaded) {
      ADD_FAILURE() << loaded.error().text;
      return {};
    }
    for (measure::ObjectInfo& object : run.objects) object.object = loaded->scene.find(object.path).value();
    for (measure::GhostSample& s : run.ghost_samples) s.object = run.objects.front().object;
    return outlines_of(loaded->scene, run);
  }
  // The first of run.objects is at that pose at that time.
  void be_at(double t_s, const Pose& truth) {
    run.ghost_samples.push_back({.t_s = t_s, .observer = kB, .truth = truth});
  }
  static std::vector<std::pair<double, double>> rounded(const measure::SceneOutline& outline) {
    std::vector<std::pair<double, double>> corners;
    for (const auto& c : outline.corners)
      corners.emplace_back(std::round(c.x() * 1e3) / 1e3, std::round(c.y() * 1e3) / 1e3);
    return corners;
  }

  testing_support::ScratchFolder folder;
  measure::RunRecord run;
};

TEST_F(SceneOutlinesTest, AWallIsARectangleWhereItStands) {
  const auto found = outlines("Transform { translation 10 2 -5 children Shape { geometry Box { size 2 4 6 } } }");
  ASSERT_EQ(found.outlines.size(), 1u);
  EXPECT_THAT(rounded(found.outlines[0]), testing::UnorderedElementsAre(std::pair(9.0, -8.0), std::pair(11.0, -8.0),
                                                                        std::pair(11.0, -2.0), std::pair(9.0, -2.0)));
  EXPECT_DOUBLE_EQ(found.outlines[0].bottom_m, 0.0);
  EXPECT_DOUBLE_EQ(found.outlines[0].top_m, 4.0);
  EXPECT_FALSE(found.outlines[0].owned);
  EXPECT_EQ(found.left_out, 0u);
}

TEST_F(SceneOutlinesTest, ATurnedBoxKeepsItsFourCorners) {
  const auto found =
      outlines("Transform { rotation 0 1 0 0.785398163 children Shape { geometry Box { size 2 1 2 } } }");
  ASSERT_EQ(found.outlines.size(), 1u);
  const double r = 1.414;
  EXPECT_THAT(rounded(found.outlines[0]), testing::UnorderedElementsAre(std::pair(r, 0.0), std::pair(0.0, r),
                                                                        std::pair(-r, 0.0), std::pair(0.0, -r)));
}

TEST_F(SceneOutlinesTest, ASheetThatStandsIsALine) {
  const auto found = outlines(
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 4 0 0, 4 3 0, 0 3 0] } "
      "coordIndex [0 1 2 3 -1] } }");
  ASSERT_EQ(found.outlines.size(), 1u);
  EXPECT_THAT(rounded(found.outlines[0]), testing::UnorderedElementsAre(std::pair(0.0, 0.0), std::pair(4.0, 0.0)));
}

TEST_F(SceneOutlinesTest, ASphereIsConvexAndHasFewCorners) {
  const auto found = outlines("Shape { geometry Sphere { radius 3 } }");
  ASSERT_EQ(found.outlines.size(), 1u);
  const auto& corners = found.outlines[0].corners;
  EXPECT_GE(corners.size(), 12u);
  EXPECT_LE(corners.size(), 48u);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % corners.size()] - corners[i];
    const Eigen::Vector2d b = corners[(i + 2) % corners.size()] - corners[(i + 1) % corners.size()];
    EXPECT_GT(a.x() * b.y() - a.y() * b.x(), 0.0) << i;
    EXPECT_NEAR(corners[i].norm(), 3.0, 1e-5);
  }
}

TEST_F(SceneOutlinesTest, AnOwnedObjectIsWhereTheTruthHasItAtFirst) {
  run.objects = {{ObjectId{}, "CAR", kA}};
  const Quat quarter(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY()));
  be_at(2.0, {{50, 0, 0}, Quat::Identity()});
  be_at(1.0, {{20, 0, 7}, quarter});
  const auto found = outlines(
      "DEF CAR Transform { translation 1 0 0 children Transform { translation 0 0 -1 children Shape { geometry Box { "
      "size 2 1 4 } } } }");
  ASSERT_EQ(found.outlines.size(), 1u);
  EXPECT_EQ(found.outlines[0].owned, run.objects[0].object);
  // A quarter turn about y takes -z to -x.
  EXPECT_THAT(rounded(found.outlines[0]), testing::UnorderedElementsAre(std::pair(17.0, 6.0), std::pair(21.0, 6.0),
                                                                        std::pair(21.0, 8.0), std::pair(17.0, 8.0)));
}

TEST_F(SceneOutlinesTest, WhatTheWorldMovesAndWhatHasNoSurfaceIsLeftOut) {
  const auto found = outlines(R"(
DEF LIFT Transform { children Shape { geometry Box { } } }
DEF CLOCK TimeSensor { loop TRUE }
DEF WAY PositionInterpolator { key [0, 1] keyValue [0 0 0, 0 9 0] }
ROUTE CLOCK.fraction_changed TO WAY.set_fraction
ROUTE WAY.value_changed TO LIFT.set_translation
Shape { geometry IndexedLineSet { coord Coordinate { point [0 0 0, 1 0 0] } coordIndex [0 1 -1] } }
Switch { whichChoice -1 choice Shape { geometry Box { } } })");
  EXPECT_TRUE(found.outlines.empty());
  EXPECT_EQ(found.left_out, 0u);
}

TEST_F(SceneOutlinesTest, OfManyTheNearestAreTaken) {
  run.objects = {{ObjectId{}, "CAR", kA}};
  be_at(0.0, {{0, 0, 0}, Quat::Identity()});
  std::string world = "DEF CAR Transform { }\n";
  for (int i = static_cast<int>(kOutlinesMax) + 30; i > 0; --i) {
    world += "Transform { translation " + std::to_string(10 * i) + " 0 0 children Shape { geometry Box { } } }\n";
  }
  const auto found = outlines(world);
  EXPECT_EQ(found.outlines.size(), kOutlinesMax);
  EXPECT_EQ(found.left_out, 30u);
  EXPECT_NEAR(found.outlines.front().corners.front().x(), 10.0, 1.01);
  for (const auto& outline : found.outlines) EXPECT_LT(outline.corners.front().x(), 10.0 * kOutlinesMax + 1.01);
}

}  // namespace peerd::scene_outlines_test
