#include "collision/contact/contact_time.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "collision/contact/box_contact.hpp"
#include "collision/contact/convex_contact.hpp"
#include "collision/contact/mesh_contact.hpp"
#include "collision/contact/separating_axis.hpp"
#include "collision/contact/sphere_contact.hpp"
#include "collision/contact/sphere_surface_contact.hpp"

namespace peerd::collision {
namespace {

bool turns(const KinematicState& s) { return !s.angular_velocity_body.isZero(0.0); }

// A sphere that holds the body while its orientation changes as the motion says.
struct Sphere {
  Vec3 center_world;
  double radius_m;
};
Sphere sphere_of(const MovingBody& m, const Mat3& R, double scale) {
  if (turns(m.motion)) return {m.motion.position, scale * m.body.extent_m()};
  return {m.motion.position + rotate(R, m.body.center), scale * m.body.radius_m};
}

// The world box of what lies in a sphere lies in the sphere this much larger: sqrt(3), rounded up.
constexpr double kBoxReach = 1.7320508075688774;

// True where two spheres are certainly too far apart for the whole horizon: closest approach at constant velocity, less
// what the acceleration can add. Rounding is far below the margin of 2^-40 of all lengths involved.
bool spheres_stay_apart(const Sphere& a, const Sphere& b, const Vec3& v, const Vec3& acceleration, double horizon) {
  assert(horizon >= 0.0 && !(a.radius_m < 0.0) && !(b.radius_m < 0.0));
  const Vec3 d = a.center_world - b.center_world;
  const double v2 = dot(v, v), approach = -dot(d, v);
  const double s = approach <= 0.0 ? 0.0 : approach >= v2 * horizon ? horizon : approach / v2;
  const Vec3 nearest = d + s * v;
  const double a2 = dot(acceleration, acceleration);
  const double bend = a2 > 0.0 ? 0.5 * horizon * horizon * std::sqrt(a2) : 0.0;
  const double radii = a.radius_m + b.radius_m + bend;
  const double margin = 0x1p-40 * (radii + sum_of_magnitudes(a.center_world, b.center_world) + s * magnitude(v));
  const double least = radii + margin;
  return dot(nearest, nearest) > least * least;
}

// True where two bodies part and accelerate apart along the line of their centres, however long the horizon.
bool spheres_part(const Sphere& a, const Sphere& b, const Vec3& v, const Vec3& acceleration) {
  const Vec3 d = a.center_world - b.center_world;
  if (dot(d, v) < 0.0 || dot(d, acceleration) < 0.0) return false;
  const double least = a.radius_m + b.radius_m;
  const double margin = 0x1p-40 * (least + sum_of_magnitudes(a.center_world, b.center_world));
  return dot(d, d) > (least + margin) * (least + margin);
}

// Whether a pair's answer is earlier than the best so far; the first pair's stands where they tie. A failure hides what
// comes after it.
bool comes_first(const Contact& candidate, const Contact& best) {
  if (candidate.state == ContactState::kSeparated) return false;
  return best.state == ContactState::kSeparated || candidate.time_s < best.time_s ||
         (candidate.state == ContactState::kOverlapped && best.state != ContactState::kOverlapped);
}

bool both_convex(const Body& a, const Body& b) { return a.not_convex_reason.empty() && b.not_convex_reason.empty(); }

// Whether no vertex of the one body is outside of the other one, which is one convex piece, but for rounding. It may
// touch it from inside.
bool is_within_piece(const MovingBody& inner, const MovingBody& outer) {
  if (outer.body.pieces.size() != 1 || outer.body.pieces.front().faces.size() == 1) return false;
  const ConvexPiece& piece = outer.body.pieces.front();
  const Pose from = inner.motion.pose(), to = outer.motion.pose();
  const double rounding =
      kRounding * (sum_of_magnitudes(from.position, to.position) + inner.body.extent_m() + outer.body.extent_m());
  return std::ranges::all_of(inner.body.vertices(), [&](const Vec3& vertex) {
    const Vec3 place = to.orientation.conjugate() * (from * vertex - to.position);
    for (std::size_t i = 0; i < piece.faces.size(); ++i) {
      if (dot(piece.face_normals[i], place - piece.vertices[piece.faces[i].front()]) > rounding) return false;
    }
    return true;
  });
}

// Whether each of the two is one convex piece, and no Sphere.
bool are_two_pieces(const Body& a, const Body& b) {
  return both_convex(a, b) && a.pieces.size() == 1 && b.pieces.size() == 1 && !a.sphere && !b.sphere;
}

bool boxes_within(const MovingBody& a, const MovingBody& b, double distance_m) {
  assert(distance_m >= 0.0);
  const WorldBox of_a = tight_box(a), of_b = tight_box(b);
  for (int k = 0; k < 3; ++k) {
    if (!(of_a.lo[k] <= of_b.hi[k] + distance_m && of_b.lo[k] <= of_a.hi[k] + distance_m)) return false;
  }
  return true;
}

class Query {
 public:
  Query(const MovingBody& collider, const MovingBody& collidee, double horizon_s)
      : a_(collider),
        b_(collidee),
        R_a_(collider.motion.orientation.toRotationMatrix()),
        R_b_(collidee.motion.orientation.toRotationMatrix()),
        horizon_s_(horizon_s),
        turning_(turns(collider.motion) || turns(collidee.motion)) {}

