#include "core/vrml/scene_builder.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Newell's normal: twice the polygon's area, along its front side.
Eigen::Vector3f front(const Mesh& mesh, std::size_t polygon) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  const std::uint32_t begin = mesh.polygon_begin[polygon];
  const std::uint32_t end = mesh.polygon_begin[polygon + 1];
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto& a = mesh.vertices[mesh.indices[i]];
    const auto& b = mesh.vertices[mesh.indices[i + 1 < end ? i + 1 : begin]];
    sum += a.cross(b);
  }
  return mesh.ccw ? sum : Eigen::Vector3f(-sum);
}

TEST(SceneBuilderBox, HasSixQuadsThatFaceOutwards) {
  const Scene scene = scene_of("Shape { geometry Box { size 2 4 6 } }");
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& box = scene.meshes[0];
  ASSERT_EQ(box.polygon_count(), 6u);
  const std::vector<Eigen::Vector3f> normals = {{-48, 0, 0}, {48, 0, 0},  {0, -24, 0},
                                                {0, 24, 0},  {0, 0, -16}, {0, 0, 16}};
  for (std::size_t p = 0; p < 6; ++p) {
    EXPECT_EQ(box.polygon_begin[p + 1] - box.polygon_begin[p], 4u);
    EXPECT_EQ(front(box, p), normals[p]) << p;
    for (std::uint32_t i = box.polygon_begin[p]; i < box.polygon_begin[p + 1]; ++i) {
      const auto& v = box.vertices[box.indices[i]];
      EXPECT_GT(v.dot(front(box, p)), 0) << p;
      EXPECT_EQ(v.cwiseAbs(), Eigen::Vector3f(1, 2, 3));
    }
  }
}

TEST(SceneBuilderFaces, KeepPolygonsAsTheyAreWritten) {
  const Scene scene = scene_of(R"(Shape { geometry IndexedFaceSet {
    ccw FALSE
    coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0, 0.1 0.2 0.3 ] }
    coordIndex [ 0 1 2 3 -1, 4 4 4 -1, 0, 1, 4 ] } })");
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_THAT(mesh.polygon_begin, ElementsAre(0, 4, 7, 10));
  EXPECT_THAT(mesh.indices, ElementsAre(0, 1, 2, 3, 4, 4, 4, 0, 1, 4));
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  EXPECT_FALSE(mesh.ccw);
  EXPECT_EQ(mesh.where.line, 2u);
  EXPECT_EQ(mesh.where.column, 18u);
}

TEST(SceneBuilderFaces, WithoutPolygonsAreNoMesh) {
  for (const char* empty : {"IndexedFaceSet { }", "IndexedFaceSet { coord Coordinate { } coordIndex [ ] }"}) {
    const Scene scene = scene_of(std::string("Shape { geometry ") + empty + " }");
    EXPECT_TRUE(scene.meshes.empty());
    EXPECT_EQ(scene.instances.at(0).mesh, -1);
    EXPECT_EQ(scene.instances.at(0).unsupported_geometry, "");
  }
}

TEST(SceneBuilderFaces, ReportBadIndicesAndPolygonsWhereTheyAre) {
  EXPECT_THAT(problems_of("Shape { geometry IndexedFaceSet {\n"
                          " coord Coordinate { point [ 0 0 0 1 0 0 1 1 0 ] }\n"
                          " coordIndex [ 0 1 3 -1 # a comment\n"
                          "  0 -2 2 -1\n"
                          "  0 1 -1 -1 0 1 ] } }"),
              ElementsAre("4:19: coordIndex 3 is out of range: the Coordinate has points 0 to 2",
                          "5:5: coordIndex -2 is out of range: the Coordinate has points 0 to 2",
                          "6:7: a polygon needs at least 3 corners, this one has 2",
                          "6:10: a polygon needs at least 3 corners, this one has 0",
                          "6:15: a polygon needs at least 3 corners, this one has 2"));
  EXPECT_THAT(problems_of("Shape { geometry IndexedFaceSet { coordIndex 7 } }"),
              ElementsAre("2:46: coordIndex 7 is out of range: the Coordinate has no points",
                          "2:46: a polygon needs at least 3 corners, this one has 1"));
}

