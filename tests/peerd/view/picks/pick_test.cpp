#include "peerd/view/picks/pick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "tests/must.hpp"
#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::pick_test {

using peerd::testing_support::Glb;
using peerd::testing_support::read_glb;
using peerd::testing_support::scene_of;

constexpr const char* kWorld = R"(
DEF WALL Transform { translation 0 0 -10 children DEF W Shape { geometry Box { size 10 10 1 } } }
DEF CAR Transform { enslaved TRUE translation 3 0 0 children [
  DEF BODY Shape { geometry Box { size 2 2 2 } }
  DEF DOOR Transform { translation 0 0 1.5 children Shape { geometry Box { size 1 1 1 } } } ] })";

PickHit hit_of(ScenePicker& picker, const Vec3& origin, const Vec3& direction) {
  return must(must(picker.pick(origin, direction)));
}

TEST(Pick, FindsWhatARayHitsFirst) {
  const PictureInput input = input_at(scene_of(kWorld), 0.0, "w");
  ScenePicker picker(input);
  const auto hit = hit_of(picker, Vec3(0, 1, 0), Vec3(0, 0, -2));
  EXPECT_EQ(hit.node, 1u) << "what stands";
  EXPECT_EQ(input.scene.path_of(hit.object), "WALL");
  EXPECT_EQ(input.scene.path_of(hit.shape), "WALL/W");
  EXPECT_DOUBLE_EQ(hit.distance_m, 9.5);
  EXPECT_EQ(hit.position, Vec3(0, 1, -9.5));
  EXPECT_EQ(hit.normal, Vec3::UnitZ());
  const auto door = hit_of(picker, Vec3(3, 0, 10), -Vec3::UnitZ());
  EXPECT_EQ(input.scene.path_of(door.object), "CAR") << "the door goes with the car";
  EXPECT_DOUBLE_EQ(door.distance_m, 8.0);
  EXPECT_FALSE(must(picker.pick(Vec3(0, 0, 0), Vec3::UnitY())));
  EXPECT_FALSE(picker.pick(Vec3(0, 0, 0), Vec3::Zero()));
}

TEST(Pick, MoversAreWhereTheyHaveBeenPlaced) {
  const PictureInput input = input_at(scene_of(kWorld), 0.0, "w");
  ScenePicker picker(input);
  picker.place(0, {Vec3(0, 0, -5), Quat(Eigen::AngleAxisd(std::acos(-1.0) / 2.0, Vec3::UnitY()))});
  const auto hit = hit_of(picker, Vec3(0, 0, 0), -Vec3::UnitZ());
  EXPECT_EQ(hit.node, 0u);
  EXPECT_NEAR(hit.distance_m, 4.0, 1e-12);
  picker.place(0, {Vec3(50, 0, -5), Quat::Identity()});
  const auto wall = hit_of(picker, Vec3(0, 0, 0), -Vec3::UnitZ());
  EXPECT_EQ(wall.node, 1u);
}

// The oracle: each drawn triangle by itself, after Moeller and Trumbore.
std::optional<double> nearest(const std::vector<Glb::Triangle>& all, const Vec3& origin, const Vec3& direction) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : all) {
    const Vec3 u = b - a, v = c - a, p = direction.cross(v);
    const double determinant = u.dot(p);
    if (determinant == 0.0) continue;
    const Vec3 s = origin - a, q = s.cross(u);
    const double x = s.dot(p) / determinant, y = direction.dot(q) / determinant, t = v.dot(q) / determinant;
    if (x >= 0 && y >= 0 && x + y <= 1 && t >= 0) best = std::min(best, t);
  }
  return std::isfinite(best) ? std::optional(best) : std::nullopt;
}

TEST(Pick, HitsWhatIsDrawnThere) {
  int hits = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    const auto number = [&](double lo, double hi) {
      return lo + static_cast<double>(random() >> 11) * 0x1p-53 * (hi - lo);
    };
    const auto text = [&](double lo, double hi) { return std::to_string(number(lo, hi)); };
    std::string world;
    for (int i = 0; i < 12; ++i) {
      world += std::string("Transform { ") + (i % 3 == 0 ? "enslaved TRUE " : "") + "translation " + text(-4, 4) + " " +
               text(-4, 4) + " " + text(-4, 4) + " rotation 1 " + text(-1, 1) + " 0 " + text(-3, 3) + " scale " +
               text(0.5, 2) + " 1 " + text(0.5, 2) + " children [ Transform { rotation 0 0 1 " + text(-3, 3) +
               " scale 1 " + text(0.5, 1.5) + " 1 children Shape { geometry " + (i % 2 == 0 ? "Box { }" : "Cone { }") +
               " } } ] }\n";
    }
    const PictureInput input = input_at(scene_of(world), 0.0, "w");
    ScenePicker picker(input);
    const Glb glb = read_glb(must(write_glb(picture_of(input))));
    std::vector<Glb::Triangle> all;
    for (std::size_t i = 0; i <= input.movers.size(); ++i) {
      const auto below = glb.triangles(static_cast<int>(i));
      all.insert(all.end(), below.begin(), below.end());
    }
    for (int ray = 0; ray < 50; ++ray) {
      const Vec3 origin(number(-8, 8), number(-8, 8), number(-8, 8));
      const Vec3 direction = (Vec3(number(-3, 3), number(-3, 3), number(-3, 3)) - origin).normalized();
      const auto hit = must(picker.pick(origin, direction));
      const auto expected = nearest(all, origin, direction);
      ASSERT_EQ(hit.has_value(), expected.has_value()) << "seed " << seed << " ray " << ray;
      if (!expected) continue;
      ++hits;
      EXPECT_NEAR(hit->distance_m, *expected, 1e-5) << "seed " << seed << " ray " << ray;
      EXPECT_TRUE(hit->position.isApprox(origin + hit->distance_m * direction, 1e-9));
    }
  }
  EXPECT_GT(hits, 200);
}

}  // namespace peerd::view::pick_test
