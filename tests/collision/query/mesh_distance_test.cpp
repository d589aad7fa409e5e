#include "collision/query/mesh_distance.hpp"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "collision/exact/triangle_distance.hpp"
#include "collision/query/wide_distance.hpp"
#include "tests/collision/oracle_types.hpp"
#include "tests/collision/soups.hpp"
#include "tests/oracle/distance_oracle.hpp"
#include "tests/oracle/triangle_cases.hpp"

namespace peerd::collision::mesh_distance_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The square of the distance of meshes, every triangle against every one but those whose boxes are farther apart than
// what was found: 1 + 2^-40 is more than the rounding of that.
mpq_class brute_force_distance(const TriangleSoup& a, const TriangleSoup& b, const RelativeMotion& a_from_b) {
  struct Boxed {
    Triangle t;
    Vec3 lo, hi;
  };
  const auto boxed = [](const Triangle& t) {
    return Boxed{t, t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
  };
  std::vector<Boxed> moved;
  for (std::uint32_t j = 0; j < b.faces.size(); ++j) {
    const Triangle t = b.triangle(j);
    moved.push_back(boxed({a_from_b(t[0]), a_from_b(t[1]), a_from_b(t[2])}));
  }
  struct Pair {
    double gap;
    std::uint32_t i, j;
  };
  std::vector<Pair> pairs;
  std::vector<Boxed> still;
  for (std::uint32_t i = 0; i < a.faces.size(); ++i) still.push_back(boxed(a.triangle(i)));
  for (std::uint32_t i = 0; i < still.size(); ++i) {
    for (std::uint32_t j = 0; j < moved.size(); ++j) {
      const Vec3 gap = (still[i].lo - moved[j].hi).cwiseMax(moved[j].lo - still[i].hi).cwiseMax(Vec3::Zero());
      pairs.push_back({gap.squaredNorm(), i, j});
    }
  }
  std::ranges::sort(pairs, {}, &Pair::gap);
  mpq_class least = -1;
  for (const Pair& pair : pairs) {
    if (least >= 0 && mpq_class(pair.gap) > least * mpq_class(1.0 + 0x1p-40)) break;
    const mpq_class square = oracle::squared_distance(plain(still[pair.i].t), plain(moved[pair.j].t));
    if (least < 0 || square < least) least = square;
  }
  return least;
}

void expect_certain(const MeshDistance& found, const mpq_class& square) {
  ASSERT_LE(0.0, found.lower_m);
  ASSERT_LE(squared(found.lower_m), square) << found.lower_m << " " << std::sqrt(square.get_d());
  if (found.upper_m < kInfinity) {
    ASSERT_GE(squared(found.upper_m), square) << found.upper_m << " " << std::sqrt(square.get_d());
  }
  ASSERT_EQ(found.upper_m == 0.0, square == 0);
}

RelativeMotion between(const Pose& a, const Pose& b) { return {a, b}; }

// Each option is held against the truth: near, touching, crossing and far, with cracked, doubled and flat triangles.
TEST(MeshDistance, IntervalsHoldTheTruth) {
  Numbers numbers(84);
  const TriangleSoup soup = random_soup(90, 0.3, 85), ring = torus(8, 12, true), slivers = random_soup(50, 1e-6, 86);
  const std::array<const TriangleSoup*, 3> soups = {&soup, &ring, &slivers};
  MeshDistanceQuery query;
  int touching = 0, apart = 0;
  for (int i = 0; i < 240; ++i) {
    const TriangleSoup &of_a = *soups[static_cast<std::size_t>(i) % 3],
                       &of_b = *soups[static_cast<std::size_t>(i) / 3 % 3];
    const double distance = std::exp2(numbers.between(-4.0, 5.0));
    const RelativeMotion motion = between(random_pose(numbers, 0.1), random_pose(numbers, distance));
    const mpq_class square = brute_force_distance(of_a, of_b, motion);
    (square == 0 ? touching : apart) += 1;
    WideTree a(of_a), b(of_b);
    for (const double part : {0.0, 1e-3, 0.1, 0.5}) {
      const MeshDistance found = query.distance(a, b, motion, {.relative_accuracy = part});
      ASSERT_NO_FATAL_FAILURE(expect_certain(found, square));
      ASSERT_LE(found.upper_m - found.lower_m, part * found.upper_m * 1.0001 + 0x1p-43 * (distance + 2.0));
      ASSERT_NEAR((found.on_b - found.on_a).norm(), found.upper_m, 0x1p-43 * (distance + 2.0));
    }
    for (const double accuracy : {1e-6, 0.01, 1.0}) {
      const MeshDistance found = query.distance(a, b, motion, {.accuracy_m = accuracy});
      ASSERT_NO_FATAL_FAILURE(expect_certain(found, square));
      ASSERT_LE(found.upper_m - found.lower_m, accuracy * 1.0001 + 0x1p-43 * (distance + 2.0));
    }
    const std::uint32_t all = query.distance(a, b, motion).iterations;
    for (std::uint32_t most = 0; most <= all; most += 1 + most / 2) {
      const MeshDistance found = query.distance(a, b, motion, {.max_iterations = most});
      ASSERT_NO_FATAL_FAILURE(expect_certain(found, square));
      ASSERT_LE(found.iterations, square == 0 ? 4 : most);
    }
    for (const double limit : {1e-3, 0.3, 3.0}) {
      const MeshDistance far = query.distance(a, b, motion, {.stop_above_m = limit});
      ASSERT_NO_FATAL_FAILURE(expect_certain(far, square));
      ASSERT_TRUE(far.lower_m >= limit || far.upper_m - far.lower_m <= 0x1p-43 * (distance + 2.0));
      const MeshDistance near = query.distance(a, b, motion, {.stop_below_m = limit});
      ASSERT_NO_FATAL_FAILURE(expect_certain(near, square));
      ASSERT_TRUE(near.upper_m <= limit || near.upper_m - near.lower_m <= 0x1p-43 * (distance + 2.0));
    }
  }
  EXPECT_GT(touching, 30);
  EXPECT_GT(apart, 30);
}

// The triangles of a soup that is one leaf, as boxes.
WideTree::Node boxes_of(const TriangleSoup& soup) {
  WideTree tree(soup);
  const WideTree::Leaf& leaf = tree.leaf(tree.at(WideTree::kRoot).index());
  WideTree::Node node;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
      const float p = leaf.corners[0][k][i], q = leaf.corners[1][k][i], r = leaf.corners[2][k][i];
      const float lo = std::min({p, q, r}), hi = std::max({p, q, r});
      node.center[k][i] = 0.5f * lo + 0.5f * hi;
      node.half[k][i] = i < leaf.count ? std::max(hi - node.center[k][i], node.center[k][i] - lo) : WideTree::kNoBox;
    }
  }
  for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
    const auto corner = [&](std::size_t c) {
      const auto& at = leaf.corners[c];
      return Float4{at[0][i] + leaf.center[0], at[1][i] + leaf.center[1], at[2][i] + leaf.center[2], 0.0f};
    };
    const auto triangle = [&](auto&& use) { use(corner(0), corner(1), corner(2)); };
    Bounds4 bounds;
    for (std::size_t c = 0; c < 3; ++c) bounds.merge(corner(c));
    BoxFit fit(bounds);
    fit.weigh(triangle);
    if (fit.turn()) fit.add(triangle);
    put_oriented(fit.box(), node, i);
  }
  return node;
}