TEST(SceneBuilderFaces, SayNothingTwiceOfABrokenCoordinate) {
  EXPECT_THAT(
      problems_of("Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 nan ] } coordIndex [ 0 1 2 ] } }"),
      ElementsAre("2:66: 'nan' is not a finite number"));
  EXPECT_THAT(problems_of("Shape { geometry IndexedFaceSet { coord Cordinate { } coordIndex [ 0 1 2 ] } }"),
              ElementsAre("2:41: unknown node type 'Cordinate', did you mean 'Coordinate'?"));
}

TEST(SceneBuilderUse, SharesTheMesh) {
  const std::string body = R"(
    DEF A Transform { children DEF S Shape { geometry DEF G Box { } } }
    Transform { children USE S }
    Shape { geometry USE G }
    USE A)";
  const Scene scene = scene_of(body);
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 7u);
  for (const std::uint32_t shape : {1, 3, 4, 6}) EXPECT_EQ(scene.instances[shape].mesh, 0) << shape;
  EXPECT_EQ(scene.instances[5].def, "A");
  EXPECT_EQ(scene.instances[5].where.line, 6u) << "a USE is where it is used";

  const ReadStatistics s = read_world(world_text(body)).statistics;
  EXPECT_EQ(s.nodes, 5u);
  EXPECT_EQ(s.instances, 7u);
  EXPECT_EQ(s.shapes, 4u);
  EXPECT_EQ(s.meshes, 1u);
  EXPECT_EQ(s.polygons, 6u);
  EXPECT_EQ(s.vertices, 8u);
  EXPECT_EQ(s.polygons_instanced, 24u);
}

TEST(SceneBuilderFields, CarryTheSeedsExtensions) {
  const Scene scene = scene_of(R"(
    Transform {
      velocityVector 1 2 3 distanceThreshold 0.25 enslaved TRUE remote FALSE
      collisionResponse CollisionResponse { responseType 1 setBack FALSE }
      children Shape { convexHull [ 1 2 3, 4 5 6 ] hierarchyFile "a.hier" splitThreshold 3 geometry Box { } }
    }
    Transform { collisionResponse CollisionResponse { } children Shape { } })");
  const Instance& t = scene.instances.at(0);
  EXPECT_EQ(t.velocity, Vec3(1, 2, 3));
  EXPECT_EQ(t.distance_threshold_m, 0.25);
  ASSERT_TRUE(t.response.has_value());
  EXPECT_EQ(t.response->type, ResponseType::kZero);
  EXPECT_FALSE(t.response->set_back);
  const Instance& s = scene.instances.at(1);
  EXPECT_THAT(s.convex_hull, ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(4, 5, 6)));
  EXPECT_EQ(s.hierarchy_file, "a.hier");
  EXPECT_EQ(s.split_threshold, 3);
  // and the defaults
  EXPECT_EQ(scene.instances.at(2).distance_threshold_m, 0.5);
  EXPECT_EQ(scene.instances.at(2).response->type, ResponseType::kInverse);
  EXPECT_TRUE(scene.instances.at(2).response->set_back);
  EXPECT_FALSE(t.response == std::nullopt);
  EXPECT_EQ(scene.instances.at(3).split_threshold, 10);
}

TEST(SceneBuilderGeometry, NamesWhatIsNotTessellatedYet) {
  for (const char* type :
       {"Sphere", "Cone", "Cylinder", "ElevationGrid", "Extrusion", "IndexedLineSet", "PointSet", "Text"}) {
    const std::string body = std::string("Shape { geometry ") + type + " { } }";
    const Scene scene = scene_of(body);
    EXPECT_EQ(scene.instances.at(0).unsupported_geometry, type);
    EXPECT_EQ(scene.instances.at(0).mesh, -1);
    EXPECT_EQ(read_world(world_text(body)).statistics.cannot_collide_yet, 1u);
  }
}

