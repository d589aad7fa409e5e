#include "collision/contact/mesh_contact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/overlap_depth.hpp"
#include "collision/exact/triangle_distance.hpp"
#include "collision/query/time_of_impact.hpp"

namespace peerd::collision {
namespace {

// These keep memory between calls, never values.
thread_local MeshImpactQuery contact_impacts;
thread_local WideQuery near_query;

void set_polygon(Contact& contact, const Surface& collidee, std::uint32_t polygon_of_soup) {
  const ShapePolygon polygon = collidee.polygon(polygon_of_soup);
  contact.collidee_shape = polygon.shape;
  contact.collidee_polygon = polygon.polygon;
}

// The direction between two places that are a micrometre apart is known to less than this (a cosine): one that is the
// normal of a polygon but for that is the normal.
constexpr double kSameDirection = 1.0 - 0x1p-24;
// Triangles nearer than this part of their coordinates do not tell on which side of each other they are.
constexpr double kRoundingOfSide = 0x1p-40;

// The velocity of the collider's material against the collidee's at a place of the world [m/s].
Vec3 approach_velocity(const KinematicState& a, const KinematicState& b, const Vec3& place) {
  const auto velocity = [&](const KinematicState& s) {
    const Vec3 turn = rotate(s.orientation.toRotationMatrix(), s.angular_velocity_body);
    return Vec3(s.velocity + turn.cross(place - s.position));
  };
  return velocity(a) - velocity(b);
}

// The normal of the collidee's polygon on the side of the collider, for two near triangles, if the collider comes
// towards that polygon.
std::optional<Vec3> approached_normal(const Contact& contact, const Surface& collider, const KinematicState& a,
                                      const Surface& collidee, const KinematicState& b, const RelativeMotion& a_from_b,
                                      const FacePair& faces) {
  const Triangle in_b = collidee.soup().triangle(faces.b);
  const Triangle of_b = {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])};
  const TriangleDistance gap = triangle_distance(collider.soup().triangle(faces.a), of_b);
  const auto normal = collidee.normal(collidee.soup().faces[faces.b].polygon);
  const double places = sum_of_magnitudes(a.position, b.position) + length(gap.on_a) + length(a_from_b.translation);
  if (!normal || gap.distance <= kRoundingOfSide * places) return std::nullopt;
  const Mat3 R_a = a.orientation.toRotationMatrix();
  Vec3 n = rotate(b.orientation.toRotationMatrix(), *normal);
  // The side of the polygon on which the collider is; beside the polygon it is on neither.
  const double side = dot(n, rotate(R_a, gap.on_a - gap.on_b)) / gap.distance;
  assert(gap.distance > 0.0);
  if (std::abs(side) < 0x1p-10) return std::nullopt;
  if (side < 0.0) n = -n;
  const Vec3 approach_direction = contact.resting ? Vec3(a.acceleration - b.acceleration)
                                                  : approach_velocity(a, b, rotate(R_a, gap.on_a) + a.position);
  if (dot(n, approach_direction) >= -0x1p-30 * length(approach_direction)) return std::nullopt;
  return n;
}

// Sets polygon and normal by the least pair of polygons that meets; false where none does.
bool find_approached_polygon(Contact& contact, Surface& collider, const KinematicState& a, Surface& collidee,
                             const KinematicState& b, double tolerance_m) {
  const RelativeMotion a_from_b(a.pose(), b.pose());
  std::optional<PolygonPair> least;
  for (const FacePair& faces : near_query.faces_within(collider.tree(), collidee.tree(), a_from_b, 2.0 * tolerance_m)) {
    const PolygonPair pair{collider.soup().faces[faces.a].polygon, collidee.soup().faces[faces.b].polygon};
    if (least && !(pair < *least)) continue;
    const auto normal = approached_normal(contact, collider, a, collidee, b, a_from_b, faces);
    if (!normal) continue;
    least = pair;
    set_polygon(contact, collidee, pair.b);
    contact.normal_world = *normal;
  }
  return least.has_value();
}

void set_hit_polygon(Contact& contact, const MovingBody& collider, const MovingBody& collidee, const MeshImpact& impact,
                     double tolerance_m) {
  const KinematicState a = advance(collider.motion, impact.time_s), b = advance(collidee.motion, impact.time_s);
  contact.separating_normal_world = -impact.direction;
  if (find_approached_polygon(contact, *collider.body.surface, a, *collidee.body.surface, b, tolerance_m)) {
    if (dot(contact.normal_world, contact.separating_normal_world) > kSameDirection) {
      contact.separating_normal_world = contact.normal_world;
    }
    return;
  }
  set_polygon(contact, *collidee.body.surface, impact.pair.b);
  contact.normal_world = -impact.direction;
}

