#pragma once
#include <array>
#include <expected>
#include <string>
#include <vector>

#include "bench/peers/point.hpp"

namespace peerd::bench::peers {

// Centred in its box and scaled to a radius of 1; coordinates are binary32, so that no engine has to round them.
struct TriangleMesh {
  std::vector<Point> vertices;
  std::vector<std::array<int, 3>> triangles;
  double radius = 0;  // of a sphere around the origin
};

// `what`:
//   knot    a trefoil's tube with a wavy skin: concave, and close to others along much of its length
//   sphere  with two sorts of bumps
//   tree    of branches, open cones that pass through each other, with triangles five times as long as wide
//   FILE    .obj or .off; polygons are cut into fans
// `triangles` is about how many; a file has its own. The seed is the tree's.
[[nodiscard]] std::expected<TriangleMesh, std::string> make_triangle_mesh(const std::string& what, int triangles,
                                                                          unsigned seed);

}  // namespace peerd::bench::peers
