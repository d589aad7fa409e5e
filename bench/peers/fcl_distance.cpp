#include "bench/peers/fcl_distance.hpp"

#include "bench/peers/fcl_mesh.hpp"

namespace peerd::bench::peers {

struct FclDistance::Model {
  fcl::BVHModel<fcl::OBBRSSd> tree;
};

FclDistance::~FclDistance() = default;
FclDistance::FclDistance(const TriangleMesh& mesh) : model_(std::make_unique<Model>()) { build(mesh, model_->tree); }

double FclDistance::operator()(const Placement& a, const Placement& b, double relative) const {
  const fcl::DistanceRequestd request(/*enable_nearest_points_=*/true);
  fcl::DistanceResultd result;
  // The same as fcl::distance(), which leaves the request's errors out (FCL 0.7). It stops where both are small enough.
  fcl::detail::MeshDistanceTraversalNodeOBBRSSd traversal;
  fcl::detail::initialize(traversal, model_->tree, transform(a), model_->tree, transform(b), request, result);
  traversal.rel_err = relative;
  traversal.abs_err = relative > 0.0 ? 1e9 : 0.0;
  fcl::detail::distance(&traversal);
  return result.min_distance;
}

}  // namespace peerd::bench::peers
