#include "core/scene/world_laws.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::world_laws_test {

WorldLaws laws_of(const std::string& text) { return world_laws(*scene_of(text).document); }

TEST(WorldLaws, AreNoneWhereTheWorldSaysNothing) {
  const WorldLaws laws = laws_of("Group { } WorldInfo { title \"x\" }");
  EXPECT_EQ(laws.gravity, Vec3::Zero());
  EXPECT_LT(laws.return_below, -1e38);
}

TEST(WorldLaws, AreThoseOfTheFirstWorldInfoThatHasThem) {
  const WorldLaws laws =
      laws_of("WorldInfo { gravity 0 -9.81 0 } Group { children WorldInfo { gravity 0 1 0 returnBelow -20 } }");
  EXPECT_FLOAT_EQ(static_cast<float>(laws.gravity.y()), -9.81F);
  EXPECT_EQ(laws.return_below, -20.0);
}

}  // namespace peerd::world_laws_test
