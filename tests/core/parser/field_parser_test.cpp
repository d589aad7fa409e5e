#include "core/parser/field_parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::field_parser_test {

struct Case {
  const char* name;
  const char* body;
  std::vector<std::string> problems;
};
class Fields : public testing::TestWithParam<Case> {};
TEST_P(Fields, AreReported) { EXPECT_EQ(problems_of(GetParam().body), GetParam().problems); }

INSTANTIATE_TEST_SUITE_P(
    Table, Fields,
    testing::Values(Case{"Good", "Shape { geometry Sphere { radius 2 } }", {}},
                    Case{"GivenTwice",
                         "Shape { geometry Sphere { radius 2 radius 3 } }",
                         {"warning 2:36: 'radius' is given twice; the last one counts"}},
                    Case{"Misspelt",
                         "Shape { geometry Sphere { radus 2 } }",
                         {"2:27: Sphere has no field 'radus', did you mean 'radius'?"}},
                    Case{"EventWithAValue",
                         "Group { addChildren Shape { } }",
                         {"2:9: 'addChildren' is an eventIn of Group: a file cannot give it a value"}},
                    Case{"EventOfAnExposedField",
                         "Transform { set_translation 1 2 3 }",
                         {"2:13: 'set_translation' is an eventIn of Transform: a file cannot give it a value"}},
                    Case{"NodeWithoutAField",
                         "Transform { Shape { } }",
                         {"2:13: 'Shape' is a node; the name of a field of Transform is missing before it"}},
                    Case{"NeverClosed",
                         "Transform { translation 1 2 3",
                         {"2:11: this Transform is never closed: a '}' is missing"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Fields, KeepTheLastValue) {
  const Scene scene = scene_of("Shape { geometry Sphere { radius 2 radius 3 } }");
  ASSERT_EQ(scene.geometries.size(), 1u);
  EXPECT_EQ(std::get<SphereGeometry>(scene.geometries[0]).radius, 3.0f);
}

}  // namespace peerd::vrml::field_parser_test
