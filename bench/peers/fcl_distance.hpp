#pragma once
#include <memory>

#include "bench/peers/meshes.hpp"

namespace peerd::bench::peers {

// FCL's distance of two copies of a mesh, on hierarchies of OBBRSS, as Debian has compiled it.
class FclDistance {
 public:
  explicit FclDistance(const TriangleMesh& mesh);
  ~FclDistance();
  // Its answer, which is 0 or less where they touch. `relative`: what it may be off by, in parts of it.
  [[nodiscard]] double operator()(const Placement& a, const Placement& b, double relative) const;

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace peerd::bench::peers
