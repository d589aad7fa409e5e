#pragma once
#include "bench/peers/meshes.hpp"
#include "collision/exact/triangle_soup.hpp"

namespace peerd::bench::peers {

[[nodiscard]] inline collision::TriangleSoup soup_of(const TriangleMesh& mesh) {
  collision::TriangleSoup soup;
  soup.vertices.reserve(mesh.vertices.size());
  for (const Point& p : mesh.vertices) {
    soup.vertices.emplace_back(p.x, p.y, p.z);
    soup.box.merge(soup.vertices.back());
  }
  soup.faces.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) { return static_cast<std::uint32_t>(t[k]); };
    soup.faces.push_back({{corner(0), corner(1), corner(2)}, static_cast<std::uint32_t>(soup.faces.size())});
  }
  return soup;
}

}  // namespace peerd::bench::peers
