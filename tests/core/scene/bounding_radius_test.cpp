#include "core/scene/bounding_radius.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/read_text.hpp"

namespace peerd::bounding_radius_test {

double reach_of(const std::string& text) {
  const Scene scene = scene_of(text);
  return bounding_radius_m(scene, *scene.find("A"));
}

TEST(Reach, FarthestVertexFromTheObjectsOrigin) {
  EXPECT_DOUBLE_EQ(reach_of("DEF A Transform { children Shape { geometry Box { size 2 4 4 } } }"), 3.0);
  EXPECT_DOUBLE_EQ(reach_of("DEF A Transform { translation 9 9 9 children Shape { geometry Box { size 2 4 4 } } }"),
                   3.0)
      << "not from the world's";
  EXPECT_DOUBLE_EQ(reach_of("DEF A Transform { children Transform { translation 5 0 0 children Shape { geometry Box { "
                            "size 2 4 4 } } } }"),
                   std::sqrt(44.0));
  EXPECT_NEAR(reach_of("DEF A Transform { scale 3 3 3 children Shape { geometry Sphere { radius 2 } } }"), 6.0, 1e-6);
  EXPECT_EQ(reach_of("DEF A Transform { }"), 0.0);
}

}  // namespace peerd::bounding_radius_test
