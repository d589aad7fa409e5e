#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "collision/query/tree_query.hpp"
#include "collision/scene/narrow_phase.hpp"

namespace peerd::collision::engines {

// The solid cylinder around a soup, in the soup's frame: all points no farther than radius_m from the line through
// `center` along a direction, between low_m and high_m along it, as seen from `center`.
struct Cylinder {
  Vec3 center = Vec3::Zero();
  double radius_m = 0.0, low_m = 0.0, high_m = 0.0;
};
// The smallest one around a soup's triangles whose axis goes through the middle of the soup's box. `direction`: unit.
[[nodiscard]] Cylinder cylinder_around(const TriangleSoup& soup, const Vec3& direction);

// Whether a soup is terrain, such as an ElevationGrid: no vertical line enters below one triangle and leaves above
// another, since all of them face up, or all face down. `up`: unit, in the soup's frame.
[[nodiscard]] bool is_terrain(const TriangleSoup& soup, const Vec3& up);

enum class CylinderAxis : std::uint8_t {
  kWorld,  // measured along the world's +Y as the object stands: what touches is never missed
  kModel,  // measured along the Shape's own +Y, once: NPSNET's; a turned object reaches out of it
};

// NPSNET's way (Zyda, Osborne, Monahan and Pratt, "NPSNET: Large-scale virtual environment technology testbed", 1993;
// Pratt's thesis of 1993; Ohlenburg 2003, section 2.3): a Shape stands upright, along the world's +Y, as a cylinder.
// Two Shapes collide where
//   level 1: neither is higher above the ground than the other one is tall: the cylinders' heights overlap
//   level 2: their centres' distance in the ground plane is at most the sum of the radii
// NPSNET compares heights above the terrain at each vehicle's place. Here all heights are along the world's +Y from one
// origin, which comes to the same where both stand on the same ground, and holds on a slope as well.
//
// Terrain is what is_terrain() says. It collides with a cylinder where one of its triangles is below the circle, at a
// height that the plane of the triangle has there, between the cylinder's bottom and its top. What lies below a
// terrain is free. Two terrains are compared as cylinders.
//
// Errors: what is only near is taken for a touch, in the corners that a circle adds to a box, above a lower part of an
// object and below an overhang. With kWorld nothing is missed: the cylinder is measured anew whenever an object's own
// frame has turned against the vertical, and it has room for rounding. With kModel a Shape that pitches or rolls
// reaches out of its cylinder, and touches are missed there, as NPSNET missed them.
//
// The polygons that it names are no witnesses: a cylinder's is the first polygon of its Shape, a terrain's is the one
// that is under the circle. Each Shape of an object has a cylinder of its own.
class CylinderQuery : public NarrowPhase {
 public:
  explicit CylinderQuery(CylinderAxis axis) : axis_(axis) {}

  bool find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                 PolygonPair& pair) override;
  std::vector<PolygonPair> all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                     const RelativeMotion& a_from_b) override;
  // bv_tests: comparisons of two cylinders, and of a cylinder and a terrain's triangle.
  [[nodiscard]] const QueryCounters& counters() const override { return counters_; }

 private:
  struct Measured {
    Vec3 direction = Vec3::Zero();  // along which it was measured, in the soup's frame
    Cylinder cylinder;
    bool is_terrain = false;
  };
  // Soups whose vertices move get a new number each time; what is known of old ones is dropped together.
  static constexpr std::size_t kMeasuredMax = 4096;

  [[nodiscard]] Measured measured(const NumberedSoup& of, const Vec3& up);
  template <class Found>
  bool search(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b, Found found);

  CylinderAxis axis_;
  std::map<std::uint64_t, Measured> measured_;  // by a soup's number
  QueryCounters counters_;
};

}  // namespace peerd::collision::engines
