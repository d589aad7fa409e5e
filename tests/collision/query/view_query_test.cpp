#include "collision/query/view_query.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/allocation_counter.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::view_query_test {

using ::testing::ElementsAreArray;
using Real = long double;

Frustum frustum_of(const Camera& camera) {
  const auto frustum = make_frustum(camera);
  EXPECT_TRUE(frustum.has_value()) << frustum.error();
  return frustum.value_or(Frustum());
}

// The least distance of a point from any of the planes; > 0 is inside.
Real depth(const Frustum& frustum, const Vec3& p) {
  Real least = std::numeric_limits<Real>::infinity();
  for (std::size_t i = 0; i < frustum.count(); ++i) {
    Real d = frustum[i].offset_m;
    for (int k = 0; k < 3; ++k) d += static_cast<Real>(frustum[i].normal[k]) * p[k];
    least = std::min(least, d);
  }
  return least;
}

struct Sight {
  double aspect, field_of_view;
  Vec3 in_camera;
  bool seen;
};

// At 60 degrees tan(fov / 2) is 0.57735.
TEST(Frustum, TheSmallerAngleOfTheDisplayIsTheFieldOfView) {
  constexpr double kFov = 1.0471975511965976;
  for (const auto& [aspect, fov, p, seen] : {
           Sight{1.0, kFov, {0, 0, -5}, true},
           Sight{1.0, kFov, {0, 0, 5}, false},
           Sight{1.0, kFov, {0, 0, -0.9}, false},  // near
           Sight{1.0, kFov, {0, 0, -101}, false},  // far
           Sight{1.0, kFov, {5.77, 0, -10}, true},
           Sight{1.0, kFov, {5.78, 0, -10}, false},
           Sight{1.0, kFov, {0, -5.77, -10}, true},
           Sight{1.0, kFov, {0, -5.78, -10}, false},
           Sight{2.0, kFov, {0, 5.77, -10}, true},
           Sight{2.0, kFov, {0, 5.78, -10}, false},
           Sight{2.0, kFov, {-11.54, 0, -10}, true},  // tan(h / 2) = 2 tan(v / 2)
           Sight{2.0, kFov, {-11.55, 0, -10}, false},
           Sight{0.5, kFov, {5.77, 0, -10}, true},
           Sight{0.5, kFov, {5.78, 0, -10}, false},
           Sight{0.5, kFov, {0, 11.54, -10}, true},
           Sight{0.5, kFov, {0, 11.55, -10}, false},
           Sight{4.0, 3.1, {900, 0, -10}, true},  // the larger angle stays below pi
           Sight{4.0, 3.1, {0, 900, 0}, false},
       }) {
    Numbers numbers(7);
    for (const Pose& pose : {Pose{}, random_pose(numbers, 30.0)}) {
      const Frustum frustum = frustum_of({pose, fov, aspect, 1.0, 100.0});
      EXPECT_EQ(frustum.count(), 6u);
      EXPECT_EQ(depth(frustum, pose * p) > 0, seen) << aspect << " at " << p.transpose();
    }
  }
}

TEST(Frustum, WithoutAFarPlaneReachesEverywhere) {
  const Frustum frustum = frustum_of({Pose{}});
  EXPECT_EQ(frustum.count(), 5u);
  EXPECT_GT(depth(frustum, Vec3(0, 0, -1e30)), 0);
}

