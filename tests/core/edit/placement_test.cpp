#include "core/edit/placement.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include <Eigen/Geometry>

#include "core/edit/scene_editor.hpp"
#include "core/scene/reader.hpp"

namespace peerd::placement_test {
namespace {

Scene read(const std::string& nodes) {
  ReadResult result = read_world("#VRML V2.0 utf8\n" + nodes);
  EXPECT_TRUE(result.scene) << nodes;
  return std::move(result.scene).value_or(Scene{});
}

struct Case {
  const char* name;
  const char* nodes;  // CAR is the object
};
class Placing : public testing::TestWithParam<Case> {};

TEST_P(Placing, PutsAnObjectWhereItIsToStand) {
  const Scene scene = read(GetParam().nodes);
  const ObjectId car = scene.find("CAR").value();
  const Pose wanted{{3, -2, 7.5}, Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -2).normalized()))};
  const auto placement = placement_of(scene, car, wanted);
  ASSERT_TRUE(placement);
  SceneEditor editor(scene);
  ASSERT_TRUE(editor.set_placement(car, *placement));
  const auto edited = editor.finish();
  ASSERT_TRUE(edited) << edited.error();
  const Pose pose = edited->rigid_pose(car);
  constexpr double kOfBinary32 = 4e-6;  // at lengths of some 10 m
  EXPECT_LT((pose.position - wanted.position).norm(), kOfBinary32);
  EXPECT_LT(pose.orientation.angularDistance(wanted.orientation), kOfBinary32);
}
INSTANTIATE_TEST_SUITE_P(
    Table, Placing,
    testing::Values(
        Case{"AtTheTop", "DEF CAR Transform { translation 1 1 1 }"},
        Case{"WithACenter", "DEF CAR Transform { center 1 2 3 rotation 0 1 0 1 }"},
        Case{"ScaledAboutACenter", "DEF CAR Transform { center 1 2 3 scale 2 1 0.5 }"},
        Case{"BelowATurnedOne", "Transform { translation 5 0 0 rotation 1 1 0 2 children DEF CAR Transform { } }"},
        Case{"BelowAScaledOne", "Transform { scale 2 2 2 translation 5 0 0 children DEF CAR Transform { } }"},
        Case{"HalfATurn", "Transform { rotation 0 1 0 3.1415927 children DEF CAR Transform { } }"}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(Placement, IsOfOneTransformInASpaceAlone) {
  const Pose origin{Vec3::Zero(), Quat::Identity()};
  const Scene group = read("DEF CAR Group { }");
  EXPECT_FALSE(placement_of(group, group.find("CAR").value(), origin));
  EXPECT_FALSE(SceneEditor(group).set_placement(group.find("CAR").value(), {}));
  const Scene twice = read("DEF CAR Transform { } USE CAR");
  EXPECT_FALSE(placement_of(twice, twice.find("CAR").value(), origin));
  const Scene single = read("DEF CAR Transform { }");
  EXPECT_FALSE(placement_of(single, single.find("CAR").value(), {{1e40, 0, 0}, Quat::Identity()}));
  const auto placement = placement_of(single, single.find("CAR").value(), origin);
  ASSERT_TRUE(placement);
  EXPECT_EQ(placement->translation, Placement{}.translation);
  EXPECT_EQ(placement->rotation.back(), 0);  // the angle; its axis is any
}

}  // namespace
}  // namespace peerd::placement_test
