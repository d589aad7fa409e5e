#include "bench/peers/fcl_impact.hpp"

#include "bench/peers/fcl_mesh.hpp"

namespace peerd::bench::peers {

struct FclImpact::Model {
  fcl::BVHModel<fcl::OBBRSSd> tree;

  [[nodiscard]] std::optional<double> ask(const Way& a, const Way& b, const fcl::ContinuousCollisionRequestd& request) {
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(&tree, transform(a.from), transform(a.to), &tree, transform(b.from), transform(b.to),
                           request, result);
    return result.is_collide ? std::optional(result.time_of_contact) : std::nullopt;
  }
};

FclImpact::~FclImpact() = default;
FclImpact::FclImpact(const TriangleMesh& mesh) : model_(std::make_unique<Model>()) { build(mesh, model_->tree); }

std::optional<double> FclImpact::advance(const Way& a, const Way& b) const {
  return model_->ask(a, b,
                     {/*num_max_iterations_=*/1000, /*toc_err_=*/1e-6, fcl::CCDM_LINEAR, fcl::GST_LIBCCD,
                      fcl::CCDC_CONSERVATIVE_ADVANCEMENT});
}

std::optional<double> FclImpact::sample(const Way& a, const Way& b, int instants) const {
  return model_->ask(
      a, b,
      {static_cast<std::size_t>(instants), /*toc_err_=*/1e-6, fcl::CCDM_LINEAR, fcl::GST_LIBCCD, fcl::CCDC_NAIVE});
}

}  // namespace peerd::bench::peers
