#include "collision/engines/cylinder_query.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::cylinder_query_test {

constexpr double kPi = 3.14159265358979323846;

// A hill of heights over a square of 10 m x 10 m around the origin, as an ElevationGrid is.
TriangleSoup hill(std::uint32_t cells) {
  TriangleSoup soup;
  for (std::uint32_t i = 0; i <= cells; ++i) {
    for (std::uint32_t j = 0; j <= cells; ++j) {
      const double x = 10.0 * i / cells - 5.0, z = 10.0 * j / cells - 5.0;
      soup.vertices.emplace_back(x, 3.0 - 0.1 * (x * x + z * z), z);
    }
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      const std::uint32_t at = i * (cells + 1) + j, next = at + cells + 1, cell = i * cells + j;
      soup.faces.push_back({{at, at + 1, next + 1}, cell});
      soup.faces.push_back({{at, next + 1, next}, cell});
    }
  }
  find_box(soup);
  return soup;
}

Pose at(double x, double y, double z, double about_y = 0.0, double about_z = 0.0) {
  return {Vec3(x, y, z), Quat(Eigen::AngleAxisd(about_y, Vec3::UnitY()) * Eigen::AngleAxisd(about_z, Vec3::UnitZ()))};
}

// A query knows a soup by its number.
NumberedSoup numbered(const TriangleSoup& soup, const Pose& pose) {
  return {reinterpret_cast<std::uintptr_t>(&soup), &soup, pose};
}

bool touches(CylinderQuery& query, const TriangleSoup& a, const Pose& pose_a, const TriangleSoup& b,
             const Pose& pose_b) {
  PolygonPair pair{};
  return query.find_pair(numbered(a, pose_a), numbered(b, pose_b), RelativeMotion(pose_a, pose_b), pair);
}

TEST(Cylinder, IsAroundASoupAlongADirection) {
  const TriangleSoup car = closed_box({2.0, 0.75, 1.0});
  const Cylinder upright = cylinder_around(car, Vec3::UnitY());
  EXPECT_NEAR(upright.radius_m, std::sqrt(5.0), 1e-12);
  EXPECT_DOUBLE_EQ(upright.low_m, -0.75);
  EXPECT_DOUBLE_EQ(upright.high_m, 0.75);
  const Cylinder lying = cylinder_around(car, Vec3::UnitX());
  EXPECT_NEAR(lying.radius_m, 1.25, 1e-12);
  EXPECT_DOUBLE_EQ(lying.high_m, 2.0);
}

// NPSNET's two levels: what is higher than the other one is tall goes over it; else the radii decide.
TEST(Cylinders, CompareHeightsThenDistances) {
  CylinderQuery query(CylinderAxis::kWorld);
  const TriangleSoup a = closed_box({1.0, 1.0, 1.0}), b = closed_box({1.0, 0.5, 1.0});
  EXPECT_TRUE(touches(query, a, at(0, 0, 0), b, at(2.8, 0, 0))) << "the corners' radii are 1.414 m";
  EXPECT_FALSE(touches(query, a, at(0, 0, 0), b, at(2.83, 0, 0)));
  EXPECT_TRUE(touches(query, a, at(0, 0, 0), b, at(2, 1.5, 0)));
  EXPECT_FALSE(touches(query, a, at(0, 0, 0), b, at(2, 1.501, 0)));
  EXPECT_TRUE(touches(query, a, at(50, 7, 3, 1.0), b, at(52.8, 7, 3, 2.0))) << "headings change nothing";
  PolygonPair pair{~0u, ~0u};
  EXPECT_TRUE(query.find_pair({1, &a, {}}, {2, &b, {}}, RelativeMotion(Pose{}, Pose{}), pair));
  EXPECT_EQ(pair, (PolygonPair{0, 0}));
}

// A pole that falls over reaches out of the cylinder that it stood in.
TEST(Cylinders, OfTheModelMissWhatLeansOut) {
  const TriangleSoup pole = closed_box({0.1, 3.0, 0.1}), wall = closed_box({0.5, 0.5, 0.5});
  CylinderQuery world(CylinderAxis::kWorld), model(CylinderAxis::kModel);
  const Pose lying = at(0, 0, 0, 0.0, kPi / 2), beside = at(2.5, 0, 0);
  EXPECT_FALSE(brute_force(pole, wall, RelativeMotion(lying, beside)).empty());
  EXPECT_TRUE(touches(world, pole, lying, wall, beside));
  EXPECT_FALSE(touches(model, pole, lying, wall, beside));
  EXPECT_FALSE(touches(world, pole, at(0, 0, 0), wall, beside)) << "it stands";
}

