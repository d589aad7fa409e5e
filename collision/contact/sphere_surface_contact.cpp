#include "collision/contact/sphere_surface_contact.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "collision/contact/convex_contact.hpp"
#include "collision/contact/sphere_contact.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/quadratic.hpp"

namespace peerd::collision {
namespace {

// Triangles whose height is less than this part of their longest edge are taken for their edges: their normal is mostly
// rounding, and no point of them is farther from an edge.
constexpr double kNeedle = 0x1p-40;
// The first window of time in which triangles are sought is so long that the centre goes this many radii; each further
// one is twice as long. Windows do not hang on the horizon, so that each longer horizon finds the same.
constexpr double kWindowRadii = 4.0;
// The directions to a triangle along which it is asked whether it parts.
constexpr std::size_t kDirectionsMax = 2;

enum class Feature : std::uint8_t { kCorner, kEdge, kFace };

struct NearestPoint {
  Vec3 point = Vec3::Zero();
  double distance = kNever;  // [m]
  Feature feature = Feature::kFace;
  Vec3 edge = Vec3::Zero();  // of kEdge: its unit direction
};

// A triangle, and the plane it lies in where it has one.
struct Flat {
  Triangle corners;
  std::array<std::uint32_t, 3> numbers;  // of the corners, in the soup
  std::optional<Vec3> normal;            // unit, of the winding

  Flat(const TriangleSoup& soup, std::uint32_t face) : corners(soup.triangle(face)), numbers(soup.faces[face].corners) {
    const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
    const Vec3 c = u.cross(v);
    const double size = length(c), edge = std::max({length(u), length(v), length(corners[2] - corners[1])});
    if (size > kNeedle * edge * edge) normal = c / size;
  }

  [[nodiscard]] double height_of(const Vec3& p) const { return dot(*normal, p - corners[0]); }

  // Whether p's foot is in the triangle.
  [[nodiscard]] bool is_over(const Vec3& p) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 edge = corners[(i + 1) % 3] - corners[i];
      if (dot(normal->cross(edge), p - corners[i]) < 0.0) return false;
    }
    return true;
  }

  [[nodiscard]] NearestPoint nearest(const Vec3& p) const {
    NearestPoint best;
    if (normal && is_over(p)) {
      const double height = height_of(p);
      return {p - height * *normal, std::abs(height), Feature::kFace, Vec3::Zero()};
    }
    for (std::size_t i = 0; i < 3; ++i) {
      // The two triangles at an edge see the same point of it, to the last bit.
      std::size_t first = i, last = (i + 1) % 3;
      if (numbers[last] < numbers[first]) std::swap(first, last);
      const Vec3 edge = corners[last] - corners[first], from = p - corners[first];
      const double size = length(edge), along = size > 0.0 ? dot(from, edge) / size : 0.0;
      NearestPoint found;
      if (!(along > 0.0)) {
        found = {corners[first], 0.0, Feature::kCorner, Vec3::Zero()};
      } else if (along >= size) {
        found = {corners[last], 0.0, Feature::kCorner, Vec3::Zero()};
      } else {
        found = {corners[first] + (along / size) * edge, 0.0, Feature::kEdge, edge / size};
      }
      found.distance = length(p - found.point);
      if (found.distance < best.distance) best = found;
    }
    return best;
  }
};

// The sphere's centre as seen in the surface's frame at an instant.
struct Moment {
  double t;
  Vec3 center, velocity, half_acceleration;
};

// A direction from a triangle towards the centre, and how the gap along it changes.
struct GapDirection {
  Vec3 n;
  double gap;    // [m]
  double speed;  // at which it opens [m/s]
  double bend;   // half its second derivative [m/s^2]
  double along;  // the part of `bend` that is left where the triangle is taken for its plane
};

struct SphereTouch {
  ContactState state = ContactState::kSeparated;
  double t = kNever;
  bool resting = false;
  std::uint32_t face = 0;
  Vec3 n = Vec3::Zero();  // from the surface to the centre, in the surface's frame

