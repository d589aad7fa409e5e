#include "core/scene/scene_builder.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::scene_builder_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(SceneBuilderUse, SharesTheGeometry) {
  const std::string body = R"(
    DEF A Transform { children DEF S Shape { geometry DEF G Box { } } }
    Transform { children USE S }
    Shape { geometry USE G }
    USE A)";
  const Scene scene = scene_of(body);
  EXPECT_EQ(scene.geometries.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 7u);
  for (const std::uint32_t shape : {1, 3, 4, 6}) EXPECT_EQ(scene.instances[shape].geometry, 0u) << shape;
  EXPECT_EQ(scene.instances[5].def, "A");
  EXPECT_EQ(scene.instances[5].node, scene.instances[0].node);
}

// An instance of a node that is instanced a second time has the names, children and shadows of the first.
TEST(SceneBuilderUse, IsTheSameSubtreeAgain) {
  const Scene scene = scene_of(R"(
    DEF A Group { children [ DEF N Shape { } DEF N Group { children DEF M Shape { } } ] }
    Group { children [ Shape { } USE A ] })");
  EXPECT_THAT(paths_of(scene), ElementsAre("A", "A/N", "A/1", "A/1/M", "1", "1/0", "1/A", "1/A/N", "1/A/1", "1/A/1/M"));
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
    EXPECT_EQ(scene.find(scene.path_of(ObjectId{i})), ObjectId{i});
}

TEST(SceneBuilderUse, LeavesEachInstanceOfALaterInlinePending) {
  ReadOptions options;
  options.defer_inlines = true;
  const Scene scene =
      scene_of("DEF G Group { children Inline { url \"a.wrl\" bboxSize 1 1 1 } } Transform { children USE G }",
               {{"a.wrl", "Shape { }"}}, options);
  ASSERT_EQ(scene.pending_inlines.size(), 2u);
  EXPECT_EQ(scene.path_of(scene.pending_inlines[0].instance), "G/0");
  EXPECT_EQ(scene.path_of(scene.pending_inlines[1].instance), "1/G/0");
}

TEST(SceneBuilderFields, CarryTheExtensionsOfTheThesis) {
  const Scene scene = scene_of(R"(
    Transform {
      velocityVector 1 2 3 distanceThreshold 0.25 enslaved TRUE remote FALSE
      collisionResponse CollisionResponse { responseType 1 setBack FALSE }
      children Shape { convexHull [ 1 2 3, 4 5 6 ] hierarchyFile "a.hier" splitThreshold 3 geometry Box { } }
    }
    Transform { collisionResponse CollisionResponse { } children Shape { } })");
  const ObjectFields& t = scene.object(ObjectId{0});
  EXPECT_EQ(t.velocity, Vec3(1, 2, 3));
  EXPECT_EQ(t.distance_threshold_m, 0.25);
  ASSERT_TRUE(t.response.has_value());
  EXPECT_EQ(t.response->type, ResponseType::kZero);
  EXPECT_FALSE(t.response->set_back);
  const ShapeFields& s = scene.shape(ObjectId{1});
  EXPECT_THAT(s.convex_hull.span(), ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(4, 5, 6)));
  EXPECT_EQ(s.hierarchy_file, "a.hier");
  EXPECT_EQ(s.split_threshold, 3);
  const Scene struck = scene_of(
      "Transform { collisionResponse CollisionResponse { responseType 2 mass 0.25 restitution 0.5 friction 0.125 } }");
  const CollisionResponse& impulse = *struck.object(ObjectId{0}).response;
  EXPECT_EQ(impulse.type, ResponseType::kImpulse);
  EXPECT_EQ(impulse.mass_kg, 0.25);
  EXPECT_EQ(impulse.restitution, 0.5);
  EXPECT_EQ(impulse.friction_m_s2, 0.125);
  // and the defaults
  EXPECT_EQ(scene.object(ObjectId{2}).response->mass_kg, 1.0);
  EXPECT_EQ(scene.object(ObjectId{2}).response->restitution, 1.0);
  EXPECT_EQ(scene.object(ObjectId{2}).response->friction_m_s2, 0.0);
  EXPECT_EQ(scene.object(ObjectId{2}).distance_threshold_m, 0.5);
  EXPECT_EQ(scene.object(ObjectId{2}).response->type, ResponseType::kInverse);
  EXPECT_TRUE(scene.object(ObjectId{2}).response->set_back);
  EXPECT_EQ(scene.shape(ObjectId{3}).split_threshold, 10);
  EXPECT_TRUE(scene.shape(ObjectId{3}).convex_hull.empty());
  // of a node that is none of the two
  EXPECT_FALSE(scene.object(ObjectId{3}).response.has_value());
  EXPECT_EQ(scene.shape(ObjectId{2}).split_threshold, 10);
  EXPECT_EQ(scene.instances[3].extension, Instance::kNone);
}

