#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <variant>

#include "core/shared_array.hpp"

namespace peerd {

// The structs below are the geometry nodes of VRML97 that have surfaces, with the fields that shape them; the other
// nodes are stored by name only. A geometry is stored once however often it is USEd. Lengths are in metres, angles in
// radians. Two are equal where they share their arrays, as those of one node do before and after an edit of the scene.

struct BoxGeometry {
  std::array<float, 3> size = {2, 2, 2};
  friend bool operator==(const BoxGeometry&, const BoxGeometry&) = default;
};
struct SphereGeometry {
  float radius = 1;
  friend bool operator==(const SphereGeometry&, const SphereGeometry&) = default;
};
struct ConeGeometry {
  float bottom_radius = 1, height = 2;
  bool side = true, bottom = true;
  friend bool operator==(const ConeGeometry&, const ConeGeometry&) = default;
};
struct CylinderGeometry {
  float radius = 1, height = 2;
  bool side = true, top = true, bottom = true;
  friend bool operator==(const CylinderGeometry&, const CylinderGeometry&) = default;
};
struct ElevationGridGeometry {
  std::int32_t x_dimension = 0, z_dimension = 0;
  float x_spacing = 1, z_spacing = 1;
  SharedArray<float> height;  // x_dimension * z_dimension, row by row
  bool ccw = true;
  friend bool operator==(const ElevationGridGeometry&, const ElevationGridGeometry&) = default;
};
struct ExtrusionGeometry {
  SharedArray<std::array<float, 2>> cross_section;
  SharedArray<Eigen::Vector3f> spine;
  SharedArray<std::array<float, 2>> scale;        // one, or one for each spine point
  SharedArray<std::array<float, 4>> orientation;  // axis and angle; one, or one for each spine point
  bool begin_cap = true, end_cap = true, ccw = true;
  friend bool operator==(const ExtrusionGeometry&, const ExtrusionGeometry&) = default;
};
struct FaceSetGeometry {
  SharedArray<Eigen::Vector3f> points;
  SharedArray<std::int32_t> corners;  // coordIndex; every index but -1 is within `points`
  bool ccw = true;
  bool convex = true;  // the author's claim; the triangulation looks for itself
  friend bool operator==(const FaceSetGeometry&, const FaceSetGeometry&) = default;
};
// Lines, points and text have no surface to collide.
struct NoSurface {
  std::string_view type;  // the node's; a static string
  friend bool operator==(const NoSurface&, const NoSurface&) = default;
};

using Geometry = std::variant<BoxGeometry, SphereGeometry, ConeGeometry, CylinderGeometry, ElevationGridGeometry,
                              ExtrusionGeometry, FaceSetGeometry, NoSurface>;

// The fineness with which curved geometry is cut into polygons.
struct Tessellation {
  std::uint32_t slices = 24;  // around an axis, >= 3
  std::uint32_t stacks = 12;  // parts of a sphere from pole to pole, >= 2

  friend bool operator==(const Tessellation&, const Tessellation&) = default;
};

}  // namespace peerd
