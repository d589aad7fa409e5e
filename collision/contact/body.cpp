#include "collision/contact/body.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/exact/convexity.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "core/geometry/tessellate.hpp"

namespace peerd::collision {
namespace {

// Affine map from a Shape's frame into the object's. The identity keeps the parsed binary32 values.
struct Placement {
  Mat3 linear;
  Vec3 offset;
  Mat3 cofactor;  // maps normals: det * linear^-T
  double determinant;

  explicit Placement(const Eigen::Affine3d& object_from_shape)
      : linear(object_from_shape.linear()), offset(object_from_shape.translation()) {
    cofactor.col(0) = linear.col(1).cross(linear.col(2));
    cofactor.col(1) = linear.col(2).cross(linear.col(0));
    cofactor.col(2) = linear.col(0).cross(linear.col(1));
    determinant = dot(linear.col(0), cofactor.col(0));
  }

  [[nodiscard]] Vec3 point(const Eigen::Vector3f& p) const { return rotate(linear, p.cast<double>()) + offset; }
};

// Affine maps keep convexity, parallels and which side is which, so what was decided on the parsed vertices stands.
// Normals and edge directions come from the exact ones, not from rounded vertices: a sliver's are as good as a cube's.
ConvexPiece place(const ConvexSurface& surface, ObjectId shape, const Placement& placement) {
  const bool mirrored = placement.determinant < 0.0;
  ConvexPiece piece;
  piece.shape = shape;
  for (const Eigen::Vector3f& v : surface.vertices) piece.vertices.push_back(placement.point(v));
  for (const Vec3& n : surface.normals) {
    const Vec3 mapped = unit(rotate(placement.cofactor, n));
    piece.face_normals.push_back(mirrored ? Vec3(-mapped) : mapped);
  }
  piece.faces = surface.polygons;
  if (mirrored) {
    for (std::vector<std::uint32_t>& face : piece.faces) std::reverse(face.begin() + 1, face.end());
  }
  assert(piece.face_normals.size() == piece.faces.size());
  for (const std::uint32_t polygon : surface.face_axes) piece.face_axes.push_back(piece.face_normals[polygon]);
  for (const auto& [a, b] : surface.edge_axes) {
    const Vec3 edge = surface.vertices[b].cast<double>() - surface.vertices[a].cast<double>();
    piece.edge_axes.push_back(unit(rotate(placement.linear, edge)));
  }
  return piece;
}

// The middle of the vertices' box and the farthest vertex from it: for a box of any orientation its centre and half
// its diagonal; at worst sqrt(3) times the least sphere.
void enclose(Body& body) {
  const WorldBox& box = body.surface->soup().box;
  if (box.is_empty()) return;
  body.center = 0.5 * box.lo + 0.5 * box.hi;
  double radius2 = 0.0;
  for (const Vec3& v : body.vertices()) radius2 = std::max(radius2, dot(v - body.center, v - body.center));
  body.radius_m = std::sqrt(radius2);
  assert(!(body.radius_m < 0.0));
}

// A Sphere stays exactly round only where its transform is a translation and one scale: a rounded rotation can't be
// told from a shear.
std::optional<ExactSphere> as_exact_sphere(const Geometry& geometry, ObjectId shape, const Placement& placement) {
  const auto* const sphere = std::get_if<SphereGeometry>(&geometry);
  const double scale = placement.linear(0, 0);
  if (sphere == nullptr || !(scale > 0.0) || placement.linear != Mat3(scale * Mat3::Identity())) return std::nullopt;
  return ExactSphere{shape, placement.offset, scale * static_cast<double>(sphere->radius)};
}

// Collects reasons into one sentence: the first, and how many more there are.
class Reasons {
 public:
  Reasons(const Scene& scene, std::string& out) : scene_(scene), out_(out) {}
  ~Reasons() {
    if (count_ > 1) out_ += " (and " + std::to_string(count_ - 1) + " more)";
  }
  void add(ObjectId shape, const std::string& why) {
    if (count_++ == 0) out_ = scene_.path_of(shape) + ": " + why;
  }

 private:
  const Scene& scene_;
  std::string& out_;
  std::size_t count_ = 0;
};

}  // namespace

Body make_body(const Scene& scene, ObjectId object, const Belongs& belongs) {
  Body body;
  body.object = object;
  body.surface = std::make_shared<Surface>();
  {
    std::size_t shapes = 0;
    Reasons not_convex_reason(scene, body.not_convex_reason), unsupported(scene, body.unsupported);
    for (std::uint32_t i = scene.index_of(object); i < scene.at(object).subtree_end; ++i) {
      const ObjectId shape = scene.id_of(i);
      const Geometry* const geometry = scene.geometry(shape);
      if (geometry == nullptr || !scene.at(shape).collides || (belongs && !belongs(shape))) continue;
      const Mesh mesh = build_mesh(*geometry, scene.tessellation);
      ++body.meshes_built;
      if (mesh.polygon_count() == 0) continue;
      const Placement placement(scene.object_from_shape(object, shape));
      body.sphere = ++shapes == 1 ? as_exact_sphere(*geometry, shape, placement) : std::nullopt;
      const auto placed =
          body.surface->append(shape, mesh, [&](const Eigen::Vector3f& p) { return placement.point(p); });
      if (!placed) {
        unsupported.add(shape, placed.error());
      } else if (placement.determinant == 0.0) {
        not_convex_reason.add(shape, "its transform leaves no volume");
      } else if (const auto surface = convex_surface(mesh)) {
        body.pieces.push_back(place(*surface, shape, placement));
      } else {
        not_convex_reason.add(shape, surface.error());
      }
    }
  }
  enclose(body);
  return body;
}

}  // namespace peerd::collision
