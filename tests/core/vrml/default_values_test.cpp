#include "core/vrml/default_values.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::default_values_test {

struct Case {
  const char *type, *field;
  std::vector<float> value;
};
class Defaults : public testing::TestWithParam<Case> {};
TEST_P(Defaults, AreThoseOfClause6) {
  const FieldSpec* spec = find_field(*find_node_type(GetParam().type), GetParam().field);
  ASSERT_NE(spec, nullptr);
  EXPECT_THAT(default_of(*spec).as<float>(), testing::ElementsAreArray(GetParam().value));
}
INSTANTIATE_TEST_SUITE_P(Table, Defaults,
                         testing::Values(Case{"Box", "size", {2, 2, 2}}, Case{"Transform", "scale", {1, 1, 1}},
                                         Case{"Transform", "rotation", {0, 0, 1, 0}}, Case{"Cone", "bottomRadius", {1}},
                                         Case{"IndexedFaceSet", "creaseAngle", {0}}),
                         [](const auto& test) { return std::string(test.param.type) + "_" + test.param.field; });

TEST(ValueOf, PrefersWhatTheTextGives) {
  const Scene scene = scene_of("Shape { geometry Cylinder { height 7 } }");
  const Node& node = scene.document->nodes[nodes_of_type(*scene.document, "Cylinder").at(0)];
  EXPECT_EQ(value_of(node, "height").as<float>()[0], 7.0f);
  EXPECT_EQ(value_of(node, "radius").as<float>()[0], 1.0f);
}

}  // namespace peerd::vrml::default_values_test
