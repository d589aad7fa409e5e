#include "peerd/view/picture/mesh_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::mesh_maker_test {

using peerd::testing_support::Glb;
using peerd::testing_support::glb_of_text;
using peerd::testing_support::picture_of_text;
using testing::ElementsAre;

TEST(MeshMaker, AMeshServesAllShapesThatHaveIt) {
  std::string text = "DEF S Shape { appearance Appearance { material Material { } } geometry Sphere { } }\n";
  for (int i = 1; i < 50; ++i) text += "Transform { translation " + std::to_string(i) + " 0 0 children USE S }\n";
  text += "PROTO P [ ] { Shape { geometry Cone { } } }\nP { }\nP { }\n";
  const Glb glb = glb_of_text(text);
  EXPECT_THAT(glb.problems, ElementsAre());
  EXPECT_EQ(glb.meshes.size(), 2u);
  EXPECT_EQ(glb.nodes.size(), 1u + 50 + 2);
}

TEST(MeshMaker, EqualSolidsAreOne) {
  const auto drawn = picture_of_text(R"(
Shape { geometry Box { } }
Shape { geometry Box { size 2 2 2 } }
Shape { geometry Box { size 2 2 3 } }
Shape { geometry Cylinder { } }
Shape { geometry Cylinder { top FALSE } })");
  EXPECT_EQ(drawn.geometries.size(), 4u);
  EXPECT_EQ(drawn.shapes[0].mesh, drawn.shapes[1].mesh);
}

TEST(MeshMaker, EqualMaterialsAreOneAndOthersAreNot) {
  const auto drawn = picture_of_text(R"(
DEF G Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } } geometry DEF B Box { } }
Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } } geometry USE B }
Shape { appearance Appearance { material Material { diffuseColor 0 1 0 } } geometry USE B })");
  EXPECT_EQ(drawn.geometries.size(), 1u);
  EXPECT_EQ(drawn.materials.size(), 2u);
  EXPECT_EQ(drawn.meshes.size(), 2u);
  EXPECT_EQ(drawn.shapes[0].mesh, drawn.shapes[1].mesh);
  EXPECT_NE(drawn.shapes[0].mesh, drawn.shapes[2].mesh);
}

}  // namespace peerd::view::mesh_maker_test