TEST(SceneBuilderKinds, AreTheNodes) {
  const Scene scene = scene_of(R"(
    Group { } Anchor { } Transform { } Billboard { } Collision { } Inline { } LOD { } Switch { } Shape { } Viewpoint { })");
  std::vector<NodeKind> kinds;
  for (const Instance& instance : scene.instances) kinds.push_back(instance.kind);
  EXPECT_THAT(
      kinds, ElementsAre(NodeKind::kGroup, NodeKind::kGroup, NodeKind::kTransform, NodeKind::kBillboard,
                         NodeKind::kCollision, NodeKind::kInline, NodeKind::kLod, NodeKind::kSwitch, NodeKind::kShape));
}

// 6.46: whichChoice -1, or beyond the choices, chooses nothing. Others than the chosen one are there and do not
// collide.
TEST(SceneBuilderCollides, BelowASwitchsChoiceOnly) {
  const auto solid = [](const std::string& which) {
    return solid_of(
        scene_of("Switch { " + which + " choice [ Viewpoint { } Shape { } Group { children Shape { } } ] }"));
  };
  EXPECT_THAT(solid(""), ElementsAre("0"));
  EXPECT_THAT(solid("whichChoice -5"), ElementsAre("0"));
  EXPECT_THAT(solid("whichChoice 0"), ElementsAre("0"));
  EXPECT_THAT(solid("whichChoice 1"), ElementsAre("0", "0/1"));
  EXPECT_THAT(solid("whichChoice 2"), ElementsAre("0", "0/2", "0/2/0"));
  EXPECT_THAT(solid("whichChoice 3"), ElementsAre("0"));
  EXPECT_THAT(solid("whichChoice 2147483647"), ElementsAre("0"));
}

TEST(SceneBuilderCollides, AtAnLodsFirstLevelOnly) {  // 6.26: the first level is the finest
  EXPECT_THAT(solid_of(scene_of("LOD { range [ 10 20 ] level [ Shape { } Group { children Shape { } } Shape { } ] }")),
              ElementsAre("0", "0/0"));
  EXPECT_THAT(solid_of(scene_of("LOD { }")), ElementsAre("0"));
}

TEST(SceneBuilderCollides, AsACollisionSays) {  // 6.8
  EXPECT_THAT(solid_of(scene_of("Collision { children [ Shape { } Shape { } ] }")), ElementsAre("0", "0/0", "0/1"));
  EXPECT_THAT(solid_of(scene_of("Collision { collide FALSE children [ Shape { } ] }")), ElementsAre("0"));
  EXPECT_THAT(solid_of(scene_of("Collision { children [ Shape { } Shape { } ] proxy Group { children Shape { } } }")),
              ElementsAre("0", "0/2", "0/2/0"));
  EXPECT_THAT(solid_of(scene_of("Collision { collide FALSE children Shape { } proxy Shape { } }")), ElementsAre("0"));
  EXPECT_THAT(solid_of(scene_of("Collision { proxy Shape { } }")), ElementsAre("0", "0/0"));
}

