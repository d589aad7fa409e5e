#include "core/x3d/default_lengths.hpp"

#include <gtest/gtest.h>

#include "core/vrml/default_values.hpp"
#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::default_lengths_test {

TEST(DefaultLengths, AreMetresInAnyUnit) {
  Document document;
  Node cone{.type = find_node_type("Cone")};
  const float height = 7;
  const Field given{find_field(*cone.type, "height"), &height, 1, 0};
  cone.fields = &given;
  cone.field_count = 1;
  give_default_lengths(cone, document.arena, 0.5);
  EXPECT_EQ(floats(cone, "height"), std::vector<float>{7});
  EXPECT_EQ(floats(cone, "bottomRadius"), std::vector<float>{2});
  Node light{.type = find_node_type("DirectionalLight")};
  give_default_lengths(light, document.arena, 0.5);
  EXPECT_EQ(light.field_count, 0U);
}

}  // namespace peerd::vrml::default_lengths_test