  [[nodiscard]] bool before(const SphereTouch& other, const TriangleSoup& soup) const {
    const auto rank = [&](const SphereTouch& touch) {
      return std::tuple(touch.t, touch.state != ContactState::kOverlapped, touch.resting,
                        touch.state == ContactState::kSeparated ? 0 : soup.faces[touch.face].polygon, touch.face);
    };
    return rank(*this) < rank(other);
  }
};

bool is_round(const MovingBody& m) {
  return m.body.sphere && (m.body.sphere->center.isZero(0.0) || m.motion.angular_velocity_body.isZero(0.0));
}

class SphereSearch {
 public:
  SphereSearch(const MovingBody& sphere, const MovingBody& other, MeetAs as)
      : as_(as),
        sphere_(sphere),
        other_(other),
        soup_(other.body.surface->soup()),
        tree_(other.body.surface->tree()),
        radius_(sphere.body.sphere->radius_m),
        spin_(other.motion.angular_velocity_body),
        turns_(!spin_.isZero(0.0)) {
    const KinematicState &a = sphere.motion, &b = other.motion;
    for (const Vec3& corner : {soup_.box.lo, soup_.box.hi}) reach_ = std::max(reach_, magnitude(corner));
    const double places = sum_of_magnitudes(a.position, b.position) + magnitude(sphere.body.sphere->center);
    const double turning = turns_ ? length(spin_) * (reach_ + radius_) : 0.0;
    error_ = {kRounding * (places + radius_ + reach_),
              kRounding * (sum_of_magnitudes(a.velocity, b.velocity) + turning),
              kRounding * (0.5 * sum_of_magnitudes(a.acceleration, b.acceleration) + length(spin_) * turning)};
    centripetal_ = 0.5 * length(spin_) * turning;
  }

  [[nodiscard]] Moment at(double t) const {
    const KinematicState a = advance(sphere_.motion, t), b = advance(other_.motion, t);
    const Mat3 R_a = a.orientation.toRotationMatrix(), R_b = b.orientation.toRotationMatrix();
    const Vec3 center = a.position - b.position + rotate(R_a, sphere_.body.sphere->center);
    return {t, rotate_back(R_b, center), rotate_back(R_b, a.velocity - b.velocity),
            0.5 * rotate_back(R_b, a.acceleration - b.acceleration)};
  }

  [[nodiscard]] SphereTouch first_until(double horizon) {
    SphereTouch best;
    const Moment start = at(0.0);
    if (const auto inside = inside_at(start)) return *inside;
    const double way = kWindowRadii * radius_;
    const double speed = length(start.velocity) + length(spin_) * length(start.center);
    double window = std::min(way / speed, std::sqrt(way / length(start.half_acceleration)));
    assert(window > 0.0);
    for (double from = 0.0;; from += window, window *= 2.0) {
      const double until = std::min(horizon, from + window);
      search_window(at(from), until, best);
      if (best.t <= until || until >= horizon) break;
    }
    return best;
  }

  [[nodiscard]] bool is_within(double distance_m) {
    const Moment now = at(0.0);
    if (inside_at(now)) return true;
    bool near = false;
    const double reach = radius_ + distance_m;
    for_each_face(now.center.array() - reach, now.center.array() + reach,
                  [&](std::uint32_t face) { near = near || Flat(soup_, face).nearest(now.center).distance <= reach; });
    return near;
  }

  [[nodiscard]] std::uint32_t iterations() const { return iterations_; }

