#include "tests/collision/scene_hash.hpp"

#include <bit>
#include <span>
#include <vector>

#include "collision/exact/triangle_pair.hpp"
#include "collision/query/ray_query.hpp"
#include "collision/query/view_query.hpp"
#include "collision/query/wide_query.hpp"
#include "tests/collision/soups.hpp"
#include "tests/oracle/triangle_cases.hpp"

namespace peerd::collision {
namespace {

constexpr int kPairsOfGenerator = 100, kPoses = 40;

class Hash {  // FNV-1a, by words
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3; }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const OrientationCounters& c) {
    add(c.exact);
    add(c.wide);
  }
  void add(const QueryCounters& c) {
    add(c.bv_tests);
    add(c.bv_updates);
    add(c.triangle_tests);
    add(c.orientation);
  }
  void add(const PolygonPair& pair) {
    add(std::uint64_t{pair.a});
    add(std::uint64_t{pair.b});
  }
  void add(const std::vector<PolygonPair>& pairs) {
    add(std::uint64_t{pairs.size()});
    for (const PolygonPair& pair : pairs) add(pair);
  }
  void add(const RelativeMotion& motion) {
    for (int i = 0; i < 9; ++i) add(motion.rotation.data()[i]);
    for (int i = 0; i < 3; ++i) add(motion.translation[i]);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

// Pairs

Triangle triangle(const oracle::Triangle& t) {
  const auto corner = [&](std::size_t i) { return Vec3(t[i][0], t[i][1], t[i][2]); };
  return {corner(0), corner(1), corner(2)};
}

void add_pairs(std::span<const oracle::Generator> generators, Hash& hash) {
  for (const oracle::Generator& generator : generators) {
    oracle::Rng rng(7);
    OrientationCounters counters;
    for (int i = 0; i < kPairsOfGenerator; ++i) {
      const oracle::Pair pair = generator.make(rng);
      hash.add(std::uint64_t{touch(triangle(pair.a), triangle(pair.b), counters)});
      hash.add(std::uint64_t{touch(triangle(pair.b), triangle(pair.a), counters)});
    }
    hash.add(counters);
  }
}

// Meshes

TriangleSoup soup_of(std::vector<Eigen::Vector3f> vertices, std::vector<std::int32_t> corners, const Mat3& stretch) {
  return *make_soup(make_mesh(std::move(vertices), std::move(corners)), stretch);
}

// A saddle of quadrilaterals that are not planar.
TriangleSoup saddle(std::int32_t cells, const Mat3& stretch) {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::int32_t> corners;
  for (std::int32_t i = 0; i <= cells; ++i) {
    for (std::int32_t j = 0; j <= cells; ++j) {
      const double x = 2.0 * i / cells - 1.0, y = 2.0 * j / cells - 1.0;
      vertices.push_back(Vec3(x, y, 0.7 * x * x - 0.5 * y * y * y).cast<float>());
    }
  }
  for (std::int32_t i = 0; i < cells; ++i) {
    for (std::int32_t j = 0; j < cells; ++j) {
      const std::int32_t at = i * (cells + 1) + j;
      corners.insert(corners.end(), {at, at + cells + 1, at + cells + 2, at + 1, Mesh::kEndOfPolygon});
    }
  }
  return soup_of(std::move(vertices), std::move(corners), stretch);
}

// Cubes on every second place of a lattice, so that among lattice places all contacts are degenerate.
TriangleSoup cubes() {
  constexpr std::array<std::array<std::int32_t, 4>, 6> kSides = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::int32_t> corners;
  for (int cube = 0; cube < 27; cube += 2) {
    const auto first = static_cast<std::int32_t>(vertices.size());
    const Vec3 at(cube % 3 - 1, cube / 3 % 3 - 1, cube / 9 - 1);
    for (int i = 0; i < 8; ++i) {
      vertices.push_back((0.5 * (at + Vec3(i & 1, i >> 1 & 1, i >> 2))).cast<float>());
    }
    for (const auto& side : kSides) {
      for (const std::int32_t corner : side) corners.push_back(first + corner);
      corners.push_back(Mesh::kEndOfPolygon);
    }
  }
  return soup_of(std::move(vertices), std::move(corners), Mat3::Identity());
}

std::vector<TriangleSoup> soups() {
  Mat3 stretch;
  stretch << 1.1, 0.3, 0.0, 0.3, 0.8, -0.2, 0.0, -0.2, 1.7;
  std::vector<TriangleSoup> all;
  all.push_back(random_soup(500, 0.1, 50));
  all.push_back(random_soup(90, 0.7, 51));
  all.push_back(saddle(16, Mat3::Identity()));
  all.push_back(saddle(9, stretch));
  all.push_back(cubes());
  return all;
}

// Queries

template <int K>
struct KdopTrees {
  explicit KdopTrees(const std::vector<TriangleSoup>& soups) {
    for (std::size_t i = 0; i < soups.size(); ++i) {
      const SplitRule rule = kSplitRuleNames[(i + K) % kSplitRules].rule;
      trees.emplace_back(soups[i], TreeOptions{rule, static_cast<std::uint32_t>(1 + i * i)});
    }
  }
  void add(std::size_t a, std::size_t b, const RelativeMotion& a_from_b, Hash& hash) {
    PolygonPair pair{};
    hash.add(std::uint64_t{find_pair(trees[a], trees[b], a_from_b, counters, pair)});
    hash.add(pair);
    hash.add(all_pairs(trees[a], trees[b], a_from_b, counters));
  }
  std::vector<KdopTree<K>> trees;
  QueryCounters counters;
};

struct Trees {
  explicit Trees(const std::vector<TriangleSoup>& soups) : kdop6(soups), kdop14(soups), kdop18(soups), kdop26(soups) {
    for (const TriangleSoup& soup : soups) wide.emplace_back(soup);
  }
  void add(std::size_t a, std::size_t b, const RelativeMotion& a_from_b, Hash& hash) {
    hash.add(a_from_b);
    PolygonPair pair{};
    hash.add(std::uint64_t{query.find_pair(wide[a], wide[b], a_from_b, pair)});
    hash.add(pair);
    hash.add(query.all_pairs(wide[a], wide[b], a_from_b));
    kdop6.add(a, b, a_from_b, hash);
    kdop14.add(a, b, a_from_b, hash);
    kdop18.add(a, b, a_from_b, hash);
    kdop26.add(a, b, a_from_b, hash);
  }
  void add_counters(Hash& hash) const {
    for (const QueryCounters& counters :
         {query.counters(), kdop6.counters, kdop14.counters, kdop18.counters, kdop26.counters}) {
      hash.add(counters);
    }
  }

  std::vector<WideTree> wide;
  WideQuery query;
  KdopTrees<6> kdop6;
  KdopTrees<14> kdop14;
  KdopTrees<18> kdop18;
  KdopTrees<26> kdop26;
};

void add_scene(Hash& hash) {
  const std::vector<TriangleSoup> all = soups();
  Trees trees(all);
  Numbers numbers(52);
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = a; b < all.size(); ++b) {
      trees.add(a, b, RelativeMotion(Pose{}, Pose{}), hash);
      for (const double step : {0.5, 1.0, 1.5}) {
        trees.add(a, b, RelativeMotion(Pose{}, Pose{{step, -step, 0.0}, Quat::Identity()}), hash);
      }
      for (int i = 0; i < kPoses; ++i) {
        Pose here = random_pose(numbers, 1.0), there = random_pose(numbers, 1.0);
        if (i % 8 == 7) {  // far from the origin
          here.position += Vec3(1e5, -3e6, 7.0);
          there.position += Vec3(1e5, -3e6, 7.0);
        }
        trees.add(a, b, RelativeMotion(here, there), hash);
      }
    }
  }
  trees.add_counters(hash);
}

