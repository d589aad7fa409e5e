#include "core/motion/flexible_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/read_text.hpp"

namespace peerd::flexible_shape_test {

const std::string kClock = R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF O OrientationInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 1 0, 0 0 1 3, 0 0 1 0 ] }
DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 1 1 1, 4 2 1, 1 1 1 ] }
DEF I CoordinateInterpolator { key [ 0 0.5 1 ]
  keyValue [ 0 0 0, 1 0 0, 0 1 0,  0 0 2, 1 0 0, 0 1 3,  0 0 0, 1 0 0, 0 1 0 ] }
ROUTE T.fraction_changed TO O.set_fraction
ROUTE T.fraction_changed TO P.set_fraction
ROUTE T.fraction_changed TO I.set_fraction
)";
const std::string kFace =
    "Shape { geometry IndexedFaceSet { coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } "
    "coordIndex [ 0 1 2 -1 ] } }";

std::vector<Vec3> vertices_at(const FlexibleShape& shape, PredefinedMotion& motion, double t_s) {
  const Affine place = shape.carrier_from_shape(motion, t_s);
  std::vector<Vec3> vertices;
  for (const Eigen::Vector3f& v : shape.mesh(motion, t_s).vertices) {
    vertices.push_back(multiply(place.linear, Vec3(v.cast<double>())) + place.offset);
  }
  return vertices;
}

struct Case {
  const char* name;
  std::string body;
};
class FlexibleShapes : public testing::TestWithParam<Case> {};

// Finite differences never exceed the bounds of a course, whose pieces follow each other to the end of the cycle.
TEST_P(FlexibleShapes, MoveWithinTheBoundsOfTheirCourse) {
  const Scene scene = scene_of(kClock + GetParam().body);
  PredefinedMotion motion(scene);
  const auto has_geometry = [](const Instance& i) { return i.geometry != Instance::kNone; };
  const auto at = std::ranges::find_if(scene.instances, has_geometry);
  const ObjectId id{static_cast<std::uint32_t>(at - scene.instances.begin())};
  const FlexibleShape shape(scene, motion, id, std::nullopt);
  constexpr double kStep_s = 1e-3;
  double fastest_m_s = 0.0, most_of_bound = 0.0;
  for (double t = 0.01; t < 8.0; t += 0.037) {
    const FlexibleShape::Course course = shape.course(motion, t, 0.1);
    ASSERT_GT(course.end_s, t);
    if (course.end_s < t + 2 * kStep_s) continue;
    const auto a = vertices_at(shape, motion, t), b = vertices_at(shape, motion, t + kStep_s),
               c = vertices_at(shape, motion, t + 2 * kStep_s);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double speed_m_s = (b[i] - a[i]).norm() / kStep_s;
      const double acceleration_m_s2 = (c[i] - 2 * b[i] + a[i]).norm() / (kStep_s * kStep_s);
      ASSERT_LE(a[i].norm(), course.distance_m + 1e-9) << t;
      ASSERT_LE(speed_m_s, course.speed_m_s + 1e-3) << t;
      ASSERT_LE(acceleration_m_s2, course.acceleration_m_s2 + 1.0) << t << ": the vertices are binary32";
      fastest_m_s = std::max(fastest_m_s, speed_m_s);
      most_of_bound = std::max(most_of_bound, speed_m_s / course.speed_m_s);
    }
  }
  EXPECT_GT(fastest_m_s, 0.5);
  EXPECT_GT(most_of_bound, 0.1) << "a bound that is never nearly reached says nothing";
}

INSTANTIATE_TEST_SUITE_P(
    Table, FlexibleShapes,
    testing::Values(Case{"Bends", "Transform { translation 1 0 0 scale 1 2 1 children " + kFace +
                                      " } ROUTE I.value_changed TO C.set_point"},
                    Case{"Grows", "DEF G Transform { center 0.5 0 0 children " + kFace +
                                      " } ROUTE P.value_changed TO G.set_scale"},
                    Case{"ShearsAndBends",
                         "Transform { scale 1 3 1 children DEF A Transform { translation 1 1 0 children " + kFace +
                             " } } ROUTE O.value_changed TO A.set_rotation "
                             "ROUTE I.value_changed TO C.set_point"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(FlexibleShape, StandsInTheFrameOfItsCarrier) {
  const Scene scene =
      scene_of(kClock +
               "DEF BUS Transform { translation 9 9 9 rotation 0 1 0 1 scale 2 1 1 children DEF G Transform { "
               "translation 1 0 0 children " +
               kFace + " } } ROUTE P.value_changed TO G.set_scale");
  PredefinedMotion motion(scene);
  const ObjectId bus = *scene.find("BUS"), shape{*scene.find("BUS/G/0")};
  const FlexibleShape in_bus(scene, motion, shape, bus), in_world(scene, motion, shape, std::nullopt);
  const Pose pose = scene.rigid_pose(bus);
  const auto relative = vertices_at(in_bus, motion, 1.3), world = vertices_at(in_world, motion, 1.3);
  ASSERT_EQ(relative.size(), world.size());
  for (std::size_t i = 0; i < world.size(); ++i) EXPECT_LT((pose * relative[i] - world[i]).norm(), 1e-12);
}

}  // namespace peerd::flexible_shape_test
