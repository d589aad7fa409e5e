#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "collision/exact/relative_motion.hpp"
#include "collision/exact/triangle_soup.hpp"

namespace peerd::collision::engines {

// A box in a soup's frame: all center + sum of axes[i] * u_i with |u_i| <= half[i] [m]. Its half sides have room for
// the rounding of their own computation, so that it contains what it was made around.
struct Box {
  Vec3 center = Vec3::Zero(), half = Vec3::Zero();
  Mat3 orientation = Mat3::Identity();  // its columns are the axes

  // The axes, the longest first.
  [[nodiscard]] std::array<Vec3, 3> axes() const;
  [[nodiscard]] double size() const { return half.sum(); }
};

// The separating-axis test of two boxes (Gottschalk, Lin and Manocha 1996, section 5): three axes of each and the nine
// cross products of them. False is certain: all comparisons have room for their rounding.
class BoxTest {
 public:
  BoxTest(const RelativeMotion& a_from_b, double extent_a_m, double extent_b_m);
  [[nodiscard]] bool operator()(const Box& a, const Box& b) const;

 private:
  RelativeMotion a_from_b_;
  double room_m_;
};

// Oriented along the eigenvectors of the covariance of the triangles' area (the paper's section 4), as RAPID's are but
// for the convex hull that it takes first.
struct OrientedBox : Box {
  using Test = BoxTest;
  [[nodiscard]] static OrientedBox around(const TriangleSoup& soup, std::span<const std::uint32_t> faces);
};

// Along the axes of the soup's own frame (van den Bergen 1997).
struct AlignedBox : Box {
  using Test = BoxTest;
  [[nodiscard]] static AlignedBox around(const TriangleSoup& soup, std::span<const std::uint32_t> faces);
};

}  // namespace peerd::collision::engines