// Views

void add_rays(WideTree& tree, Numbers& numbers, RayQuery& query, Hash& hash) {
  const TriangleSoup& soup = tree.soup();
  for (int i = 0; i < 400; ++i) {
    const Triangle t =
        soup.triangle(static_cast<std::uint32_t>(numbers.unit() * static_cast<double>(soup.faces.size())));
    Ray ray{numbers.point(i % 3 == 0 ? 1e5 : 2.0), numbers.point(1.0)};
    if (i % 4 == 0) ray.direction = t[0] - ray.origin;
    if (i % 4 == 1) ray.direction = (t[0] / 2 + t[1] / 2) - ray.origin;
    if (i % 8 == 6) ray = {t[0] - 3 * (t[1] - t[0]), t[1] - t[0]};
    if (!is_usable(ray)) continue;
    const auto hit = query.nearest(tree, ray);
    hash.add(std::uint64_t{hit ? hit->face : ~0u});
    if (!hit) continue;
    hash.add(hit->t);
    for (int k = 0; k < 3; ++k) hash.add(hit->point[k]);
  }
}

void add_looks(WideTree& tree, Numbers& numbers, ViewQuery& query, Hash& hash) {
  for (int i = 0; i < 40; ++i) {
    Frustum frustum;
    for (int plane = 0; plane < 5; ++plane) {
      const Vec3 normal = numbers.point(1.0);
      hash.add(std::uint64_t{frustum.add(normal, numbers.between(-0.2, 1.0))});
    }
    for (const std::uint32_t face : query.faces_in_view(tree, random_pose(numbers, 0.5), frustum)) {
      hash.add(std::uint64_t{face});
    }
  }
}

}  // namespace

std::uint64_t view_hash() {
  Hash hash;
  Numbers numbers(53);
  RayQuery rays;
  ViewQuery views;
  for (const TriangleSoup& soup : soups()) {
    WideTree tree(soup);
    add_rays(tree, numbers, rays, hash);
    add_looks(tree, numbers, views, hash);
  }
  hash.add(rays.counters().bv_tests);
  hash.add(rays.counters().triangle_tests);
  hash.add(rays.counters().orientation);
  hash.add(rays.counters().orientation.quotients);
  hash.add(views.counters().plane_tests);
  return hash.value();
}

std::uint64_t scene_hash() {
  Hash hash;
  add_pairs(oracle::general(), hash);
  add_pairs(oracle::adversarial(), hash);
  add_scene(hash);
  return hash.value();
}

}  // namespace peerd::collision