 private:
  // The centre is in a convex piece, and that is solid.
  [[nodiscard]] std::optional<SphereTouch> inside_at(const Moment& now) const {
    if (as_ != MeetAs::kSolids || !other_.body.not_convex_reason.empty()) return std::nullopt;
    std::uint32_t polygon = 0;
    for (const ConvexPiece& piece : other_.body.pieces) {
      double highest = -kNever;
      std::size_t nearest = 0;
      for (std::size_t i = 0; i < piece.faces.size(); ++i) {
        const double height = dot(piece.face_normals[i], now.center - piece.vertices[piece.faces[i].front()]);
        if (height > highest) {
          highest = height;
          nearest = i;
        }
      }
      if (piece.faces.size() > 1 && highest < -error_.gap_m) {
        const auto number = static_cast<std::uint32_t>(polygon + nearest);
        const auto face = std::ranges::lower_bound(soup_.faces, number, {}, &TriangleSoup::Face::polygon);
        return SphereTouch{ContactState::kOverlapped, 0.0, false,
                           static_cast<std::uint32_t>(face - soup_.faces.begin()), piece.face_normals[nearest]};
      }
      polygon += static_cast<std::uint32_t>(piece.faces.size());
    }
    return std::nullopt;
  }

  template <class Visit>
  void for_each_face(const Vec3& low, const Vec3& high, Visit&& visit) {
    const Vec3& origin = tree_.origin();
    const double slack = 0x1p-21 * tree_.extent_m();
    const auto apart = [&](const auto& center, const auto& half) {
      for (int k = 0; k < 3; ++k) {
        const double c = static_cast<double>(center(k)) + origin[k], h = static_cast<double>(half(k)) + slack;
        if (!(c - h <= high[k] && low[k] <= c + h)) return true;
      }
      return false;
    };
    static thread_local std::vector<WideTree::ChildSlot> stack;  // keeps its memory between calls, never values
    stack.assign(1, WideTree::kRoot);
    while (!stack.empty()) {
      const WideTree::ChildSlot slot = stack.back();
      stack.pop_back();
      const WideTree::Ref ref = tree_.at(slot);
      if (ref.kind() == WideTree::Ref::kNode) {
        const WideTree::Node& node = tree_.node(ref.index());
        for (std::size_t i = WideTree::kWidth; i-- > 0;) {
          if (!apart([&](int k) { return node.center[std::size_t(k)][i]; },
                     [&](int k) { return node.half[std::size_t(k)][i]; })) {
            stack.push_back(WideTree::child_slot(ref, i));
          }
        }
        continue;
      }
      const WideTree::Leaf& leaf = tree_.leaf(ref.index());
      if (apart([&](int k) { return leaf.center[std::size_t(k)]; }, [&](int k) { return leaf.half[std::size_t(k)]; })) {
        continue;
      }
      for (const std::uint32_t face : tree_.faces(leaf)) visit(face);
    }
  }

  void search_window(const Moment& begin, double until, SphereTouch& best) {
    const double s = until - begin.t;
    const Vec3 way = s * begin.velocity;
    const double bend = s * s * length(begin.half_acceleration);
    const double turned = s * length(spin_) * (length(begin.center) + length(way) + bend);
    const double more = radius_ + bend + turned + 2.0 * error_.at(until);
    const Vec3 end = begin.center + way;
    for_each_face(begin.center.cwiseMin(end).array() - more, begin.center.cwiseMax(end).array() + more,
                  [&](std::uint32_t face) {
                    const SphereTouch found = first_touch(face, begin, std::min(until, best.t));
                    if (found.before(best, soup_)) best = found;
                  });
  }

  // The first touch of a triangle that is none that parts.
  [[nodiscard]] SphereTouch first_touch(std::uint32_t face, const Moment& begin, double until) {
    const Flat flat(soup_, face);
    Moment now = begin;
    for (std::uint32_t i = 0; i < kAdvancementCap; ++i) {
      ++iterations_;
      const NearestPoint near = flat.nearest(now.center);
      double step = 0.0;
      if (near.distance - radius_ > error_.at(now.t)) {
        step = time_apart(flat, now, near);
      } else {
        const SphereTouch touch = touch_at(flat, face, now, near, step);
        if (touch.state != ContactState::kSeparated) return touch;
      }
      assert(!(step < 0.0));
      if (!(now.t + step <= until)) return {};
      now = at(now.t + step);
    }
    return {ContactState::kFailed, now.t, false, face, Vec3::UnitY()};
  }

