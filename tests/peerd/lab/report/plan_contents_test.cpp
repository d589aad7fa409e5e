#include "peerd/lab/report/plan_contents.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/lab/report/figure_parts.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::plan_contents_test {

using measure::samples::ghost_sample;

measure::SceneOutline outline(double x_lo, double z_lo, double x_hi, double z_hi) {
  return {.owned = {}, .corners = {{x_lo, z_lo}, {x_hi, z_lo}, {x_hi, z_hi}, {x_lo, z_hi}}, .bottom_m = -1, .top_m = 1};
}

PlanContents contents_of(const measure::RunRecord& run) {
  return plan_contents(run, run.objects.front(), observers_of(run, run.objects.front()));
}

PlanContents::Other path(std::vector<Vec3> truth) { return {measure::samples::kA, std::move(truth), true}; }

TEST(PlanContents, HasAllObjectsThatMoveByHowFarTheyGo) {
  measure::RunRecord run = measure::samples::quiet_run();
  run.objects.push_back({ObjectId{12}, "NEAR", measure::samples::kB});
  run.objects.push_back({ObjectId{13}, "FAR", measure::samples::kB});
  run.objects.push_back({ObjectId{14}, "UNSEEN", measure::samples::kB});
  for (const std::uint32_t object : {10u, 11u, 12u, 13u}) {
    const double m_s = object == 11 ? 0.0 : object == 13 ? 5.0 : 1.0;
    for (int i = 0; i < 3; ++i) {
      run.ghost_samples.push_back(
          ghost_sample(i, measure::samples::kC, ObjectId{object}, {m_s * i, 2, 0}, {m_s * i, 2, 0}));
    }
  }
  const PlanContents contents = contents_of(run);
  EXPECT_EQ(contents.truth.size(), 3u);
  ASSERT_EQ(contents.others.size(), 3u);
  EXPECT_EQ(contents.moving, 2u);
  EXPECT_EQ(contents.others[0].truth.back().x(), 10.0);
  EXPECT_EQ(contents.others[1].truth.back().x(), 2.0);
  EXPECT_FALSE(contents.others[2].moves);
  EXPECT_EQ(contents.unseen, 1u);
  EXPECT_EQ(contents.without_outline.size(), 1u) << "CUBE";
  EXPECT_EQ(contents.lowest_m, 2.0);
}

TEST(PlanContents, APathIsInterruptedWhereNobodyHadASample) {
  measure::RunRecord run = measure::samples::quiet_run();
  for (int i = 0; i < 100; ++i) {
    if (i >= 40 && i < 60) continue;  // two seconds
    run.ghost_samples.push_back(
        ghost_sample(0.1 * i, measure::samples::kC, measure::samples::kCar, {1.0 * i, 0, 0}, {1.0 * i, 0, 1}));
  }
  const PlanContents contents = contents_of(run);
  for (const auto& path : {contents.truth, contents.ghosts.at(0)}) {
    ASSERT_EQ(path.size(), 81u);
    EXPECT_FALSE(path[40].allFinite());
    EXPECT_EQ(path[41].x(), 60.0);
  }
  EXPECT_NEAR(plan_frame(contents, 1000, 800).across.hi, 99.0, 3.0);
}

TEST(PlanContents, AnOutlineIsItsOwnersOrNobodys) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  run.outlines = {outline(0, 0, 1, 1), outline(8, 0, 9, 1)};
  run.outlines[1].owned = measure::samples::kCube;
  const PlanContents contents = contents_of(run);
  ASSERT_EQ(contents.scene_outlines.size(), 1u);
  ASSERT_EQ(contents.owned_outlines.size(), 1u);
  EXPECT_EQ(contents.owned_outlines[0].first, measure::samples::kB);
  EXPECT_TRUE(contents.without_outline.empty());
}