TEST(Frustum, RefusesWhatNobodyCanSeeBy) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, 3.15, nan, infinity}) EXPECT_FALSE(make_frustum({Pose{}, bad}).has_value());
  for (const double bad : {0.0, -1.0, nan, infinity}) EXPECT_FALSE(make_frustum({Pose{}, 0.7, bad}).has_value());
  EXPECT_FALSE(make_frustum({Pose{}, 0.7, 1.0, 2.0, 2.0}).has_value());
  EXPECT_FALSE(make_frustum({Pose{}, 0.7, 1.0, -1.0, 2.0}).has_value());
  EXPECT_FALSE(make_frustum({Pose{}, 0.7, 1.0, nan, 2.0}).has_value());
  EXPECT_FALSE(make_frustum({Pose{Vec3(nan, 0, 0), Quat::Identity()}}).has_value());
  Frustum frustum;
  EXPECT_FALSE(frustum.add(Vec3::Zero(), 1.0));
  EXPECT_FALSE(frustum.add(Vec3(nan, 0, 0), 1.0));
  for (std::size_t i = 0; i < Frustum::kMaxPlanes; ++i) EXPECT_TRUE(frustum.add(Vec3(0, 2, 0), 4.0));
  EXPECT_FALSE(frustum.add(Vec3(0, 1, 0), 1.0));
  EXPECT_EQ(frustum[0].offset_m, 2.0);
}

Camera random_camera(Numbers& numbers) {
  const double near = numbers.between(0.0, 0.5);
  return {random_pose(numbers, 2.0), numbers.between(0.1, 2.5), numbers.between(0.3, 3.0), near,
          numbers.unit() < 0.3 ? std::numeric_limits<double>::infinity() : near + numbers.between(0.1, 3.0)};
}

Vec3 corner(const WorldBox& box, unsigned i) {
  return {(i & 1) != 0 ? box.hi[0] : box.lo[0], (i & 2) != 0 ? box.hi[1] : box.lo[1],
          (i & 4) != 0 ? box.hi[2] : box.lo[2]};
}

TEST(InView, OfABoxIsWhatItsCornersSayPlaneByPlane) {
  Numbers numbers(202);
  std::array<int, 3> answers{};
  for (int i = 0; i < 5000; ++i) {
    const Frustum frustum = frustum_of(random_camera(numbers));
    WorldBox box;
    box.merge(numbers.point(2.0));
    box.merge(Vec3(box.lo + numbers.point(numbers.between(0.0, 1.0))));
    PlaneMask active = frustum.all();
    const InView answer = in_view(frustum, box, active);
    ++answers[static_cast<std::size_t>(answer)];
    bool outside = false;
    PlaneMask crossed = 0;
    for (std::size_t n = 0; n < frustum.count(); ++n) {
      Frustum one;
      ASSERT_TRUE(one.add(frustum[n].normal, frustum[n].offset_m));
      Real least = std::numeric_limits<Real>::infinity(), most = -least;
      for (unsigned c = 0; c < 8; ++c) {
        least = std::min(least, depth(one, corner(box, c)));
        most = std::max(most, depth(one, corner(box, c)));
      }
      outside |= most < -1e-12L;
      if (least < 1e-12L) crossed = static_cast<PlaneMask>(crossed | 1u << n);
    }
    ASSERT_EQ(answer == InView::kOutside, outside);
    if (outside) continue;
    ASSERT_EQ(active, crossed);
    ASSERT_EQ(answer == InView::kInside, crossed == 0);
  }
  for (const int count : answers) EXPECT_GT(count, 100);
}

TEST(InView, TouchingIsNotOutsideAndEmptyIs) {
  Frustum frustum;
  ASSERT_TRUE(frustum.add(Vec3(1, 0, 0), 0.0));
  PlaneMask active = frustum.all();
  EXPECT_EQ(in_view(frustum, {Vec3(-1, 0, 0), Vec3(0, 1, 1)}, active), InView::kMaybe);
  EXPECT_EQ(active, frustum.all());
  EXPECT_EQ(in_view(frustum, {Vec3(-1, 0, 0), Vec3(-1e-9, 1, 1)}, active), InView::kOutside);
  EXPECT_EQ(in_view(frustum, WorldBox{}, active), InView::kOutside);
  WorldBox everything;
  everything.lo.fill(-std::numeric_limits<double>::infinity());
  everything.hi.fill(std::numeric_limits<double>::infinity());
  EXPECT_EQ(in_view(frustum, everything, active), InView::kMaybe);
}