  // A time for which the gap along the line to the centre certainly stays above 0.
  [[nodiscard]] double time_apart(const Flat& flat, const Moment& now, const NearestPoint& near) const {
    const Vec3 n = (now.center - near.point) / near.distance;
    double step = kNever;
    const double half = dot(n, now.half_acceleration) - centripetal_;
    for (const Vec3& corner : flat.corners) {
      const double gap = turns_ ? dot(n, now.center - corner) - radius_ : near.distance - radius_;
      const double speed = dot(n, now.velocity - spin_.cross(corner));
      step = std::min(step, first_descent({gap, speed, half}));
      if (!turns_) break;  // no corner is nearer along the line, and all move alike
    }
    return step;
  }

  [[nodiscard]] GapDirection direction(const Vec3& n, double gap, const Moment& now, const NearestPoint& near) const {
    const Vec3 v = now.velocity - spin_.cross(near.point);
    GapDirection d{n, gap, dot(n, v), dot(n, now.half_acceleration), dot(n, now.half_acceleration)};
    if (near.feature == Feature::kFace || near.distance == 0.0) return d;
    Vec3 across = v - d.speed * n;
    if (near.feature == Feature::kEdge) across -= dot(across, near.edge) * near.edge;
    d.bend += 0.5 * dot(across, across) / std::max(near.distance, radius_);
    return d;
  }

  // The sphere touches the triangle or is in it: the contact, unless it parts along some direction; then `step` is a
  // time for which it stays apart.
  [[nodiscard]] SphereTouch touch_at(const Flat& flat, std::uint32_t face, const Moment& now, const NearestPoint& near,
                                     double& step) const {
    const double e = error_.at(now.t);
    std::array<GapDirection, kDirectionsMax> directions;
    std::size_t count = 0;
    if (flat.normal) {
      // The plane first: to rounding it touches as well as an edge of it does, and a ball that slides over the edge
      // between two triangles of a plane meets nothing.
      const double height = flat.height_of(now.center), side = height < 0.0 ? -1.0 : 1.0;
      NearestPoint plane = near;
      plane.feature = Feature::kFace;
      const GapDirection d = direction(side * *flat.normal, std::abs(height) - radius_, now, plane);
      if (d.gap >= -(e + kClockTick_s * std::abs(d.speed))) directions[count++] = d;
    }
    if (near.feature != Feature::kFace && near.distance > 0.0) {
      const GapDirection d = direction((now.center - near.point) / near.distance, near.distance - radius_, now, near);
      if (d.gap >= -(e + kClockTick_s * std::abs(d.speed))) directions[count++] = d;
    }
    if (count == 0) {
      Vec3 n = flat.normal.value_or(Vec3(Vec3::UnitY()));
      if (near.distance > 0.0) n = (now.center - near.point) / near.distance;
      return {ContactState::kOverlapped, now.t, false, face, n};
    }
    SphereTouch touch{ContactState::kContact, now.t, true, face, directions[0].n};
    for (std::size_t i = 0; i < count; ++i) {
      const auto [parts, closes, free_s] = classify(directions[i]);
      if (parts) {
        step = free_s;
        return {};
      }
      if (i == 0) touch.resting = !closes && now.t == 0.0;
    }
    return touch;
  }

