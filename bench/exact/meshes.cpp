#include "bench/exact/meshes.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "bench/polygon_mesh.hpp"
#include "collision/query/wide_query.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::bench::exact {
namespace {

using namespace collision;

std::expected<TriangleSoup, std::string> soup_of(const std::string& path) {
  const auto file = read_polygon_file(path);
  if (!file) return std::unexpected(file.error());
  return make_soup(mesh_of(*file));
}

// The corner of a face that is farthest in that direction: surfaces that only meet there do no more than touch.
Vec3 support(const TriangleSoup& soup, const Vec3& direction) {
  const Vec3* best = nullptr;
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t c : face.corners) {
      const Vec3& v = soup.vertices[c];
      if (best == nullptr || v.dot(direction) > best->dot(direction)) best = &v;
    }
  }
  return *best;
}

RelativeMotion moved(const Mat3& rotation, const Vec3& translation) {
  RelativeMotion motion{Pose{}, Pose{}};
  motion.rotation = rotation;
  motion.translation = translation;
  return motion;
}

// The difference of two binary32 numbers is nearly always one of binary64, and then the two corners coincide.
RelativeMotion support_on_support(const TriangleSoup& a, const TriangleSoup& b, const Mat3& rotation,
                                  const Vec3& direction) {
  const Vec3 there = rotation * support(b, -(rotation.transpose() * direction));
  return moved(rotation, support(a, direction) - there);
}

RelativeMotion somehow(const TriangleSoup& a, const TriangleSoup& b, Numbers& numbers) {
  const Vec3 center_a = 0.5 * (a.box.lo + a.box.hi), center_b = 0.5 * (b.box.lo + b.box.hi);
  const double size = 0.5 * std::max((a.box.hi - a.box.lo).norm(), (b.box.hi - b.box.lo).norm());
  const Mat3 rotation = random_pose(numbers, 0.0).orientation.toRotationMatrix();
  return moved(rotation, center_a - rotation * center_b + size * numbers.point(0.6));
}

class Checker {
 public:
  Checker(MeshResult& result, std::uint32_t& number) : result_(result), number_(number) {}

  void check(const TriangleSoup& a, const TriangleSoup& b, const RelativeMotion& a_from_b) {
    const std::vector<PolygonPair> expected = brute_force(a, b, a_from_b);
    ++result_.poses;
    result_.touching += !expected.empty();
    result_.pairs += expected.size();
    check_wide(a, b, a_from_b, expected);
    check_kdop<6>(a, b, a_from_b, expected);
    check_kdop<14>(a, b, a_from_b, expected);
    check_kdop<18>(a, b, a_from_b, expected);
    check_kdop<26>(a, b, a_from_b, expected);
  }

 private:
  static bool one_of(const std::vector<PolygonPair>& expected, bool found, const PolygonPair& pair) {
    return found ? std::ranges::binary_search(expected, pair) : expected.empty();
  }

  void check_wide(const TriangleSoup& a, const TriangleSoup& b, const RelativeMotion& a_from_b,
                  const std::vector<PolygonPair>& expected) {
    PolygonPair pair{};
    WideTree lazy_a(a), lazy_b(b);
    const bool found = query_.find_pair(lazy_a, lazy_b, a_from_b, pair);
    result_.wrong += !one_of(expected, found, pair);
    WideTree whole_a(a), whole_b(b);
    whole_a.build_all();
    whole_b.build_all();
    result_.wrong += query_.all_pairs(lazy_a, lazy_b, a_from_b) != expected;
    result_.wrong += query_.all_pairs(whole_a, whole_b, a_from_b) != expected;
    result_.wide_queries += 3;
  }

  template <int K>
  void check_kdop(const TriangleSoup& a, const TriangleSoup& b, const RelativeMotion& a_from_b,
                  const std::vector<PolygonPair>& expected) {
    constexpr std::uint32_t kThresholds[] = {1, 2, 4, 10, 50};
    const TreeOptions options = {kSplitRuleNames[number_ % kSplitRules].rule,
                                 kThresholds[number_ / kSplitRules % std::size(kThresholds)]};
    ++number_;
    KdopTree<K> tree_a(a, options), tree_b(b, options);
    QueryCounters counters;
    PolygonPair pair{};
    const bool found = find_pair(tree_a, tree_b, a_from_b, counters, pair);
    result_.wrong += !one_of(expected, found, pair);
    result_.wrong += all_pairs(tree_a, tree_b, a_from_b, counters) != expected;
    result_.kdop_queries += 2;
  }

  MeshResult& result_;
  std::uint32_t& number_;
  WideQuery query_;
};

}  // namespace

std::vector<NamedSoup> read_soups(const std::string& folder, std::size_t most) {
  std::set<std::filesystem::path> paths;  // in an order that is the same everywhere
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const auto extension = entry.path().extension();
    if (extension == ".obj" || extension == ".off") paths.insert(entry.path());
  }
  if (error) std::fprintf(stderr, "warning: no meshes in %s: %s\n", folder.c_str(), error.message().c_str());
  std::vector<NamedSoup> soups;
  for (const auto& path : paths) {
    const auto soup = soup_of(path.string());
    if (!soup) {
      std::fprintf(stderr, "warning: %s: %s\n", path.filename().c_str(), soup.error().c_str());
    } else if (!soup->faces.empty() && soup->faces.size() <= most) {
      soups.push_back({path.stem().string(), *soup});
    }
  }
  return soups;
}

MeshResult check_mesh(const NamedSoup& a, const NamedSoup& b, std::uint64_t seed, std::uint32_t& number) {
  MeshResult result{.name = a.name};
  result.triangles = a.soup.faces.size();
  result.polygons = a.soup.faces.back().polygon + std::size_t{1};
  Checker checker(result, number);
  Numbers numbers(seed);
  const TriangleSoup& itself = a.soup;
  const Mat3 identity = Mat3::Identity();
  Mat3 quarter;  // about z; without rounding
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  checker.check(itself, itself, RelativeMotion(Pose{}, Pose{}));
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1)}) {
    checker.check(itself, itself, support_on_support(itself, itself, identity, direction));
    checker.check(itself, itself, support_on_support(itself, itself, quarter, direction));
    checker.check(itself, b.soup, support_on_support(itself, b.soup, identity, direction));
  }
  checker.check(itself, itself, moved(quarter, Vec3::Zero()));
  // One edge's length along that edge: where a mesh is regular, much coincides.
  const Triangle t = itself.triangle(0);
  checker.check(itself, itself, moved(identity, t[1] - t[0]));
  for (int i = 0; i < 4; ++i) {
    checker.check(itself, itself, somehow(itself, itself, numbers));
    checker.check(itself, b.soup, somehow(itself, b.soup, numbers));
  }
  return result;
}

}  // namespace peerd::bench::exact
