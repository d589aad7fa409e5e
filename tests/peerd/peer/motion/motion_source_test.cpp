#include "peerd/peer/motion/motion_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/must.hpp"

namespace peerd::motion::motion_source_test {

const std::vector<Pose> kPlaces(3);

MotionFormula x_formula(const char* text) {
  MotionFormula formula;
  formula.x = text;
  return formula;
}
WalkSettings walk_of_40_m() {
  WalkSettings walk;
  walk.x_min_m = walk.z_min_m = -20.0;
  walk.x_max_m = walk.z_max_m = 20.0;
  return walk;
}

Result<std::vector<MotionSource>> make(const MotionSettings& motion, std::vector<std::size_t> numbers,
                                       std::uint64_t seed = 1, double duration_s = 10.0) {
  return make_sources(motion, "error: motion.X", kPlaces, numbers, seed, duration_s);
}

TEST(MotionSource, AFormulaKnowsTheNumberOfItsObject) {
  MotionSettings motion;
  motion.kind = x_formula("10*n + t");
  const auto sources = must(make(motion, {0, 2}));
  ASSERT_EQ(sources.size(), 2u);
  EXPECT_NEAR(sources[0].pose(1.5).position.x(), 1.5, 1e-12);
  EXPECT_NEAR(sources[1].pose(1.5).position.x(), 21.5, 1e-12);
  EXPECT_NEAR(sources[1].sample(1.5).velocity.x(), 1.0, 1e-6);
}

TEST(MotionSource, HoldStandsBeforeTheStart) {
  MotionSettings motion;
  motion.kind = Waypoints{{{-2, 0, 0, 0}, {0, 2, 0, 0}, {4, 6, 0, 0}}, false, true};
  const auto runs = make(motion, {0});
  motion.hold_before_start = true;
  const auto holds = make(motion, {0});
  ASSERT_TRUE(runs && holds);
  EXPECT_NEAR(runs->front().pose(-1.0).position.x(), 1.0, 1e-12);
  EXPECT_NEAR(holds->front().pose(-1.0).position.x(), 2.0, 1e-12);
  EXPECT_TRUE(holds->front().sample(-1.0).velocity.isZero(0.0));
  EXPECT_NEAR(holds->front().pose(2.0).position.x(), 4.0, 1e-12);
}

TEST(MotionSource, TheSeedOfTheMotionComesBeforeTheScenarios) {
  MotionSettings motion;
  motion.kind = walk_of_40_m();
  const auto at_end = [&](std::uint64_t scenario_seed) {
    const auto sources = must(make(motion, {0, 1}, scenario_seed));
    return std::pair(sources[0].pose(10.0).position, sources[1].pose(10.0).position);
  };
  EXPECT_EQ(at_end(1), at_end(1));
  EXPECT_NE(at_end(1).first, at_end(2).first);
  EXPECT_NE(at_end(1).first, at_end(1).second) << "each walker has its own way";
  motion.seed = 5;
  EXPECT_EQ(at_end(1), at_end(2));
}

TEST(MotionSource, ErrorsBeginWithTheirKey) {
  MotionSettings motion;
  motion.kind = x_formula("sin(");
  EXPECT_THAT(error_of(make(motion, {0})).text, testing::StartsWith("error: motion.X"));
  motion.kind = walk_of_40_m();
  EXPECT_FALSE(make(motion, {0}, 1, 5000.0)) << "made before the run, for an hour at most";
}

}  // namespace peerd::motion::motion_source_test
