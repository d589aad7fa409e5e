#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "collision/exact/relative_motion.hpp"
#include "collision/exact/triangle_soup.hpp"

namespace peerd::collision::engines {

// A sphere of a sphere tree (Hubbard, "Approximating polyhedra with spheres for time-critical collision detection",
// ACM Transactions on Graphics 15(3), 1996): spheres alone answer, so what is near may be taken for a touch, and what
// touches is never missed. It is around the box of its triangles; Hubbard fits his to the medial axis.
struct Sphere {
  Vec3 center = Vec3::Zero();
  double radius_m = 0.0;  // with room for rounding
  Vec3 box_half = Vec3::Zero();

  // True where two spheres overlap, or may.
  class Test {
   public:
    Test(const RelativeMotion& a_from_b, double extent_a_m, double extent_b_m);
    [[nodiscard]] bool operator()(const Sphere& a, const Sphere& b) const {
      return !((a_from_b_(b.center) - a.center).norm() > a.radius_m + b.radius_m + room_m_);
    }

   private:
    RelativeMotion a_from_b_;
    double room_m_;
  };

  [[nodiscard]] static Sphere around(const TriangleSoup& soup, std::span<const std::uint32_t> faces);
  [[nodiscard]] std::array<Vec3, 3> axes() const;
};

}  // namespace peerd::collision::engines
