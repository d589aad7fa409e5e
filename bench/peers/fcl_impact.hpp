#pragma once
#include <memory>
#include <optional>

#include "bench/peers/meshes.hpp"

namespace peerd::bench::peers {

// fcl::continuousCollide() of two copies of a mesh, on hierarchies of OBBRSS, as Debian has compiled it. Positions and
// orientations are interpolated.
class FclImpact {
 public:
  explicit FclImpact(const TriangleMesh& mesh);
  ~FclImpact();
  struct Way {
    Placement from, to;
  };
  // When they touch, in parts of the ways, [0, 1]; nothing: never.
  [[nodiscard]] std::optional<double> advance(const Way& a, const Way& b) const;               // conservatively
  [[nodiscard]] std::optional<double> sample(const Way& a, const Way& b, int instants) const;  // "naive"

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace peerd::bench::peers
