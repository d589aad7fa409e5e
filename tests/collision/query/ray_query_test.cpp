#include "collision/query/ray_query.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <vector>

#include "tests/allocation_counter.hpp"
#include "tests/collision/oracle_types.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::ray_query_test {

// The nearest hit by a test of every triangle.
template <class FirstParameter>
std::optional<RayHit> nearest_of_all(const TriangleSoup& soup, const Ray& ray, const FirstParameter& first_parameter) {
  std::optional<RayHit> best;
  for (std::uint32_t f = 0; f < soup.faces.size(); ++f) {
    const std::optional<double> t = first_parameter(ray, soup.triangle(f));
    if (!t || *t > ray.longest) continue;
    const std::uint32_t polygon = soup.faces[f].polygon;
    if (!best || *t < best->t || (*t == best->t && polygon < best->polygon)) best = RayHit{polygon, f, *t};
  }
  return best;
}
// Returns the nearest hit by the product's exact test of each triangle. The oracle is too slow for these soups.
std::optional<RayHit> flat_nearest(const TriangleSoup& soup, const Ray& ray) {
  OrientationCounters counters;
  return nearest_of_all(soup, ray, [&](const Ray& r, const Triangle& t) { return first_parameter(r, t, counters); });
}

void expect_same(const std::optional<RayHit>& found, const std::optional<RayHit>& expected) {
  ASSERT_EQ(found.has_value(), expected.has_value());
  if (!found) return;
  EXPECT_EQ(found->t, expected->t);
  EXPECT_EQ(found->polygon, expected->polygon);
  EXPECT_EQ(found->face, expected->face);
}

// The rays are at vertices, along edges, along axes and out of faces; they come from near, from inside and from far
// away.
std::vector<Ray> rays_at(const TriangleSoup& soup, int count, std::uint64_t seed) {
  Numbers numbers(seed);
  std::vector<Ray> rays;
  const Vec3 middle = soup.box.lo / 2 + soup.box.hi / 2;
  const double size = (soup.box.hi - soup.box.lo).maxCoeff();
  for (int i = 0; i < count; ++i) {
    const auto face = static_cast<std::uint32_t>(numbers.unit() * static_cast<double>(soup.faces.size()));
    const Triangle t = soup.triangle(face);
    const double far = i % 16 == 8 ? 1e12 : i % 16 == 9 ? 1e6 : i % 16 == 10 ? 0.1 : 1.5;
    const Vec3 eye = middle + numbers.point(far * size);
    Ray ray{eye, t[0] - eye};
    switch (i % 8) {
      case 0:
        break;  // a vertex
      case 1:
        ray.direction = (t[0] / 2 + t[1] / 2) - eye;
        break;  // an edge
      case 2:
        ray = {t[0] - (t[1] - t[0]), t[1] - t[0]};
        break;  // along an edge
      case 3:
        ray.direction = Vec3::Unit(i / 8 % 3) * (i % 5 < 2 ? -1.0 : 1.0);  // along an axis
        ray.origin = t[0] - size * ray.direction;
        break;
      case 4:
        ray.origin = t[0] / 2 + t[1] / 2;
        ray.direction = numbers.point(1.0);
        break;  // from an edge
      case 5:
        ray.direction = numbers.point(1.0);
        break;
      case 6:
        ray.direction = (t[0] + t[1] + t[2]) / 3 - eye;
        break;
      default:
        ray.direction = (t[2] + (t[1] - t[0])) - eye;  // in the plane or past it
    }
    if (ray.direction == Vec3::Zero()) continue;
    ray.direction *= std::exp2(std::floor(numbers.between(-20.0, 20.0)));
    if (i % 6 == 5) ray.longest = numbers.between(0.0, 2.0) * size / ray.direction.norm();
    rays.push_back(ray);
  }
  return rays;
}

void scale(TriangleSoup& soup, double factor, const Vec3& by = Vec3::Zero()) {
  for (Vec3& v : soup.vertices) v = v * factor + by;
  find_box(soup);
}

TEST(RayQuery, IsTheNearestOfAllByTheOracle) {
  RayQuery query;
  int hits = 0, rays = 0;
  for (const TriangleSoup& soup : {random_soup(150, 0.3, 111), torus(8, 10, true), random_soup(3, 0.9, 112)}) {
    for (const Ray& ray : rays_at(soup, 150, 113)) {
      WideTree tree(soup);
      const auto found = query.nearest(tree, ray);
      expect_same(found, nearest_of_all(soup, ray, oracle_parameter));
      hits += found.has_value();
      ++rays;
    }
  }
  EXPECT_GT(hits, rays / 3);
  EXPECT_LT(hits, rays);
}