void set_overlap_polygon(Contact& contact, const MovingBody& collider, const MovingBody& collidee) {
  Surface &a = *collider.body.surface, &b = *collidee.body.surface;
  const RelativeMotion a_from_b(collider.motion.pose(), collidee.motion.pose());
  const auto& pairs = near_query.all_pairs(a.tree(), b.tree(), a_from_b);
  assert(!pairs.empty());
  set_polygon(contact, b, pairs.front().b);
  const Mat3 R_a = collider.motion.orientation.toRotationMatrix(), R_b = collidee.motion.orientation.toRotationMatrix();
  const Vec3 middle = collider.motion.position + rotate(R_a, collider.body.center);
  const Vec3 other_middle = collidee.motion.position + rotate(R_b, collidee.body.center);
  if (const auto normal = b.normal(pairs.front().b)) {
    const auto first = std::ranges::lower_bound(b.soup().faces, pairs.front().b, {}, &TriangleSoup::Face::polygon);
    const Vec3 corner = collidee.motion.position + rotate(R_b, b.soup().vertices[first->corners[0]]);
    const Vec3 n = rotate(R_b, *normal);
    contact.normal_world = contact.separating_normal_world = dot(n, middle - corner) < 0.0 ? Vec3(-n) : n;
    return;
  }
  const Vec3 apart = middle - other_middle;  // a polygon without an area faces nowhere
  contact.normal_world = contact.separating_normal_world = length(apart) > 0.0 ? unit(apart) : Vec3::UnitY();
}

}  // namespace

double touch_depth_m(const MovingBody& a, const MovingBody& b) {
  const RelativeMotion a_from_b(a.motion.pose(), b.motion.pose());
  Surface &of_a = *a.body.surface, &of_b = *b.body.surface;
  PolygonPair pair{};
  if (of_a.soup().faces.empty() || of_b.soup().faces.empty()) return 0.0;
  if (!near_query.find_pair(of_a.tree(), of_b.tree(), a_from_b, pair)) return 0.0;
  const auto faces_of = [](const TriangleSoup& soup, std::uint32_t polygon) {
    return std::ranges::equal_range(soup.faces, polygon, {}, &TriangleSoup::Face::polygon);
  };
  double deepest = 0.0;
  for (const TriangleSoup::Face& face_b : faces_of(of_b.soup(), pair.b)) {
    const auto& c = face_b.corners;
    const auto& v = of_b.soup().vertices;
    const Triangle in_a = {a_from_b(v[c[0]]), a_from_b(v[c[1]]), a_from_b(v[c[2]])};
    for (const TriangleSoup::Face& face_a : faces_of(of_a.soup(), pair.a)) {
      const auto index = static_cast<std::uint32_t>(&face_a - of_a.soup().faces.data());
      deepest = std::max(deepest, overlap_depth_m(of_a.soup().triangle(index), in_a));
    }
  }
  return deepest;
}

bool different_shapes_touch(const MovingBody& a, const MovingBody& b) {
  Surface &of_a = *a.body.surface, &of_b = *b.body.surface;
  if (of_a.soup().faces.empty() || of_b.soup().faces.empty()) return false;
  const RelativeMotion a_from_b(a.motion.pose(), b.motion.pose());
  return std::ranges::any_of(near_query.all_pairs(of_a.tree(), of_b.tree(), a_from_b), [&](const PolygonPair& pair) {
    return of_a.polygon(pair.a).shape != of_b.polygon(pair.b).shape;
  });
}

bool surfaces_within(const MovingBody& a, const MovingBody& b, double distance_m) {
  assert(a.body.surface && b.body.surface && distance_m >= 0.0);
  Surface &of_a = *a.body.surface, &of_b = *b.body.surface;
  if (of_a.soup().faces.empty() || of_b.soup().faces.empty()) return false;
  const RelativeMotion a_from_b(a.motion.pose(), b.motion.pose());
  return near_query.any_within(of_a.tree(), of_b.tree(), a_from_b, distance_m);
}

Contact mesh_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s, double margin_m) {
  assert(collider.body.surface && collidee.body.surface);
  assert(horizon_s >= 0.0 && std::isfinite(horizon_s));
  Contact contact;
  Surface &a = *collider.body.surface, &b = *collidee.body.surface;
  if (a.soup().faces.empty() || b.soup().faces.empty()) return contact;
  const double tolerance_m =
      advancement_tolerance_m(collider.body.radius_m, collidee.body.radius_m) + 2.0 * margin_m;  // half of it stays
  const MeshImpact impact = contact_impacts.first_impact(a.tree(), collider.motion, b.tree(), collidee.motion,
                                                         horizon_s, {.tolerance_m = tolerance_m});
  assert(impact.time_s >= 0.0 && impact.time_s <= horizon_s);
  contact.time_s = impact.time_s;
  contact.iterations = impact.iterations;
  switch (impact.state) {
    case MeshImpactState::kSeparated:
      contact.time_s = 0.0;
      break;
    case MeshImpactState::kHit:
      contact.state = ContactState::kContact;
      contact.resting = impact.resting;
      set_hit_polygon(contact, collider, collidee, impact, tolerance_m);
      break;
    case MeshImpactState::kOverlapped:
      contact.state = ContactState::kOverlapped;
      set_overlap_polygon(contact, collider, collidee);
      break;
    case MeshImpactState::kIterationLimit:
      contact.state = ContactState::kFailed;
      break;
    case MeshImpactState::kTooLarge:
      contact.state = ContactState::kUnsupported;
      break;
  }
  return contact;
}

}  // namespace peerd::collision
