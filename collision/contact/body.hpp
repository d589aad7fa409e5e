#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "collision/contact/surface.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "core/scene/scene.hpp"

namespace peerd::collision {

// A convex piece of an object: a closed convex polyhedron, or one flat convex polygon. Object frame, binary64.
struct ConvexPiece {
  ObjectId shape;                                 // the Shape instance it comes from
  std::vector<Vec3> vertices;                     // [m]
  std::vector<Vec3> face_normals;                 // the unit outward normal of each polygon of the mesh
  std::vector<std::vector<std::uint32_t>> faces;  // vertex indices; faces[i] is polygon i of the mesh, in file order
  std::vector<Vec3> face_axes;                    // the distinct face normals, as separating-axis candidates
  std::vector<Vec3> edge_axes;                    // the distinct edge directions, unit
};

// The exact shape of a body that consists of one VRML Sphere, moved and evenly scaled; its polygons are not round.
struct ExactSphere {
  ObjectId shape;
  Vec3 center;      // object frame [m]
  double radius_m;  // > 0
};

// An object as collision sees it: everything below one node, in that node's rigid frame.
struct Body {
  ObjectId object;
  std::vector<ConvexPiece> pieces;    // depth-first order of their Shapes
  std::shared_ptr<Surface> surface;   // all polygons of all Shapes, convex or not; copies of a body share it
  std::optional<ExactSphere> sphere;  // contacts take the body for this
  Vec3 center = Vec3::Zero();         // centre of the bounding sphere, object frame [m]
  double radius_m = 0.0;              // encloses every vertex; 0 when there are none
  std::uint32_t meshes_built = 0;     // meshes tessellated for this body
  // Why not all of the body is convex pieces, naming the Shape and its reason; then queries use its surface. Empty when
  // all of it is.
  std::string not_convex_reason;
  // Why this body has no exact answer, naming the Shape and its reason; empty when it has one. Its hull or its box
  // never stands in for such a body.
  std::string unsupported;

  // No vertex is farther from the body's origin [m].
  [[nodiscard]] double extent_m() const { return magnitude(center) + radius_m; }
  // The vertices that polygons use, for collision type BOX; object frame [m].
  [[nodiscard]] std::span<const Vec3> vertices() const {
    return surface ? std::span(surface->soup().vertices) : std::span<const Vec3>();
  }
};

// Gathers the Shapes below `object`, or those of them that belong to it. It never fails: Body::unsupported names what
// has no exact answer.
using Belongs = std::function<bool(ObjectId shape)>;
[[nodiscard]] Body make_body(const Scene& scene, ObjectId object, const Belongs& belongs = {});

}  // namespace peerd::collision
