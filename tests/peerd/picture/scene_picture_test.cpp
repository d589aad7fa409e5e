#include "peerd/picture/scene_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/peerd/picture/picture_of_text.hpp"

namespace peerd::picture::scene_picture_test {

using peerd::testing_support::picture_of_text;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> left_out(const ScenePicture& drawn) {
  std::vector<std::string> out;
  for (const Undrawn& u : drawn.undrawn) out.push_back(u.path + " " + u.what + ": " + u.why);
  return out;
}

// All that is not drawn, or otherwise than the standard says, is named with its place.
TEST(ScenePicture, NamesWhatItLeavesOut) {
  struct Case {
    const char *name, *text, *line;
  };
  for (const Case& c : {
           Case{"Text", "DEF S Shape { geometry Text { string \"a\" } }", "S Text: no viewer draws it yet"},
           Case{"Billboard", "DEF B Billboard { children Shape { geometry Box { } } }",
                "B Billboard: it does not turn towards the viewer"},
           Case{"LOD", "DEF L LOD { range 5 level [ Shape { geometry Box { } } Shape { geometry Cone { } } ] }",
                "L LOD: its first level is drawn at any distance"},
           Case{"Anchor", "DEF A Anchor { url \"x\" children Shape { geometry Box { } } }",
                "A Anchor: its link is not followed"},
           Case{"Sensor", "DEF T Transform { children [ TouchSensor { } Shape { geometry Box { } } ] }",
                "T TouchSensor: no viewer works it"},
           Case{"Sound", "Sound { source AudioClip { url \"a.wav\" } }", " Sound: no viewer plays it"},
           Case{"Texture",
                "DEF S Shape { appearance Appearance { texture ImageTexture { url \"a.png\" } } geometry Box { } }",
                "S texture: ImageTexture: \"a.png\": it is not looked for"},
           Case{"Movie",
                "DEF S Shape { appearance Appearance { texture MovieTexture { url \"a.mpg\" } } geometry Box { } }",
                "S texture: MovieTexture"},
           Case{"Colours",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                "coordIndex [0 1 2] color Color { color [1 0 0, 0 1 0] } } }",
                "S IndexedFaceSet: its colours: they do not match its polygons"},
           Case{"Normals",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                "coordIndex [0 1 2] normal Normal { vector [0 0 0, 0 0 1, 0 0 1] } } }",
                "S IndexedFaceSet: its normals: they do not match its polygons"},
           Case{"Area",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 2 0 0] } "
                "coordIndex [0 1 2] } }",
                "S IndexedFaceSet: 1 polygon without area"},
           Case{"Route",
                "DEF T TimeSensor { loop TRUE } DEF I ColorInterpolator { key [0 1] keyValue [0 0 0, 1 1 1] } "
                "Shape { appearance Appearance { material DEF M Material { } } geometry Box { } } "
                "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO M.set_diffuseColor",
                "M Material: no ROUTE changes its diffuseColor"},
           Case{"Scale",
                "DEF T TimeSensor { loop TRUE } DEF I PositionInterpolator { key [0 1] keyValue [1 1 1, 2 2 2] } "
                "DEF X Transform { children DEF S Shape { geometry Box { } } } "
                "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO X.set_scale",
                "X/S Shape: it changes its shape as the world moves, and keeps that of the picture"},
           Case{"Light", "DEF G Group { children DirectionalLight { } }",
                "G DirectionalLight: it shines on everything, not only on its siblings"},
       }) {
    EXPECT_THAT(left_out(picture_of_text(c.text)), ElementsAre(c.line)) << c.name;
  }
}

TEST(ScenePicture, CountsWhatItLeavesOutBeyondAThousandOfAKind) {
  std::string text;
  for (int i = 0; i < 1500; ++i) text += "Shape { geometry Text { string \"" + std::to_string(i) + "\" } }\n";
  const ScenePicture drawn = picture_of_text(text);
  ASSERT_EQ(drawn.undrawn.size(), 1001u);
  EXPECT_EQ(drawn.undrawn.front().count, 1u);
  EXPECT_EQ(drawn.undrawn.back().count, 500u);
}

TEST(ScenePicture, DrawsWhatIsInTheWorld) {
  const ScenePicture drawn = picture_of_text(R"(
Switch { whichChoice 1 choice [ DEF A Shape { geometry Box { } } DEF B Shape { geometry Cone { } } ] }
Switch { choice DEF C Shape { geometry Box { } } }
Collision { proxy DEF D Shape { geometry Box { } } children DEF E Shape { geometry Sphere { } } })");
  EXPECT_THAT(drawn.shape_paths, ElementsAre("0/B", "2/E"));
  EXPECT_THAT(drawn.undrawn, IsEmpty());
}

}  // namespace peerd::picture::scene_picture_test