  struct Parting {
    bool parts, closes;
    double free_s;  // of one that parts: how long it certainly stays apart
  };
  [[nodiscard]] Parting classify(const GapDirection& d) const {
    const double speed = std::abs(d.speed) <= error_.speed_m_s ? 0.0 : d.speed;
    const double bend = std::abs(d.bend) <= error_.half_acceleration ? 0.0 : d.bend;
    if (speed < 0.0) return {false, true, 0.0};
    const double closing = d.along - centripetal_;  // a bound, along the fixed direction
    if (speed > 0.0) {
      const bool too_low = bend < 0.0 && (speed * speed <= -4.0 * bend * error_.gap_m || speed <= -bend * kClockTick_s);
      if (too_low) return {false, false, 0.0};
      return {true, false, closing < 0.0 ? -speed / closing : kNever};
    }
    if (turns_ || bend < 0.0) return {false, false, 0.0};  // of what turns, still cannot be told from pressed
    if (d.along >= -error_.half_acceleration) return {true, false, kNever};
    // It comes off across an edge. Distance from a triangle is convex in the place, so the acceleration alone brings
    // the two nearer: by the rounding of the gap in this time.
    return {true, false, std::sqrt(error_.gap_m / -closing)};
  }

  MeetAs as_;
  const MovingBody &sphere_, &other_;
  const TriangleSoup& soup_;
  WideTree& tree_;
  double radius_;
  Vec3 spin_;  // of the surface, in its frame [rad/s]
  bool turns_;
  double reach_ = 0.0;  // no corner is farther from the surface's origin [m]
  double centripetal_ = 0.0;
  RoundingBound error_{};
  std::uint32_t iterations_ = 0;
};

// The polygon's own normal where n is one but for rounding.
Vec3 normal_of_polygon(const Surface& surface, std::uint32_t polygon, const Vec3& n) {
  const auto normal = surface.normal(polygon);
  if (!normal) return n;
  const Vec3 facing = dot(*normal, n) < 0.0 ? Vec3(-*normal) : *normal;
  const Vec3 across = facing - n;
  return dot(across, across) <= kRounding * kRounding ? facing : n;
}

}  // namespace

bool meet_as_sphere_and_surface(const MovingBody& a, const MovingBody& b) {
  return (is_round(a) && b.body.surface) || (is_round(b) && a.body.surface);
}

bool sphere_within_surface(const MovingBody& a, const MovingBody& b, double distance_m, MeetAs as) {
  assert(meet_as_sphere_and_surface(a, b) && distance_m >= 0.0);
  const MovingBody &sphere = is_round(a) ? a : b, &other = is_round(a) ? b : a;
  return !other.body.surface->soup().faces.empty() && SphereSearch(sphere, other, as).is_within(distance_m);
}

Contact sphere_surface_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s, MeetAs as) {
  assert(meet_as_sphere_and_surface(collider, collidee) && horizon_s >= 0.0);
  const bool collider_round = is_round(collider);
  const MovingBody &sphere = collider_round ? collider : collidee, &other = collider_round ? collidee : collider;
  Contact contact;
  const Surface& surface = *other.body.surface;
  if (surface.soup().faces.empty()) return contact;
  SphereSearch search(sphere, other, as);
  const SphereTouch touch = search.first_until(horizon_s);
  contact.iterations = search.iterations();
  if (touch.state == ContactState::kSeparated) return contact;
  assert(touch.t >= 0.0 && touch.t <= horizon_s);
  contact.state = touch.state;
  if (contact.state == ContactState::kOverlapped && touch.t > 0.0) contact.state = ContactState::kContact;
  contact.time_s = touch.t;
  contact.resting = touch.resting && touch.state == ContactState::kContact;
  const std::uint32_t polygon = surface.soup().faces[touch.face].polygon;
  const Mat3 R = advance(other.motion, touch.t).orientation.toRotationMatrix();
  const Vec3 n = rotate(R, normal_of_polygon(surface, polygon, touch.n));
  if (collider_round) {
    const ShapePolygon found = surface.polygon(polygon);
    contact.collidee_shape = found.shape;
    contact.collidee_polygon = found.polygon;
    contact.normal_world = n;
  } else {
    contact.collidee_shape = sphere.body.sphere->shape;
    contact.normal_world = -n;
  }
  contact.separating_normal_world = contact.normal_world;
  return contact;
}

}  // namespace peerd::collision