struct Extents {
  const char* name;
  double x_m, z_m;
  bool turned;
};
class PlanOrientation : public testing::TestWithParam<Extents> {};
TEST_P(PlanOrientation, IsThatOfAMapButForARoadAlongZ) {
  const auto& [name, x_m, z_m, turned] = GetParam();
  PlanContents contents;
  contents.truth = {{0, 0, 0}, {x_m, 0, -z_m}};
  const PlanFrame frame = plan_frame(contents, 1000.0, 800.0);
  EXPECT_EQ(frame.axes.turned(), turned);
  const Point end = frame.axes.of(contents.truth.back());
  EXPECT_EQ(end.x, turned ? z_m : x_m) << "x to the right, or -z";
  EXPECT_EQ(end.y, turned ? -x_m : z_m);
  EXPECT_LE(frame.width_px, 1000.001);
  EXPECT_LE(frame.height_px, 800.001);
  EXPECT_NEAR(frame.width_px / (frame.across.hi - frame.across.lo), frame.height_px / (frame.up.hi - frame.up.lo),
              1e-9);
}
INSTANTIATE_TEST_SUITE_P(Table, PlanOrientation,
                         testing::Values(Extents{"Square", 100, 100, false}, Extents{"Wide", 300, 10, false},
                                         Extents{"HigherThanWide", 100, 150, false}, Extents{"Road", 10, 300, true},
                                         Extents{"Point", 0, 0, false}),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(PlanFrame, AFloorDoesNotDwarfThePaths) {
  PlanContents contents;
  contents.truth = {{0, 0, 0}, {100, 0, -80}};
  const measure::SceneOutline floor = outline(-5000, -5000, 5000, 5000);
  contents.scene_outlines = {&floor};
  const PlanFrame frame = plan_frame(contents, 1000.0, 800.0);
  EXPECT_LT(frame.across.hi - frame.across.lo, 130.0);
  EXPECT_GT(frame.across.hi - frame.across.lo, 100.0);
}

TEST(PlanFrame, HasTheWallsNearThePathsAndNotThoseFarAway) {
  PlanContents contents;
  contents.truth = {{0, 0, 0}, {100, 0, -80}};
  const measure::SceneOutline near = outline(104, -80, 106, 0), far = outline(600, -80, 602, 0);
  contents.scene_outlines = {&near, &far};
  const PlanFrame frame = plan_frame(contents, 1000.0, 800.0);
  EXPECT_GE(frame.across.hi, 106.0);
  EXPECT_LT(frame.across.hi, 120.0);
}

TEST(PlanFrame, HasTheNearSideOfALongWall) {
  PlanContents contents;
  contents.truth = {{0, 0, 0}, {100, 0, -80}};
  const measure::SceneOutline wall = outline(115, -5000, 116, 5000);
  contents.scene_outlines = {&wall};
  const PlanFrame frame = plan_frame(contents, 1000.0, 800.0);
  EXPECT_GE(frame.across.hi, 116.0);
  EXPECT_LT(frame.up.hi, 100.0);
}

// One of a hundred flies off.
TEST(PlanFrame, IsAroundWhereMostAre) {
  PlanContents contents;
  contents.truth = {{0, 0, 0}, {10, 0, 0}};
  for (int i = 0; i < 99; ++i) contents.others.push_back(path({{1.0 * i, 0, -50}, {1.0 * i, 0, 50}}));
  contents.others.push_back(path({{0, 0, 0}, {9000, 0, 0}}));
  contents.moving = 100;
  const PlanFrame frame = plan_frame(contents, 1000.0, 800.0);
  EXPECT_LE(frame.across.lo, 0.0);
  EXPECT_GE(frame.across.hi, 98.0);
  EXPECT_LT(frame.across.hi, 200.0);
}

TEST(PlanFrame, HoldsAllOfAFewObjects) {
  PlanContents contents;
  contents.truth = {{0, 0, 0}, {10, 0, 0}};
  contents.others = {path({{0, 0, 0}, {900, 0, 0}})};
  contents.moving = 1;
  EXPECT_GE(plan_frame(contents, 1000.0, 800.0).across.hi, 900.0);
}

}  // namespace peerd::report::plan_contents_test