  // `margin_m`: how near the two may come and still be apart.
  [[nodiscard]] bool hopeless(double scale, double margin_m) const {
    Sphere a = sphere_of(a_, R_a_, scale);
    const Sphere b = sphere_of(b_, R_b_, scale);
    a.radius_m += margin_m;
    const Vec3 v = a_.motion.velocity - b_.motion.velocity;
    const Vec3 acceleration = a_.motion.acceleration - b_.motion.acceleration;
    return spheres_stay_apart(a, b, v, acceleration, horizon_s_) || spheres_part(a, b, v, acceleration);
  }

  [[nodiscard]] Contact boxes() const {
    return pair({a_.body.vertices(), nullptr, a_.body.object}, {b_.body.vertices(), nullptr, b_.body.object},
                horizon_s_);
  }

  // As for_each_gap(), of the first pieces.
  template <class Visit>
  void for_each_gap_of_pieces(Visit&& visit) const {
    const ConvexPiece &piece_a = a_.body.pieces.front(), &piece_b = b_.body.pieces.front();
    const Solid solid_a{piece_a.vertices, &piece_a, piece_a.shape}, solid_b{piece_b.vertices, &piece_b, piece_b.shape};
    for_each_gap(solid_a, R_a_, solid_b, R_b_, a_.motion.position - b_.motion.position, visit);
  }
  [[nodiscard]] double widest_gap_m() const {
    double widest = -std::numeric_limits<double>::infinity();
    for_each_gap_of_pieces([&](const Vec3&, double gap) {
      widest = std::max(widest, gap);
      return true;
    });
    return widest;
  }

  [[nodiscard]] Contact pieces() const {
    Contact best;
    std::uint32_t iterations = 0;
    for (const ConvexPiece& piece_a : a_.body.pieces) {
      for (const ConvexPiece& piece_b : b_.body.pieces) {
        const double horizon = best.state == ContactState::kSeparated ? horizon_s_ : best.time_s;
        const Contact c =
            pair({piece_a.vertices, &piece_a, piece_a.shape}, {piece_b.vertices, &piece_b, piece_b.shape}, horizon);
        assert(c.state != ContactState::kContact || (c.time_s >= 0.0 && c.time_s <= horizon * (1.0 + 0x1p-50)));
        iterations += c.iterations;
        if (comes_first(c, best)) best = c;
      }
    }
    best.iterations = iterations;
    return best;
  }

 private:
  [[nodiscard]] Contact pair(const Solid& a, const Solid& b, double horizon) const {
    const PairQuery query{a, b, a_.motion, b_.motion, horizon};
    const double radius_sum = a_.body.extent_m() + b_.body.extent_m();
    return turning_ ? rotational_contact(query, radius_sum) : translational_contact(query, radius_sum, R_a_, R_b_);
  }