TEST(Cylinders, OfTheWorldMissNothing) {
  Numbers numbers(77);
  std::size_t touching = 0, taken = 0;
  CylinderQuery query(CylinderAxis::kWorld);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const TriangleSoup a = random_soup(1 + i % 12, 0.8, 2 * i), b = random_soup(1 + i * 7 % 12, 0.8, 2 * i + 1);
    const Pose pose_a = random_pose(numbers, 1.0), pose_b = random_pose(numbers, 1.0);
    const RelativeMotion motion(pose_a, pose_b);
    const bool touch = !brute_force(a, b, motion).empty();
    PolygonPair pair{};
    const bool found = query.find_pair({2 * i, &a, pose_a}, {2 * i + 1, &b, pose_b}, motion, pair);
    ASSERT_TRUE(found || !touch) << i;
    ASSERT_EQ(query.all_pairs({2 * i, &a, pose_a}, {2 * i + 1, &b, pose_b}, motion).empty(), !found);
    touching += touch ? 1 : 0;
    taken += found ? 1 : 0;
  }
  EXPECT_GT(touching, 400u);
  EXPECT_GT(taken, touching + touching / 10);
}

TEST(Cylinders, KnowTerrain) {
  EXPECT_TRUE(is_terrain(hill(4), Vec3::UnitY()));
  EXPECT_TRUE(is_terrain(hill(4), -Vec3::UnitY()));
  EXPECT_FALSE(is_terrain(hill(4), Vec3::UnitX())) << "it has two slopes";
  EXPECT_FALSE(is_terrain(closed_box({1, 1, 1}), Vec3::UnitY()));
}

// The slope under the circle decides, not the cylinder around all of the hill.
TEST(Cylinders, StandOnTerrain) {
  CylinderQuery query(CylinderAxis::kWorld);
  const TriangleSoup ground = hill(40), thing = closed_box({0.3, 0.5, 0.3});
  EXPECT_TRUE(touches(query, ground, at(0, 0, 0), thing, at(0, 3.4, 0)));
  EXPECT_FALSE(touches(query, ground, at(0, 0, 0), thing, at(0, 3.6, 0)));
  EXPECT_FALSE(touches(query, ground, at(0, 0, 0), thing, at(4, 2.6, 0))) << "lower than the top, above the slope";
  EXPECT_TRUE(touches(query, thing, at(4, 1.9, 0), ground, at(0, 0, 0)));
  EXPECT_FALSE(touches(query, thing, at(0, 0.5, 0), ground, at(0, 0, 0))) << "in the hollow below it";
  EXPECT_FALSE(touches(query, ground, at(0, 0, 0), thing, at(5.5, 0.5, 0))) << "beside it";
}

TEST(Cylinders, OnTerrainMissNothing) {
  CylinderQuery query(CylinderAxis::kWorld);
  const TriangleSoup ground = hill(6);
  Numbers numbers(78);
  std::size_t touching = 0, wrong = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const TriangleSoup thing = random_soup(6, 0.5, i);
    Pose pose = random_pose(numbers, 1.0);
    pose.position = {numbers.between(-5, 5), numbers.between(-2, 5), numbers.between(-5, 5)};
    const Pose tilted = at(0.1, -0.2, 0.3, numbers.unit(), numbers.between(-0.1, 0.1));
    const RelativeMotion motion(tilted, pose);
    const auto expected = brute_force(ground, thing, motion);
    const auto found = query.all_pairs({1, &ground, tilted}, {i + 2, &thing, pose}, motion);
    ASSERT_TRUE(expected.empty() || !found.empty()) << i;
    const bool is_sheet = is_terrain(thing, pose.orientation.conjugate() * Vec3::UnitY());
    for (const PolygonPair& pair : expected) {
      if (is_sheet) break;  // two terrains are cylinders
      ASSERT_TRUE(std::ranges::any_of(found, [&](const PolygonPair& f) { return f.a == pair.a; })) << i;
    }
    touching += expected.empty() ? 0 : 1;
    wrong += expected.empty() && !found.empty() ? 1 : 0;
  }
  EXPECT_GT(touching, 300u);
  EXPECT_LT(wrong, 2 * touching);
}

TEST(Cylinders, MeasureAnewWhenSomethingLeans) {
  CylinderQuery query(CylinderAxis::kWorld);
  const TriangleSoup pole = closed_box({0.1, 3.0, 0.1}), wall = closed_box({0.5, 0.5, 0.5});
  for (int turn = 0; turn < 4; ++turn) {
    const bool lies = turn % 2 == 1;
    EXPECT_EQ(touches(query, pole, at(0, 0, 0, 0.3 * turn, lies ? kPi / 2 : 0.0), wall, at(2.5, 0, 0)), lies) << turn;
  }
}

}  // namespace peerd::collision::engines::cylinder_query_test
