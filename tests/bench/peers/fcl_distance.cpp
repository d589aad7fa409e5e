#include "tests/bench/peers/fcl_distance.hpp"

#include <fcl/fcl.h>

#include <vector>

namespace peerd::bench::peers {

struct FclDistance::Model {
  fcl::BVHModel<fcl::OBBRSSd> tree;
};

FclDistance::~FclDistance() = default;
FclDistance::FclDistance(const TriangleMesh& mesh) : model_(std::make_unique<Model>()) {
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (const Point& p : mesh.vertices) vertices.emplace_back(p.x, p.y, p.z);
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) { return static_cast<std::size_t>(t[k]); };
    triangles.emplace_back(corner(0), corner(1), corner(2));
  }
  model_->tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  model_->tree.addSubModel(vertices, triangles);
  model_->tree.endModel();
}

double FclDistance::operator()(const Placement& a, const Placement& b, double relative) const {
  const auto transform = [](const Placement& placement) {
    fcl::Transform3d out = fcl::Transform3d::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) out.linear()(row, column) = placement.rotation[row][column];
    }
    out.translation() = fcl::Vector3d(placement.position.x, placement.position.y, placement.position.z);
    return out;
  };
  const fcl::DistanceRequestd request(/*enable_nearest_points_=*/true);
  fcl::DistanceResultd result;
  // As fcl::distance() does it, but that leaves the request's errors out (FCL 0.7). It stops where both are small
  // enough.
  fcl::detail::MeshDistanceTraversalNodeOBBRSSd traversal;
  fcl::detail::initialize(traversal, model_->tree, transform(a), model_->tree, transform(b), request, result);
  traversal.rel_err = relative;
  traversal.abs_err = relative > 0.0 ? 1e9 : 0.0;
  fcl::detail::distance(&traversal);
  return result.min_distance;
}

}  // namespace peerd::bench::peers