// The vector unit's bounds, of two plates that face each other across a gap that binary32 hardly sees, each with a far
// corner behind it: they are tight there, so none can leave out its rounding. Every second triangle is a point, for the
// lines of centers.
TEST(MeshDistance, BoundsAllowForTheirRounding) {
  Numbers numbers(93);
  const auto plate = [](std::uint64_t seed, double height, double behind) {
    Numbers of_plate(seed);
    TriangleSoup soup;
    const std::uint32_t triangles = 1 + static_cast<std::uint32_t>(of_plate.between(0.0, 7.0));
    for (std::uint32_t t = 0; t < triangles; ++t) {
      for (int k = 0; k < 3; ++k) soup.vertices.emplace_back(of_plate.between(-9, 9), of_plate.between(-9, 9), height);
      if (t % 2) soup.vertices[3 * t + 1] = soup.vertices[3 * t + 2] = soup.vertices[3 * t];
      soup.faces.push_back({{3 * t, 3 * t + 1, 3 * t + 2}, t});
    }
    soup.vertices.emplace_back(of_plate.between(-900, 900), of_plate.between(-900, 900), behind);
    const auto far = static_cast<std::uint32_t>(soup.vertices.size()) - 1;
    soup.faces.push_back({{far, far, far}, triangles});
    return soup;
  };
  double tightest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double height = numbers.between(-500, 500), gap = std::exp2(numbers.between(-6.0, 0.0));
    const std::uint64_t seed = 1000 + static_cast<std::uint64_t>(i);
    TriangleSoup of_a = plate(seed, height, height - 900), of_b = plate(seed, height + gap, height + 900);
    // The pair stands along an axis of the frames, or aslant.
    const Quat turn = i % 2 ? random_pose(numbers, 1.0).orientation : Quat::Identity();
    const Pose there = i % 4 < 2 ? Pose{} : random_pose(numbers, 1.0);
    for (Vec3& v : of_a.vertices) of_a.box.merge(v = turn * v);
    for (Vec3& v : of_b.vertices) of_b.box.merge(v = there.orientation.conjugate() * (turn * v - there.position));
    const RelativeMotion motion = between({}, there);
    WideTree a(of_a), b(of_b);
    const WideTree::Leaf &leaf_a = a.leaf(a.at(WideTree::kRoot).index()),
                         &leaf_b = b.leaf(b.at(WideTree::kRoot).index());
    const WideMotion wide(a, b, motion);
    const Vec3 up = turn * Vec3(0, 0, i % 3 ? 1.0 : gap);
    const std::array<float, 3> guess = {static_cast<float>(up[0]), static_cast<float>(up[1]),
                                        static_cast<float>(up[2])};
    constexpr float kMost = std::numeric_limits<float>::max();
    std::array<Distances, 3> found;
    DistanceRows estimates;
    distances_of_nodes(boxes_of(of_a), leaf_a.count, boxes_of(of_b), leaf_b.count, wide, kMost, found[0]);
    distances_of_leaves(leaf_a, leaf_b, wide, guess, 0.0f, found[1], estimates);  // both directions only
    distances_of_leaves(leaf_a, leaf_b, wide, guess, kMost, found[2], estimates);
    for (std::size_t j = 0; j < leaf_b.count; ++j) {
      const Triangle in_b = of_b.triangle(b.face(leaf_b, j));
      for (std::size_t k = 0; k < leaf_a.count; ++k) {
        const double truth =
            triangle_distance(of_a.triangle(a.face(leaf_a, k)), {motion(in_b[0]), motion(in_b[1]), motion(in_b[2])})
                .upper;
        for (const Distances& of : found) ASSERT_LE(static_cast<double>(of.lower[j][k]), truth) << i;
        if (truth < 1.0) tightest = std::max(tightest, static_cast<double>(found[1].lower[j][k]) / truth);
      }
    }
  }
  EXPECT_GT(tightest, 0.8);
}