// The part of a triangle within all planes moved inwards by `margin`, after Sutherland and Hodgman.
bool certainly_has_a_point_in(const Frustum& frustum, const Triangle& t, Real margin) {
  using Point = std::array<Real, 3>;
  std::vector<Point> polygon, next;
  for (const Vec3& p : t) polygon.push_back({p[0], p[1], p[2]});
  for (std::size_t n = 0; n < frustum.count(); ++n) {
    const auto distance = [&](const Point& p) {
      Real d = frustum[n].offset_m - margin;
      for (std::size_t k = 0; k < 3; ++k) d += p[k] * static_cast<Real>(frustum[n].normal[static_cast<int>(k)]);
      return d;
    };
    next.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const Real at_a = distance(a), at_b = distance(b);
      if (at_a >= 0) next.push_back(a);
      if (at_a * at_b < 0) {
        Point cut;
        for (std::size_t k = 0; k < 3; ++k) cut[k] = a[k] + (b[k] - a[k]) * (at_a / (at_a - at_b));
        next.push_back(cut);
      }
    }
    polygon.swap(next);
  }
  return !polygon.empty();
}

struct View {
  TriangleSoup soup;
  Pose pose;
  Frustum frustum;
  double size;
};
std::vector<View> views() {
  Numbers numbers(203);
  std::vector<View> out;
  for (int i = 0; i < 60; ++i) {
    const double size = i % 5 == 1 ? 0x1p70 : i % 5 == 2 ? 0x1p-100 : 1.0;
    TriangleSoup soup = i % 2 == 0 ? torus(16, 24, true) : random_soup(500, 0.2, 204);
    for (Vec3& v : soup.vertices) v *= size;
    find_box(soup);
    Camera camera = random_camera(numbers);
    camera.T_world_camera.position *= size;
    camera.near_m *= size;
    camera.far_m *= size;
    Pose pose = random_pose(numbers, size);
    if (i % 5 == 3) {
      pose.position += Vec3(1e6, 0, -1e6);
      camera.T_world_camera.position += Vec3(1e6, 0, -1e6);
    }
    out.push_back({std::move(soup), pose, frustum_of(camera), size});
  }
  return out;
}

TEST(ViewQuery, LeavesOutNoTriangleThatIsInViewAndFewOthers) {
  ViewQuery query;
  std::size_t found = 0, left_out = 0, needless = 0;
  for (const View& v : views()) {
    WideTree tree(v.soup);
    const auto& faces = query.faces_in_view(tree, v.pose, v.frustum);
    std::vector<bool> in_view(v.soup.faces.size());
    for (const std::uint32_t f : faces) {
      EXPECT_FALSE(in_view[f]);
      in_view[f] = true;
    }
    for (std::uint32_t f = 0; f < v.soup.faces.size(); ++f) {
      Triangle t = v.soup.triangle(f);
      for (Vec3& p : t) p = v.pose * p;
      const Real far = v.pose.position.norm() * 0x1p-50;
      if (certainly_has_a_point_in(v.frustum, t, 0x1p-48 * v.size + far)) {
        ASSERT_TRUE(in_view[f]);
      }
      bool beyond = false;  // one plane, clearly
      for (std::size_t n = 0; n < v.frustum.count(); ++n) {
        Frustum one;
        ASSERT_TRUE(one.add(v.frustum[n].normal, v.frustum[n].offset_m));
        const Real clearly = -1e-5L * v.size - 1e-8L * (v.size == 1.0);
        beyond |= std::max({depth(one, t[0]), depth(one, t[1]), depth(one, t[2])}) < clearly;
      }
      EXPECT_FALSE(beyond && in_view[f]);
      found += in_view[f];
      left_out += !in_view[f];
      needless += in_view[f] && !certainly_has_a_point_in(v.frustum, t, -1e-5L * v.size);
    }
    EXPECT_EQ(query.may_be_in_view(tree, v.pose, v.frustum, v.frustum.all()), !faces.empty());
  }
  EXPECT_GT(found, 2000u);
  EXPECT_GT(left_out, 2000u);
  EXPECT_LT(needless, found / 20);
}