TEST(SceneBuilderCollides, IsForEachInstanceByItself) {
  const Scene scene = scene_of(
      "Switch { choice DEF S Group { children Shape { } } } USE S Collision { collide FALSE children [ USE S LOD { "
      "level USE S } ] }");
  EXPECT_THAT(solid_of(scene), ElementsAre("0", "1", "1/0", "2"));
}

// A Collision answers apart what is seen and what collides; a Switch or an LOD answers both at once.
TEST(SceneBuilderDrawn, IsWhatIsSeenWhetherItCollidesOrNot) {
  EXPECT_THAT(drawn_of(scene_of("Collision { collide FALSE children [ Shape { } ] }")), ElementsAre("0", "0/0"));
  EXPECT_THAT(drawn_of(scene_of("Collision { children Shape { } proxy Group { children Shape { } } }")),
              ElementsAre("0", "0/0"));
  EXPECT_THAT(drawn_of(scene_of("Switch { whichChoice 1 choice [ Shape { } Shape { } ] }")), ElementsAre("0", "0/1"));
  EXPECT_THAT(drawn_of(scene_of("LOD { level [ Shape { } Shape { } ] }")), ElementsAre("0", "0/0"));
  const Scene scene = scene_of(
      "Collision { collide FALSE children DEF S Group { children Shape { } } } Collision { proxy USE S } USE S USE S");
  EXPECT_THAT(drawn_of(scene), ElementsAre("0", "0/S", "0/S/0", "1", "2", "2/0", "3", "3/0"));
  EXPECT_THAT(solid_of(scene), ElementsAre("0", "1", "1/S", "1/S/0", "2", "2/0", "3", "3/0"));
}

TEST(SceneBuilderCollides, LeavesAnchorsAndBillboardsAlone) {
  EXPECT_THAT(solid_of(scene_of("Anchor { children Billboard { axisOfRotation 0 0 0 children Shape { } } }")),
              ElementsAre("0", "0/0", "0/0/0"));
}

TEST(SceneBuilderTransform, WarnsOfAScaleThatTheStandardForbids) {  // 6.52: > 0
  for (const char* scale : {"0 1 1", "1 -1 1", "-1 -1 -1"}) {
    EXPECT_THAT(problems_of(std::string("Transform { scale ") + scale + " }"),
                ElementsAre("warning 2:19: a scale of 0 or less is outside VRML97; it is applied as written"));
    EXPECT_EQ(scene_of(std::string("Transform { scale ") + scale + " }").instances.size(), 1u);
  }
}

TEST(SceneBuilderResponse, ChecksItsType) {
  EXPECT_THAT(problems_of("Transform { collisionResponse CollisionResponse { responseType 3 } }"),
              ElementsAre("2:64: responseType must be 0 (CRT_INVERSE), 1 (CRT_ZERO) or 2 (CRT_IMPULSE), found 3"));
}

TEST(SceneBuilderResponse, ChecksWhatAnImpulseIsOf) {
  const auto of = [](const std::string& fields) {
    return problems_of("Transform { collisionResponse CollisionResponse { " + fields + " } }");
  };
  EXPECT_THAT(of("responseType 2 mass 0"), ElementsAre(HasSubstr("'mass' must be > 0, found '0'")));
  EXPECT_THAT(of("responseType 2 restitution -0.5"), ElementsAre(HasSubstr("'restitution' must be >= 0")));
  EXPECT_THAT(of("responseType 2 restitution 1.5"), ElementsAre(HasSubstr("restitution must be 0 to 1")));
  EXPECT_THAT(of("responseType 2 friction -1"), ElementsAre(HasSubstr("'friction' must be >= 0")));
  EXPECT_THAT(of("friction 1"), ElementsAre(HasSubstr("friction counts with responseType 2 (CRT_IMPULSE) only")));
  EXPECT_THAT(of("responseType 2 mass 2 restitution 0 friction 1"), IsEmpty());
}

TEST(SceneBuilderScripts, AreMentionedOnce) {
  EXPECT_THAT(problems_of("Group { }\nScript { } Script { }"),
              ElementsAre("warning 3:1: Scripts are kept and not run; this is the first one"));
}

}  // namespace peerd::scene_builder_test
