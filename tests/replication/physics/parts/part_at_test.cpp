#include "replication/physics/parts/part_at.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::part_at_test {

using namespace test;

TEST(PartAt, OfARigidPartIsItsBodyWhereItsCarriersHaveIt) {
  auto&& [world, motion] = Started(box_with("CAR", "4 1 2", "3 0 0", "", box("WHEEL", "1 1 1", "20 0 0")) +
                                       box("X", "1 1 1", "99 0 0") + interest("CAR", "\"X\""),
                                   {}, {"CAR", "CAR/WHEEL"});
  motion.set_base(world["CAR"], sim(0s), moving({5, 0, 0}, {1, 0, 0}));
  const auto& parts = world.model->parts_of_node[0];
  ASSERT_EQ(parts.size(), 2u);
  const PartAt wheel = part_at(*world.model, motion, nullptr, parts[1], sim(2s));
  EXPECT_EQ(wheel.center_world(), Vec3(27, 0, 0));
  EXPECT_EQ(wheel.state.velocity, Vec3(1, 0, 0));
  EXPECT_NEAR(wheel.radius_m, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(wheel.extent_m, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(wheel.box().lo[0], 27 - std::sqrt(0.75), 1e-12);
}

// The half width goes from 0.5 m to 2 m in 2 s.
TEST(PartAt, OfWhatFlexesHoldsItForAsLongAsWasAsked) {
  const World world(box("GROWS", "1 1 1", "0 0 0") + box("X", "1 1 1", "9 0 0") + interest("GROWS", "\"X\"") + kGrows);
  ASSERT_EQ(world.model->flexible.size(), 1u);
  MotionWorld motion(*world.model, sim(0s));
  FlexibleParts flexible(*world.model);
  flexible.set_world_zero(sim(0s));
  const auto part = static_cast<std::uint32_t>(world.model->nodes.size());
  const PartAt now = part_at(*world.model, motion, &flexible, part, sim(1s));
  EXPECT_NEAR(now.radius_m, Vec3(1.25, 0.5, 0.5).norm(), 1e-6);
  const PartAt soon = part_at(*world.model, motion, &flexible, part, sim(1s), 0.5);
  EXPECT_GE(soon.radius_m, Vec3(1.625, 0.5, 0.5).norm());
  EXPECT_LT(soon.radius_m, now.radius_m + 2.0);
}

}  // namespace peerd::replication::part_at_test