// The pair is of polygons that have the distance, and the points are theirs.
TEST(MeshDistance, NamesPolygonsThatAreAsNear) {
  Numbers numbers(87);
  const TriangleSoup ring = torus(10, 16, true);
  WideTree a(ring), b(ring);
  MeshDistanceQuery query;
  for (int i = 0; i < 300; ++i) {
    const RelativeMotion motion = between(random_pose(numbers, 1.0), random_pose(numbers, 2.0));
    const MeshDistance found = query.distance(a, b, motion);
    double least = kInfinity, to_a = kInfinity, to_b = kInfinity;
    for (std::uint32_t f = 0; f < ring.faces.size(); ++f) {
      const Triangle t = ring.triangle(f), moved = {motion(t[0]), motion(t[1]), motion(t[2])};
      const auto to = [](const Vec3& p, const Triangle& of) { return triangle_distance({p, p, p}, of).distance; };
      if (ring.faces[f].polygon == found.pair.b) to_b = std::min(to_b, to(found.on_b, moved));
      if (ring.faces[f].polygon != found.pair.a) continue;
      to_a = std::min(to_a, to(found.on_a, t));
      for (std::uint32_t g = 0; g < ring.faces.size(); ++g) {
        if (ring.faces[g].polygon != found.pair.b) continue;
        const Triangle u = ring.triangle(g);
        least = std::min(least, triangle_distance(t, {motion(u[0]), motion(u[1]), motion(u[2])}).distance);
      }
    }
    ASSERT_NEAR(least, found.upper_m, 1e-13);
    ASSERT_LT(to_a, 1e-13);
    ASSERT_LT(to_b, 1e-13);
  }
}