  const MovingBody &a_, &b_;
  Mat3 R_a_, R_b_;
  double horizon_s_;
  bool turning_;
};

}  // namespace

bool touching(const MovingBody& a, const MovingBody& b, CollisionType type, const ContactOptions& options) {
  const double near_m = 2.0 * advancement_tolerance_m(a.body.radius_m, b.body.radius_m) + options.margin_m;
  if (type == CollisionType::kBox) return boxes_within(a, b, near_m);
  if (options.as == MeetAs::kPolygons) return has_exact_answer(a.body, b.body) && surfaces_within(a, b, near_m);
  const ContactState now = first_contact(a, b, type, 0.0, options).state;
  if (now == ContactState::kContact || now == ContactState::kOverlapped) return true;
  if (are_two_pieces(a.body, b.body)) {
    const double gap_m = Query(a, b, 0.0).widest_gap_m();
    if (gap_m >= -0.5 * near_m) return gap_m <= near_m;  // deeper they cross, or the one is inside the other
  }
  if (meet_as_spheres(a, b)) return spheres_within(a, b, near_m, options.as);
  if (meet_as_sphere_and_surface(a, b)) return sphere_within_surface(a, b, near_m, options.as);
  return has_exact_answer(a.body, b.body) && surfaces_within(a, b, near_m);
}

std::optional<PartingPlane> widest_parting(const MovingBody& a, const MovingBody& b) {
  PartingPlane widest{Vec3::Zero(), -std::numeric_limits<double>::infinity()};
  const auto offer = [&](const Vec3& n, double gap) {
    if (gap > widest.gap_m) widest = {n, gap};
    return true;
  };
  const auto centre = [](const MovingBody& each) {
    return Vec3(each.motion.position + each.motion.orientation * each.body.sphere->center);
  };
  if (a.body.sphere && b.body.sphere) {
    const Vec3 way = centre(a) - centre(b);
    const double distance = way.norm();
    if (distance > 0.0) offer(way / distance, distance - a.body.sphere->radius_m - b.body.sphere->radius_m);
  } else if (a.body.sphere || b.body.sphere) {
    const bool a_is_round = a.body.sphere.has_value();
    const MovingBody &round = a_is_round ? a : b, &flat = a_is_round ? b : a;
    if (flat.body.pieces.size() != 1) return std::nullopt;
    const ConvexPiece& piece = flat.body.pieces.front();
    const Vec3 from_flat = flat.motion.orientation.conjugate() * (centre(round) - flat.motion.position);
    for (const Vec3& axis : piece.face_axes) {
      const Extent extent = extent_along(axis, piece.vertices);
      const double at = axis.dot(from_flat), radius = round.body.sphere->radius_m;
      const Vec3 n = flat.motion.orientation * (a_is_round ? axis : Vec3(-axis));
      offer(n, at - radius - extent.high);
      offer(Vec3(-n), extent.low - at - radius);
    }
  } else {
    if (!are_two_pieces(a.body, b.body)) return std::nullopt;
    Query(a, b, 0.0).for_each_gap_of_pieces(offer);
  }
  if (!(widest.gap_m >= 0.0)) return std::nullopt;
  return widest;
}

namespace {

constexpr double kLargest_m = 0x1p58;  // MeshImpactQuery's, with room

}  // namespace

bool has_exact_answers(const Body& body) { return body.unsupported.empty() && body.radius_m <= kLargest_m; }

bool has_exact_answer(const Body& a, const Body& b) {
  if (!a.unsupported.empty() || !b.unsupported.empty()) return false;
  return both_convex(a, b) || (a.radius_m <= kLargest_m && b.radius_m <= kLargest_m);
}

Contact first_contact(const MovingBody& collider, const MovingBody& collidee, CollisionType type, double horizon_s,
                      const ContactOptions& options) {
  assert(horizon_s >= 0.0 && std::isfinite(horizon_s) && options.margin_m >= 0.0);
  assert(collider.motion.position.allFinite() && collidee.motion.position.allFinite());
  const bool box = type == CollisionType::kBox;
  if (!box && !has_exact_answer(collider.body, collidee.body)) {
    Contact contact;
    contact.state = ContactState::kUnsupported;
    return contact;
  }
  if (collider.body.vertices().empty() || collidee.body.vertices().empty()) return {};
  const bool round = options.as != MeetAs::kPolygons && options.margin_m == 0.0;
  if (!box && round && meet_as_spheres(collider, collidee)) {
    return sphere_contact(collider, collidee, horizon_s, options.as);
  }
  const Query query(collider, collidee, horizon_s);
  assert(box || (collider.body.surface && collidee.body.surface));
  if (query.hopeless(box ? kBoxReach : 1.0, options.margin_m)) return {};
  if (box) {
    if (options.margin_m == 0.0) return query.boxes();
    return first_box_contact({&collider, 1}, {&collidee, 1}, horizon_s, options.margin_m);
  }
  if (round && meet_as_sphere_and_surface(collider, collidee)) {
    return sphere_surface_contact(collider, collidee, horizon_s, options.as);
  }
  if (options.margin_m == 0.0 && both_convex(collider.body, collidee.body)) {
    const Contact contact = query.pieces();
    // From outside, the first contact of solids is that of their polygons. Of solids that overlap one may be inside the
    // other: then their surfaces have still to meet.
    if (contact.state != ContactState::kOverlapped || options.as == MeetAs::kSolids) return contact;
    const bool is_one_inside = is_within_piece(collider, collidee) || is_within_piece(collidee, collider);
    if (options.as == MeetAs::kSurfaces && !is_one_inside && surfaces_within(collider, collidee, 0.0)) return contact;
  }
  return mesh_contact(collider, collidee, horizon_s, options.margin_m);
}

}  // namespace peerd::collision
