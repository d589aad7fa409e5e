#include "core/scene/object_finder.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::object_finder_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ObjectFinder, ResolveNamesAndPaths) {
  const Scene scene = scene_of(R"(
    CollisionInterest { objectPath "A" interests [ "B", "B/0" ] collisionInterests "2/C" collisionType 2 }
    DEF A Group { }
    DEF B Group { children [ Shape { } DEF C Shape { } ] }
    CollisionInterest { objectPath "C" interests "A" })");
  ASSERT_EQ(scene.interests.size(), 1u + 1u);
  EXPECT_EQ(scene.interests[0].colliders.ends.front(), ObjectId{0});
  EXPECT_THAT(scene.interests[0].collidees.ends, ElementsAre(ObjectId{1}, ObjectId{2}, ObjectId{3}));
  EXPECT_EQ(scene.interests[0].type, CollisionType::kAllPairs);
  EXPECT_EQ(scene.interests[1].colliders.ends.front(), ObjectId{3});
  EXPECT_EQ(scene.interests[1].type, CollisionType::kBox);
}

TEST(ObjectFinder, ReportWhatTheyCannotResolve) {
  EXPECT_THAT(
      problems_of("DEF CAR Group { }\nDEF M Box { }\n"
                  "CollisionInterest {\n objectPath \"CRA\"\n interests [ \"CAR\" # one\n \"M\" \"NOBODY\" ]\n"
                  " collisionType 3 }\n"
                  "CollisionInterest { interests [ \"CAR\" \"CAR\" ] }\n"
                  "CollisionInterest { objectPath \"CAR\" interests \"CAR\" }"),
      ElementsAre("warning 3:1: Box at the top level is not part of the scene by itself",
                  "5:13: no node of the scene is named 'CRA', did you mean 'CAR'?",
                  "7:2: 'M' is a Box, not a group or Shape of the scene", "7:6: no node of the scene is named 'NOBODY'",
                  "8:16: collisionType must be 0 (box), 1 (witness) or 2 (all pairs), found 3",
                  "9:1: this CollisionInterest has no objectPath: it must name the node that is registered",
                  "warning 9:39: 'CAR' is listed twice; it counts once",
                  "warning 10:1: this CollisionInterest has no interests", "10:48: 'CAR' is the collider itself"));
}

TEST(ObjectFinder, SayNothingTwiceOfALostNode) {
  EXPECT_THAT(problems_of("DEF A Shpae { } DEF B Group { } CollisionInterest { objectPath \"A\" interests \"B\" }"),
              ElementsAre(HasSubstr("unknown node type 'Shpae'")));
}

// A name of a lost node inside of other nodes counts too.
TEST(ObjectFinder, SayNothingTwiceOfALostPath) {
  EXPECT_THAT(problems_of("Group { x DEF A Group { children DEF C Shpae { } } } DEF B Group { }\n"
                          "CollisionInterest { objectPath \"C\" interests \"B\" } CollisionInterest { objectPath "
                          "\"C/0\" interests \"B\" }"),
              ElementsAre(HasSubstr("Group has no field 'x'"), HasSubstr("unknown node type 'Shpae'")));
}

}  // namespace peerd::vrml::object_finder_test
