#pragma once
#include <fcl/fcl.h>

#include <vector>

#include "bench/peers/meshes.hpp"

namespace peerd::bench::peers {

// A mesh on a hierarchy of OBBRSS, and a place, as FCL has them.
inline void build(const TriangleMesh& mesh, fcl::BVHModel<fcl::OBBRSSd>& tree) {
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (const Point& p : mesh.vertices) vertices.emplace_back(p.x, p.y, p.z);
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) { return static_cast<std::size_t>(t[k]); };
    triangles.emplace_back(corner(0), corner(1), corner(2));
  }
  tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  tree.addSubModel(vertices, triangles);
  tree.endModel();
}

inline fcl::Transform3d transform(const Placement& placement) {
  fcl::Transform3d out = fcl::Transform3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.linear()(row, column) = placement.rotation[row][column];
  }
  out.translation() = fcl::Vector3d(placement.position.x, placement.position.y, placement.position.z);
  return out;
}

}  // namespace peerd::bench::peers