TEST(MeshDistance, OfSmallGapsAndTouches) {
  TriangleSoup ring = torus(12, 24, false);
  for (Vec3& v : ring.vertices) {  // sin(pi) to 0
    for (double& x : v) x = std::abs(x) < 1e-12 ? 0.0 : x;
  }
  WideTree a(ring), b(ring);
  MeshDistanceQuery query;
  const RelativeMotion beside = between({}, {{2.0, 0, 0}, Quat::Identity()});  // x to 1: they touch in a corner
  EXPECT_EQ(query.distance(a, b, beside).upper_m, 0.0);
  EXPECT_EQ(query.distance(a, b, beside, {.accuracy_m = 1.0, .max_iterations = 0}).upper_m, 0.0);
  for (int e = -52; e <= 0; ++e) {
    const double gap = std::ldexp(1.0, e);
    const RelativeMotion apart = between({}, {{2.0 + 2.0 * gap, 0, 0}, Quat::Identity()});
    const double truth = apart.translation[0] - 2.0;
    const MeshDistance found = query.distance(a, b, apart);
    ASSERT_LE(found.lower_m, truth);
    ASSERT_GE(found.upper_m, truth);
    ASSERT_EQ(found.upper_m == 0.0, truth == 0.0);
    ASSERT_LE(found.upper_m - found.lower_m, 1e-13);
  }
}

TEST(MeshDistance, WhatIsInsideIsAsFarAsTheSkin) {
  const TriangleSoup outside = torus(8, 12, false);
  TriangleSoup inside = outside;  // the tube's axis, thin
  for (Vec3& v : inside.vertices) {
    const Vec3 axis = 0.7 * Vec3(v[0], v[1], 0).normalized();
    v = axis + 0.1 * (v - axis);
  }
  find_box(inside);
  WideTree a(outside), b(inside);
  MeshDistanceQuery query;
  const MeshDistance found = query.distance(a, b, between({}, {}));
  ASSERT_NO_FATAL_FAILURE(expect_certain(found, brute_force_distance(outside, inside, between({}, {}))));
  EXPECT_NEAR(found.upper_m, 0.25, 0.03);
}

TEST(MeshDistance, FarFromTheOrigin) {
  Numbers numbers(88);
  const TriangleSoup near = random_soup(60, 0.3, 89);
  TriangleSoup far = near;
  for (Vec3& v : far.vertices) v += Vec3(1e6, -2e6, 3e6);
  find_box(far);
  WideTree a(near), b(far);
  MeshDistanceQuery query;
  for (int i = 0; i < 60; ++i) {
    // The pair is in the world, far from its origin, and either Shape's vertices are far from its own.
    const Pose here = {Vec3(4e6, 5e6, -6e6), random_pose(numbers, 1.0).orientation};
    Pose there = random_pose(numbers, 4.0);
    there.position += here.position - there.orientation * Vec3(1e6, -2e6, 3e6);
    for (const bool swapped : {false, true}) {
      const RelativeMotion motion = swapped ? between(there, here) : between(here, there);
      const TriangleSoup &of_a = swapped ? far : near, &of_b = swapped ? near : far;
      const MeshDistance found = query.distance(swapped ? b : a, swapped ? a : b, motion);
      ASSERT_NO_FATAL_FAILURE(expect_certain(found, brute_force_distance(of_a, of_b, motion)));
      ASSERT_LE(found.upper_m - found.lower_m, 1e-6);
    }
  }
}

// Coordinates up to 2^128 m and down to 1e-30 m.
TEST(MeshDistance, OfAllSizes) {
  Numbers numbers(90);
  const TriangleSoup half = half_space(), ring = torus(4, 6, true);
  MeshDistanceQuery query;
  int apart = 0;
  for (int i = 0; i < 96; ++i) {
    TriangleSoup of_b = i % 4 == 0 ? half : ring;
    const double size = i % 4 == 0 ? 1.0 : std::exp2(numbers.between(-100.0, 120.0));
    for (Vec3& v : of_b.vertices) v *= size;
    of_b.box.lo *= size, of_b.box.hi *= size;
    TriangleSoup of_a = i % 3 == 0 ? half : ring;
    const double size_a = i % 3 == 0 ? 1.0 : i % 2 ? size : std::exp2(numbers.between(-100.0, 120.0));
    for (Vec3& v : of_a.vertices) v *= size_a;
    of_a.box.lo *= size_a, of_a.box.hi *= size_a;
    const RelativeMotion motion =
        between({}, {numbers.point(3.0) * std::exp2(numbers.between(-20.0, 3.0)) * std::max(size, size_a),
                     random_pose(numbers, 1.0).orientation});
    WideTree a(of_a), b(of_b);
    const mpq_class square = brute_force_distance(of_a, of_b, motion);
    ASSERT_NO_FATAL_FAILURE(expect_certain(query.distance(a, b, motion), square)) << i;
    ASSERT_NO_FATAL_FAILURE(expect_certain(query.distance(a, b, motion, {.relative_accuracy = 0.1}), square)) << i;
    apart += square > 0;
  }
  EXPECT_GT(apart, 25);
}

