// These tests check the facts about configs/worlds/eq47.wrl that the scenario rests on (equation 4.7 of the thesis).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "core/geometry/tessellate.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::eq47_world_test {

using std::numbers::pi;

class Eq47World : public testing::Test {
 protected:
  void SetUp() override {
    std::ifstream file(PEERD_SOURCE_DIR "/configs/worlds/eq47.wrl", std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    ReadResult result = read_world(text);
    for (const Diagnostic& d : result.diagnostics) ADD_FAILURE() << render(result, d);
    ASSERT_TRUE(result.scene.has_value());
    scene = std::move(*result.scene);
  }

  // Returns the world box of an object that is one unscaled Shape, exactly as its vertices stand.
  Eigen::AlignedBox3d box(std::string_view name) const {
    const ObjectId object = scene.find(name).value();
    const ObjectId shape{object.number + 1};
    Eigen::AlignedBox3d out;
    const Geometry* const geometry = scene.geometry(shape);
    if (geometry == nullptr) return out;
    for (const auto& v : build_mesh(*geometry).vertices) {
      out.extend(scene.world_from_local(shape) * v.cast<double>());
    }
    return out;
  }
  Eigen::AlignedBox3d car_at(double distance) const { return box("CAR").translated(Vec3(x(distance), 0, -distance)); }

  // The path is equation 4.7 by |z|.
  static double x(double distance) {
    if (distance <= 10 * pi) return distance / 6;
    if (distance <= 20 * pi) return (20 * pi - distance) / 6;
    return std::abs(5 * std::sin(distance / 5));
  }

  Scene scene;
};

TEST_F(Eq47World, HasTheCarAtTheOrigin) {
  const Eigen::AlignedBox3d car = box("CAR");
  EXPECT_EQ(car.max(), Vec3(0.5 * 5.42f, 0.5 * 0.8f, 0.5 * 0.8f));
  EXPECT_EQ(car.min(), -car.max());
  const ObjectFields& object = scene.object(scene.find("CAR").value());
  EXPECT_EQ(object.distance_threshold_m, 0.5);
  ASSERT_TRUE(object.response.has_value());
  EXPECT_EQ(object.response->type, ResponseType::kInverse);
}

TEST_F(Eq47World, MeetsTheWallsWhereItShould) {
  const double half_width = box("CAR").max().x();
  const double right = 10 * pi / 6 + half_width - box("WALL_RIGHT").min().x();
  EXPECT_GT(right, 0.0);
  EXPECT_LT(right, 4e-9);
  const double left = box("WALL_LEFT").max().x() + half_width;
  EXPECT_GT(left, 0.0);
  EXPECT_LT(left, 4e-8);
}

// The sets are closed; a contact lasts while the car is within 4e-8 m of a turning point, 4e-7 m of travel at these
// slopes.
TEST_F(Eq47World, TouchesNothingBetweenTheContacts) {
  const double contacts[] = {10 * pi, 20 * pi, 25 * pi, 30 * pi, 35 * pi, 40 * pi};
  const char* const names[] = {"WALL_RIGHT", "WALL_LEFT", "CUBE_1", "CUBE_2", "CUBE_3"};
  std::vector<Eigen::AlignedBox3d> obstacles;
  for (const char* name : names) obstacles.push_back(box(name));
  const Eigen::AlignedBox3d car_at_start = box("CAR");
  constexpr int kSteps = 100'000;
  for (int i = 0; i <= kSteps; ++i) {
    const double distance = 40 * pi * i / kSteps;
    const bool at_contact = std::ranges::any_of(contacts, [&](double c) { return std::abs(distance - c) < 1e-6; });
    if (at_contact) continue;
    const Eigen::AlignedBox3d car = car_at_start.translated(Vec3(x(distance), 0, -distance));
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
      ASSERT_FALSE(car.intersects(obstacles[k])) << names[k] << " at |z| = " << distance;
    }
  }
}

TEST_F(Eq47World, TouchesEachWallAtItsContacts) {
  EXPECT_TRUE(car_at(10 * pi).intersects(box("WALL_RIGHT")));
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(car_at((20 + 5 * i) * pi).intersects(box("WALL_LEFT"))) << i;
}

TEST_F(Eq47World, HasCubesAtTheTurningPoints) {
  for (int i = 0; i < 3; ++i) {
    const Eigen::AlignedBox3d cube = box("CUBE_" + std::to_string(i + 1));
    EXPECT_LT((cube.center() - Vec3(8, 0, -(27.5 + 5 * i) * pi)).norm(), 5e-6);
    EXPECT_NEAR(cube.sizes().maxCoeff(), 0.2, 1e-8);
    EXPECT_FALSE(cube.intersects(box("WALL_RIGHT")));
  }
}

TEST_F(Eq47World, RegistersTheCarWithEverything) {
  ASSERT_EQ(scene.interests.size(), 1u);
  const CollisionInterest& interest = scene.interests[0];
  EXPECT_EQ(scene.path_of(interest.colliders.ends.front()), "CAR");
  EXPECT_EQ(interest.type, CollisionType::kWitness);
  std::vector<std::string> paths;
  for (const ObjectId id : interest.collidees.ends) paths.push_back(scene.path_of(id));
  EXPECT_EQ(paths, (std::vector<std::string>{"WALL_RIGHT", "WALL_LEFT", "CUBE_1", "CUBE_2", "CUBE_3"}));
}

}  // namespace peerd::eq47_world_test