std::vector<TriangleSoup> large_soups() {
  std::vector<TriangleSoup> soups = {random_soup(2000, 0.1, 121), torus(24, 40, true), torus(40, 24, false)};
  soups.push_back(torus(16, 20, true));
  scale(soups.back(), 1.0, Vec3(4096, -1e5, 0));
  soups.push_back(random_soup(300, 0.1, 122));
  scale(soups.back(), 0x1p90);
  soups.push_back(random_soup(300, 0.1, 123));
  scale(soups.back(), 0x1p-140);
  soups.push_back(random_soup(60, 0.1, 124));
  scale(soups.back(), 0x1p-1040);
  soups.push_back(half_space());
  TriangleSoup one;  // a point
  one.vertices = {Vec3(1, 2, 3)};
  one.faces = {{{0, 0, 0}, 0}};
  one.box.merge(one.vertices[0]);
  soups.push_back(one);
  return soups;
}

TEST(RayQuery, CullingLosesNothing) {
  RayQuery query;
  std::size_t hits = 0;
  for (const TriangleSoup& soup : large_soups()) {
    WideTree tree(soup);
    for (const Ray& ray : rays_at(soup, 600, 125)) {
      if (!is_usable(ray)) continue;
      const auto found = query.nearest(tree, ray);
      expect_same(found, flat_nearest(soup, ray));
      hits += found.has_value();
    }
  }
  EXPECT_GT(hits, 1500u);
}

// The rays start within a closed tube, at each of its vertices and at the middle of each edge, which several polygons
// share.
TEST(RayQuery, NoRaySlipsThroughAnEdgeOrAVertex) {
  const TriangleSoup soup = torus(16, 24, false);
  WideTree tree(soup);
  RayQuery query;
  Numbers numbers(131);
  for (std::uint32_t f = 0; f < soup.faces.size(); ++f) {
    const Triangle t = soup.triangle(f);
    for (std::size_t e = 0; e < 3; ++e) {
      const double angle = numbers.between(0.0, 6.28);
      const Vec3 eye = Vec3(0.7 * std::cos(angle), 0.7 * std::sin(angle), 0.0) + numbers.point(0.05);
      for (const Vec3& target : {t[e], Vec3(t[e] / 2 + t[(e + 1) % 3] / 2)}) {
        ASSERT_TRUE(query.nearest(tree, {eye, target - eye}).has_value()) << f << ' ' << e;
      }
    }
  }
}

// A ray that meets an edge exactly names the lowest polygon of those that share it, not the one that the tree has
// first.
TEST(RayQuery, TheLowestPolygonOfThoseMetInOnePointIsNamed) {
  TriangleSoup fan;  // eight triangles around the z axis; polygons are numbered the other way round
  fan.vertices.push_back(Vec3::Zero());
  for (int i = 0; i < 8; ++i)
    fan.vertices.push_back(Vec3(i % 4 == 2 ? 0 : i < 2 || i > 6 ? 1 : -1, i % 4 == 0 ? 0 : i < 4 ? 1 : -1, 0));
  for (std::uint32_t i = 0; i < 8; ++i) fan.faces.push_back({{0, i + 1, (i + 1) % 8 + 1}, 7 - i});
  for (std::uint32_t i = 0; i < 64; ++i) fan.faces.push_back({{0, 0, 0}, 100 + i});
  find_box(fan);
  WideTree tree(fan);
  RayQuery query;
  const auto hit = query.nearest(tree, {Vec3(0, 0, 5), Vec3(0, 0, -2)});
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->polygon, 0u);
  EXPECT_EQ(hit->face, 7u);
  EXPECT_EQ(hit->t, 2.5);
  EXPECT_EQ(hit->point, Vec3::Zero());
}

TEST(RayQuery, BuildsTheTreeWhereTheRayGoes) {
  const TriangleSoup soup = torus(64, 128, true);
  WideTree all(soup);
  all.build_all();
  WideTree tree(soup);
  RayQuery query;
  EXPECT_FALSE(query.nearest(tree, {Vec3(5, 5, 5), Vec3(1, 0, 0)}).has_value());
  EXPECT_EQ(tree.nodes_built(), 0u);
  EXPECT_TRUE(query.nearest(tree, {Vec3(0.7, 0.01, 5), Vec3(0, 0, -1)}).has_value());
  EXPECT_GT(tree.nodes_built(), 0u);
  EXPECT_LT(tree.nodes_built(), all.nodes_built() / 20);
  EXPECT_LT(query.counters().triangle_tests, 5u);
}

#if PEERD_COUNTS_ALLOCATIONS
TEST(RayQuery, AllocatesNothingOnceItsMemoryHasGrown) {
  const TriangleSoup soup = torus(24, 40, true);
  WideTree tree(soup);
  tree.build_all();
  RayQuery query;
  const std::vector<Ray> rays = rays_at(soup, 100, 141);
  std::size_t hits = 0;
  const auto ask = [&] {
    for (const Ray& ray : rays) hits += query.nearest(tree, ray).has_value();
  };
  ask();
  const long before = allocations();
  ask();
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(hits, 20u);
}
#endif

}  // namespace peerd::collision::ray_query_test