TEST(SceneBuilderInterests, ResolveNamesAndPaths) {
  const Scene scene = scene_of(R"(
    CollisionInterest { objectPath "A" interests [ "B", "B/0" ] collisionInterests "2/C" collisionType 2 }
    DEF A Group { }
    DEF B Group { children [ Shape { } DEF C Shape { } ] }
    CollisionInterest { objectPath "C" interests "A" })");
  ASSERT_EQ(scene.interests.size(), 1u + 1u);
  EXPECT_EQ(scene.interests[0].collider, ObjectId{0});
  EXPECT_THAT(scene.interests[0].collidees, ElementsAre(ObjectId{1}, ObjectId{2}, ObjectId{3}));
  EXPECT_EQ(scene.interests[0].type, CollisionType::kAllPairs);
  EXPECT_EQ(scene.interests[1].collider, ObjectId{3});
  EXPECT_EQ(scene.interests[1].type, CollisionType::kBox);
  EXPECT_EQ(scene.interests[1].where.line, 6u);
}

TEST(SceneBuilderInterests, ReportWhatTheyCannotResolve) {
  EXPECT_THAT(
      problems_of("DEF CAR Group { }\nDEF M Box { }\n"
                  "CollisionInterest {\n objectPath \"CRA\"\n interests [ \"CAR\" # one\n \"M\" \"NOBODY\" ]\n"
                  " collisionType 3 }\n"
                  "CollisionInterest { interests [ \"CAR\" \"CAR\" ] }\n"
                  "CollisionInterest { objectPath \"CAR\" interests \"CAR\" }"),
      ElementsAre("warning 3:1: Box at the top level is not part of the scene by itself",
                  "5:13: no node of the scene is named 'CRA', did you mean 'CAR'?",
                  "7:2: 'M' is a Box, not a Group, Transform or Shape of the scene",
                  "7:6: no node of the scene is named 'NOBODY'",
                  "8:16: collisionType must be 0 (box), 1 (witness) or 2 (all pairs), found 3",
                  "9:1: this CollisionInterest has no objectPath: it must name the node that is registered",
                  "warning 9:39: 'CAR' is listed twice; it counts once",
                  "warning 10:1: this CollisionInterest has no interests", "10:48: 'CAR' is the collider itself"));
}

TEST(SceneBuilderInterests, SayNothingTwiceOfALostNode) {
  EXPECT_THAT(problems_of("DEF A Shpae { } DEF B Group { } CollisionInterest { objectPath \"A\" interests \"B\" }"),
              ElementsAre(HasSubstr("unknown node type 'Shpae'")));
}

TEST(SceneBuilderResponse, ChecksItsType) {
  EXPECT_THAT(problems_of("Transform { collisionResponse CollisionResponse { responseType 2 } }"),
              ElementsAre("2:64: responseType must be 0 (CRT_INVERSE) or 1 (CRT_ZERO), found 2"));
}

// Thirty lines that name a billion instances.
TEST(SceneBuilderLimits, RefuseExplodingUse) {
  std::string body = "DEF N0 Group { }\n";
  for (int i = 1; i <= 30; ++i) {
    const std::string below = std::to_string(i - 1);
    body += "DEF N" + std::to_string(i) + " Group { children [ USE N" + below + " USE N" + below + " ] }\n";
  }
  EXPECT_THAT(problems_of(body), ElementsAre(HasSubstr("the world has more than 1048576 instances")));
}

TEST(SceneBuilderLimits, RefuseDeepChainsOfUse) {
  const auto chain = [](int length) {
    std::string body = "DEF N0 Group { }\n";
    for (int i = 1; i < length; ++i) {
      body += "DEF N" + std::to_string(i) + " Group { children USE N" + std::to_string(i - 1) + " }\n";
    }
    return body;
  };
  EXPECT_THAT(problems_of(chain(256)), IsEmpty());
  EXPECT_THAT(problems_of(chain(1000)), ElementsAre(HasSubstr("nested more than 256 deep")));
}

}  // namespace
}  // namespace peerd