TEST(ViewQuery, FacesStandInTheOrderOfTheTree) {
  ViewQuery query;
  std::size_t found = 0;
  for (const View& v : views()) {
    WideTree tree(v.soup), built(v.soup);
    built.build_all();
    const auto as_found = query.faces_in_view(tree, v.pose, v.frustum);
    const std::vector<std::uint32_t> faces(as_found.begin(), as_found.end());
    EXPECT_THAT(query.faces_in_view(built, v.pose, v.frustum), ElementsAreArray(faces));
    std::vector<bool> in_view(v.soup.faces.size());
    for (const std::uint32_t f : faces) in_view[f] = true;
    std::vector<std::uint32_t> expected;
    for (const std::uint32_t f : built.faces()) {
      if (in_view[f]) expected.push_back(f);
    }
    EXPECT_EQ(faces, expected);
    found += faces.size();
  }
  EXPECT_GT(found, 2000u);
}

TEST(ViewQuery, LooksNoDeeperThanItIsTold) {
  const TriangleSoup soup = torus(64, 128, true);
  // Its hole is all that this sees: the box is in view, and no triangle is.
  const Frustum hole = frustum_of({Pose{Vec3(0, 0, 5), Quat::Identity()}, 0.1});
  const Frustum rim = frustum_of({Pose{Vec3(0.7, 0, 5), Quat::Identity()}, 0.1});
  ViewQuery query;
  WideTree tree(soup);
  EXPECT_TRUE(query.may_be_in_view(tree, Pose{}, hole, hole.all(), 0));
  EXPECT_EQ(tree.nodes_built(), 0u);
  EXPECT_FALSE(query.may_be_in_view(tree, Pose{}, hole, hole.all()));
  WideTree top(soup);
  EXPECT_TRUE(query.may_be_in_view(top, Pose{}, rim, rim.all(), 1));
  EXPECT_EQ(top.nodes_built(), 1u);
  WideTree shallow(soup);
  EXPECT_TRUE(query.may_be_in_view(shallow, Pose{}, rim, rim.all(), 2));
  EXPECT_GT(shallow.nodes_built(), 0u);
  EXPECT_LT(shallow.nodes_built(), 10u);  // the root and some of its children
  // Without any plane everything is in view, and nothing is tested.
  const std::uint64_t before = query.counters().plane_tests;
  EXPECT_TRUE(query.may_be_in_view(tree, Pose{}, hole, 0));
  EXPECT_EQ(query.counters().plane_tests, before);
}

TEST(ViewQuery, WhatIsWhollyInsideIsTestedByNoPlaneBelow) {
  const TriangleSoup soup = torus(32, 32, true);
  WideTree tree(soup);
  ViewQuery query;
  const Frustum frustum = frustum_of({Pose{Vec3(0, 0, 5), Quat::Identity()}, 1.5});
  const auto seen = query.faces_in_view(tree, Pose{}, frustum);
  tree.build_all();
  EXPECT_THAT(seen, ElementsAreArray(tree.faces()));
  EXPECT_EQ(query.counters().plane_tests, frustum.count());  // the root's children, and that was all
}

#if PEERD_COUNTS_ALLOCATIONS
TEST(ViewQuery, AllocatesNothingOnceItsMemoryHasGrown) {
  const TriangleSoup soup = torus(24, 40, true);
  WideTree tree(soup);
  tree.build_all();
  ViewQuery query;
  const std::vector<View> all = views();
  std::size_t found = 0;
  const auto ask = [&] {
    for (const View& v : all) found += query.faces_in_view(tree, v.pose, v.frustum).size();
  };
  ask();
  const long before = allocations();
  ask();
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(found, 100u);
}
#endif

}  // namespace peerd::collision::view_query_test
