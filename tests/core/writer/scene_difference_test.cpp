#include "core/writer/scene_difference.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::scene_difference_test {

using testing::HasSubstr;

struct Unlike {
  const char *name, *a, *b, *says;
};
class FindsDifference : public testing::TestWithParam<Unlike> {};
TEST_P(FindsDifference, Says) {
  const auto& [name, a, b, says] = GetParam();
  const Scene x = scene_of(a), y = scene_of(b);
  EXPECT_THAT(difference(x, y), HasSubstr(says));
  EXPECT_NE(difference(y, x), "");
}
INSTANTIATE_TEST_SUITE_P(
    Table, FindsDifference,
    testing::Values(
        Unlike{"Zeros", "Transform { translation 0 0 0 }", "Transform { translation -0 0 0 }", "translation"},
        Unlike{"Default", "Transform { }", "Transform { translation 0 0 0 }", "Transform"},
        Unlike{"Kind", "Group { }", "Anchor { }", "Group is a Anchor"},
        Unlike{"Number", "Group { }", "Group { } Group { }", "nodes that stand behind the scene: 0, not 1"},
        Unlike{"Name", "DEF A Group { }", "DEF B Group { }", "is named 'B'"},
        Unlike{"Sharing", "DEF A Shape { } USE A", "DEF A Shape { } Shape { }", "shared"},
        Unlike{"Sharing2", "DEF A Shape { } DEF A Shape { }", "DEF A Shape { } USE A", "shared"},
        Unlike{"Order", "Group { children [ Shape { } Group { } ] }", "Group { children [ Group { } Shape { } ] }",
               "is a"},
        Unlike{"Strings", "WorldInfo { info [ \"a\" \"b\" ] }", "WorldInfo { info [ \"a\" \"c\" ] }", "info"},
        Unlike{"Points", "IndexedFaceSet { coord Coordinate { point [ 0 0 1 ] } }",
               "IndexedFaceSet { coord Coordinate { point [ 0 0 2 ] } }", "point"},
        Unlike{"Choice", "Switch { choice Shape { } whichChoice 0 }", "Switch { choice Shape { } whichChoice 1 }",
               "whichChoice"},
        Unlike{"Null", "Shape { geometry Box { } }", "Shape { geometry NULL }", "null"},
        Unlike{"Route", "DEF A TimeSensor { } DEF B TimeSensor { } ROUTE A.time TO B.startTime",
               "DEF A TimeSensor { } DEF B TimeSensor { } ROUTE A.time TO B.stopTime", "ROUTE"},
        Unlike{"RouteEnd", "DEF A TimeSensor { } DEF B TimeSensor { } ROUTE A.time TO B.startTime",
               "DEF A TimeSensor { } DEF B TimeSensor { } ROUTE B.time TO A.startTime", "ROUTE"},
        Unlike{"NoRoute", "DEF A TimeSensor { } ROUTE A.time TO A.startTime", "DEF A TimeSensor { }",
               "ROUTEs: 1, not 0"},
        Unlike{"Interest", "DEF A Group { } DEF B Group { } CollisionInterest { objectPath \"A\" interests \"B\" }",
               "DEF A Group { } DEF B Group { } CollisionInterest { objectPath \"B\" interests \"A\" }",
               "CollisionInterests"},
        Unlike{"Sensor", "DEF A Transform { } DEF B Transform { } KeySensor { recipient \"A\" }",
               "DEF A Transform { } DEF B Transform { } KeySensor { recipient \"B\" }", "KeySensors"},
        Unlike{"Script", "Script { field SFBool a TRUE }", "Script { eventIn SFBool a }", "Script"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Difference, OfAWorldToItselfIsNone) {
  const Scene scene =
      scene_of("DEF A Transform { children [ Shape { geometry Sphere { } } ] } Group { children USE A }");
  EXPECT_EQ(difference(scene, scene), "");
}

}  // namespace peerd::scene_difference_test
