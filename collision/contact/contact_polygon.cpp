#include "collision/contact/contact_polygon.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

namespace peerd::collision {
namespace {

// The indices of the vertices farthest along n, to within e [m].
std::vector<std::uint32_t> support_feature(const Solid& solid, const Vec3& n_body, double e) {
  const double top = extent_along(n_body, solid.vertices).high;
  std::vector<std::uint32_t> feature;
  for (std::uint32_t i = 0; i < solid.vertices.size(); ++i) {
    if (dot(n_body, solid.vertices[i]) >= top - e) feature.push_back(i);
  }
  return feature;
}

bool contains_all(const std::vector<std::uint32_t>& face, const std::vector<std::uint32_t>& feature) {
  return std::ranges::all_of(feature, [&](std::uint32_t v) { return std::ranges::find(face, v) != face.end(); });
}

}  // namespace

std::int64_t face_along(const Solid& collidee, const Mat3& R, const Vec3& n_world) {
  if (collidee.piece == nullptr) return -1;
  const std::vector<Vec3>& normals = collidee.piece->face_normals;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3 face = rotate(R, normals[i]);
    if (same_direction(face, n_world) || (normals.size() == 1 && same_direction(-face, n_world))) {
      return static_cast<std::int64_t>(i);
    }
  }
  return -1;
}

void set_contact_polygon(Contact& contact, const Solid& collidee, const Mat3& R, const Vec3& n_world,
                         const Vec3& velocity, double e) {
  assert(!(std::abs(dot(n_world, n_world) - 1.0) > 1e-9) && !(e < 0.0));
  contact.collidee_shape = collidee.shape;
  contact.collidee_polygon = 0;
  contact.normal_world = contact.separating_normal_world = n_world;
  if (collidee.piece == nullptr) return;
  const ConvexPiece& piece = *collidee.piece;
  const bool flat = piece.faces.size() == 1;
  assert(piece.face_normals.size() == piece.faces.size());
  if (const std::int64_t face = face_along(collidee, R, n_world); face >= 0) {
    const Vec3 normal = rotate(R, piece.face_normals[static_cast<std::size_t>(face)]);
    contact.collidee_polygon = static_cast<std::uint32_t>(face);
    contact.normal_world = contact.separating_normal_world = dot(normal, n_world) < 0.0 ? Vec3(-normal) : normal;
    return;
  }
  const std::vector<std::uint32_t> feature = support_feature(collidee, rotate_back(R, n_world), e);
  bool any_adjacent = false;
  for (std::uint32_t i = 0; i < piece.faces.size(); ++i) {
    if (!contains_all(piece.faces[i], feature)) continue;
    if (!any_adjacent) contact.collidee_polygon = i;
    any_adjacent = true;
    const Vec3 normal = rotate(R, piece.face_normals[i]);
    const double against = dot(normal, velocity);
    if (against < 0.0 || (flat && against > 0.0)) {
      contact.collidee_polygon = i;
      contact.normal_world = against < 0.0 ? normal : Vec3(-normal);
      return;
    }
  }
}

}  // namespace peerd::collision
