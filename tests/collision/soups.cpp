#include "tests/collision/soups.hpp"

#include "collision/exact/triangle_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace peerd::collision {
namespace {

Vec3 rounded(const Vec3& p) { return p.cast<float>().cast<double>(); }

}  // namespace

TriangleSoup random_soup(std::uint32_t triangles, double size, std::uint64_t seed) {
  Numbers numbers(seed);
  TriangleSoup soup;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    const Vec3 center = numbers.point(1.0);
    for (int corner = 0; corner < 3; ++corner) soup.vertices.push_back(rounded(center + numbers.point(size)));
    if (t % 37 == 36) soup.vertices[first + 2] = soup.vertices[first];                 // a segment
    if (t % 41 == 40) std::fill_n(soup.vertices.begin() + first, 3, rounded(center));  // a point
    soup.faces.push_back({{first, first + 1, first + 2}, t});
    if (t % 43 == 42) soup.faces.back().corners = soup.faces[t / 2].corners;  // again
  }
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t c : face.corners) soup.box.merge(soup.vertices[c]);
  }
  return soup;
}

TriangleSoup torus(std::uint32_t around, std::uint32_t along, bool quads) {
  TriangleSoup soup;
  for (std::uint32_t i = 0; i < along; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const double u = 2.0 * std::numbers::pi * i / along, v = 2.0 * std::numbers::pi * j / around;
      const double r = 0.7 + 0.3 * std::cos(v);
      soup.vertices.push_back(rounded({r * std::cos(u), r * std::sin(u), 0.3 * std::sin(v)}));
      soup.box.merge(soup.vertices.back());
      const auto at = [&](std::uint32_t di, std::uint32_t dj) { return (i + di) % along * around + (j + dj) % around; };
      const auto polygon = static_cast<std::uint32_t>(soup.faces.size());
      soup.faces.push_back({{at(0, 0), at(1, 0), at(1, 1)}, quads ? polygon / 2 : polygon});
      soup.faces.push_back({{at(0, 0), at(1, 1), at(0, 1)}, quads ? polygon / 2 : polygon + 1});
    }
  }
  return soup;
}

TriangleSoup closed_box(const Vec3& half, const Vec3& center) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    soup.vertices.push_back(center + sign.cwiseProduct(half));
  }
  constexpr std::uint32_t kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (std::uint32_t i = 0; i < 6; ++i) {
    const auto& side = kSides[i];
    soup.faces.push_back({{side[0], side[1], side[2]}, i});
    soup.faces.push_back({{side[0], side[2], side[3]}, i});
  }
  find_box(soup);
  return soup;
}

TriangleSoup half_space() {
  constexpr double m = std::numeric_limits<float>::max();
  TriangleSoup soup;
  soup.vertices = {{-m, -m, 0}, {m, -m, 0}, {m, m, 0}, {-m, m, 0}, {-m, -m, -m}, {m, -m, -m}, {m, m, -m}, {-m, m, -m}};
  for (const auto& corners :
       {std::array{0u, 1u, 2u}, {0u, 2u, 3u}, {4u, 6u, 5u}, {4u, 7u, 6u}, {0u, 5u, 1u}, {2u, 7u, 3u}}) {
    soup.faces.push_back({corners, static_cast<std::uint32_t>(soup.faces.size())});
  }
  find_box(soup);
  return soup;
}

void find_box(TriangleSoup& soup) {
  soup.box = {};
  for (const Vec3& v : soup.vertices) soup.box.merge(v);
}

Pose random_pose(Numbers& numbers, double distance) {
  const Vec3 axis = numbers.point(1.0);
  const double w = numbers.between(-1.0, 1.0);
  return {numbers.point(distance), normalized(Quat(w, axis[0], axis[1], axis[2]))};
}

std::vector<PolygonPair> brute_force(const TriangleSoup& a, const TriangleSoup& b, const RelativeMotion& a_from_b) {
  std::vector<PolygonPair> pairs;
  OrientationCounters counters;
  for (std::uint32_t j = 0; j < b.faces.size(); ++j) {
    const Triangle t = b.triangle(j);
    const Triangle moved = {a_from_b(t[0]), a_from_b(t[1]), a_from_b(t[2])};
    for (std::uint32_t i = 0; i < a.faces.size(); ++i) {
      if (touch(a.triangle(i), moved, counters)) pairs.push_back({a.faces[i].polygon, b.faces[j].polygon});
    }
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace peerd::collision