// Squares over- and underflow in binary32 long before that: 2^-40 to 2^126 m take no more pairs than 1 m.
TEST(MeshDistance, AllSizesCostTheSame) {
  const auto iterations = [](double size) {
    TriangleSoup ring = torus(16, 32, true);
    for (Vec3& v : ring.vertices) v *= size;
    ring.box.lo *= size, ring.box.hi *= size;
    WideTree a(ring), b(ring);
    MeshDistanceQuery query;
    Numbers numbers(94);
    double sum = 0.0;
    for (int i = 0; i < 20; ++i) {
      Pose there = random_pose(numbers, 1.0);
      there.position = (there.position + Vec3(2.5, 0, 0)) * size;
      const MeshDistance found = query.distance(a, b, between({}, there), {.relative_accuracy = 0.1});
      EXPECT_LE(found.upper_m - found.lower_m, 0.1001 * found.upper_m);
      sum += found.iterations;
    }
    return sum;
  };
  const double of_one = iterations(1.0);
  for (int e = -40; e <= 126; e += 2) EXPECT_LE(iterations(std::ldexp(1.0, e)), 1.1 * of_one) << e;
}

TEST(MeshDistance, BuildsWhatItLooksAt) {
  const TriangleSoup ring = torus(64, 128, false);  // 2048 leaves
  MeshDistanceQuery query;
  WideTree a(ring), b(ring);
  const RelativeMotion far = between({}, {{30, 4, 5}, Quat::Identity()});
  const MeshDistance enough = query.distance(a, b, far, {.stop_above_m = 10.0});
  EXPECT_GE(enough.lower_m, 10.0);
  EXPECT_EQ(a.nodes_built() + b.nodes_built(), 0u);
  EXPECT_EQ(query.distance(a, b, far, {.stop_below_m = 100.0}).iterations, 0u);
  EXPECT_EQ(a.nodes_built() + b.nodes_built(), 0u);
  (void)query.distance(a, b, far, {.relative_accuracy = 0.1});
  EXPECT_LE(a.nodes_built(), 10u);
  EXPECT_LE(b.nodes_built(), 10u);
  (void)query.distance(a, b, between({}, {{3, 0, 0}, Quat::Identity()}), {.relative_accuracy = 0.1});
  EXPECT_LE(a.nodes_built(), 300u);
}

void expect_same(const MeshDistance& x, const MeshDistance& y) {
  ASSERT_EQ(x.lower_m, y.lower_m);
  ASSERT_EQ(x.upper_m, y.upper_m);
  ASSERT_EQ(x.pair, y.pair);
  ASSERT_EQ(x.on_a, y.on_a);
  ASSERT_EQ(x.on_b, y.on_b);
  ASSERT_EQ(x.iterations, y.iterations);
}

// Neither earlier queries, nor what was built, nor the instruction set changes a bit.
TEST(MeshDistance, IsTheSameEverywhere) {
  const TriangleSoup soup = torus(24, 48, false), ring = torus(16, 32, true);
  std::vector<MeshDistance> first;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (const bool fresh : {false, true}) {
      Numbers numbers(92);
      WideTree a(soup), b(ring);
      if (!fresh) a.build_all();
      MeshDistanceQuery query;
      for (std::size_t i = 0; i < 200; ++i) {
        const RelativeMotion motion = between({}, random_pose(numbers, 3.0));
        const MeshDistanceOptions options{.relative_accuracy = 0.05 * static_cast<double>(i % 8)};
        WideTree own_a(soup), own_b(ring);
        MeshDistanceQuery own;
        const MeshDistance found =
            fresh ? own.distance(own_a, own_b, motion, options) : query.distance(a, b, motion, options);
        if (first.size() == i) first.push_back(found);
        expect_same(found, first[i]);
        if (HasFatalFailure()) return hwy::SetSupportedTargetsForTest(0);
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace peerd::collision::mesh_distance_test
