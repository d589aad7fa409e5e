#include "core/motion/scene_motion.hpp"

#include <gmock/gmock.h>

#include <variant>

#include "tests/core/read_text.hpp"

namespace peerd::scene_motion_test {

using testing::IsEmpty;
using testing::SizeIs;

const std::string kLift = R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 0, 0 2 0, 0 0 0 ] }
ROUTE T.fraction_changed TO P.set_fraction
ROUTE P.value_changed TO LIFT.set_translation
)";

TEST(SceneMotion, VelocityVectorsMoveWhatNothingElseMoves) {
  const Scene scene = scene_of(
      "DEF GOES Transform { translation 1 0 0 velocityVector 0 0 2 } DEF STANDS Transform { translation 5 6 7 }");
  SceneMotion motion(scene);
  const auto translation = [&](std::uint32_t id, double t_s) {
    return Vec3(motion.transforms_at(t_s)[scene.at(ObjectId{id}).transform].translation);
  };
  EXPECT_EQ(translation(0, 0.0), Vec3(1, 0, 0));
  EXPECT_EQ(translation(0, 3.0), Vec3(1, 0, 6));
  EXPECT_EQ(translation(1, 3.0), Vec3(5, 6, 7));
  EXPECT_EQ(translation(0, 1.0), Vec3(1, 0, 2)) << "a function of the time, not of the calls before";
}

TEST(SceneMotion, OnlyGeometriesWhoseVerticesMovedAreGiven) {
  const Scene scene = scene_of(R"(
Shape { geometry IndexedFaceSet {
  coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 -1 ] } }
Shape { geometry Box { } }
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF I CoordinateInterpolator { key [ 0 0.5 0.75 1 ]
  keyValue [ 0 0 0, 1 0 0, 0 1 0,  0 0 2, 1 0 0, 0 1 0,  0 0 2, 1 0 0, 0 1 0,  0 0 0, 1 0 0, 0 1 0 ] }
ROUTE T.fraction_changed TO I.set_fraction
ROUTE I.value_changed TO C.set_point
)");
  SceneMotion motion(scene);
  const auto first = motion.moved_geometries(1.0);
  ASSERT_THAT(first, SizeIs(1)) << "the box never bends";
  EXPECT_EQ(std::get<FaceSetGeometry>(first.front().form).points[0].z(), 1.0f);
  EXPECT_THAT(motion.moved_geometries(1.0), IsEmpty()) << "the same time once more";
  EXPECT_THAT(motion.moved_geometries(2.0), SizeIs(1));
  EXPECT_THAT(motion.moved_geometries(2.5), IsEmpty()) << "the key values of 2 s and 3 s are the same";
  EXPECT_THAT(motion.moved_geometries(1.0), SizeIs(1)) << "and backwards";
}

}  // namespace peerd::scene_motion_test
