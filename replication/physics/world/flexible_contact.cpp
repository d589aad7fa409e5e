#include "replication/physics/world/flexible_contact.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/contact/deforming_contact.hpp"
#include "collision/contact/rigid_step.hpp"
#include "collision/exact/overlap_depth.hpp"
#include "core/transform.hpp"

namespace peerd::replication {
namespace {

using collision::ContactState;
using collision::SoupImpactState;
using collision::SoupStep;

// Bounds are of so long at most; a step is no shorter than this, however its part moves.
constexpr Duration kLongest{std::int64_t{1} << 27}, kShortest{std::int64_t{1} << 16};
// Keys that are closer together make no steps of their own: a file cannot make work without end.
constexpr Duration kShortestBetweenKeys{std::int64_t{1} << 10};
// Boxes that may meet are advanced so often within a step; then nothing is known of what comes later.
constexpr int kBoxSteps = 256;
// The depths of so many pairs of triangles that touch are computed.
constexpr std::size_t kDepthsMax = 16;

// One side in one step: the forms of its flexible parts, or its rigid parts' soups.
struct StepSide {
  std::vector<Vec3> at_begin, at_end;
  std::vector<collision::TriangleSoup::Face> faces;

  [[nodiscard]] SoupStep step() const { return {at_begin, at_end, faces}; }
};

// These keep memory between calls, never values.
thread_local collision::SoupImpactQuery impacts;
thread_local collision::RigidStep rigid;
thread_local FlexibleParts::Form form_at_begin, form_at_end;
thread_local StepSide side_a, side_b;

MotionBounds bounds_of(const MovingPart& part, SimTime t, double h_s, std::optional<SimTime>& end) {
  MotionBounds in_node;
  if (part.flexible != nullptr) {
    const FlexibleParts::Course course = part.flexible->course(part.form, t, h_s);
    in_node = course.bounds;
    end = course.end;
  } else {
    in_node.distance_m = part.body->extent_m();
  }
  if (part.chain.empty()) return in_node;
  const auto laws_end = smooth_until(part.chain, t);
  if (laws_end) end = end ? std::min(*end, *laws_end) : *laws_end;
  return composed_bounds(part.chain, t, h_s, in_node);
}

struct Step {
  SimTime end;
  double margin_m = 0.0;  // of both sides together
};

// The longest step from t on in which no vertex of either side bends off a straight way by more than that.
Step step_from(const PartQuery& query, SimTime t, SimTime until, double error_max_m) {
  assert(t < until && error_max_m > 0.0);
  const double longest_s = to_seconds(kLongest);
  double acceleration = 0.0;
  SimTime end = std::min(until, t + kLongest);
  for (const auto side : {query.a, query.b}) {
    double most = 0.0;
    for (const MovingPart& part : side) {
      std::optional<SimTime> part_end;
      most = std::max(most, bounds_of(part, t, longest_s, part_end).acceleration_m_s2);
      if (part_end) end = std::min(end, std::max(*part_end, t + kShortestBetweenKeys));
    }
    acceleration += most;
  }
  Duration step = kLongest;
  const auto margin = [&](Duration h) { return acceleration * to_seconds(h) * to_seconds(h) / 8.0; };
  while (step > kShortest && margin(step) > error_max_m) step /= 2;
  end = std::min(end, t + step);
  return {end, margin(end - t)};
}

Affine to_affine(const KinematicState& state) { return {state.orientation.toRotationMatrix(), state.position}; }

// The places of a part at the ends of a step, in the frame of the pair.
std::array<Affine, 2> places(const MovingPart& part, SimTime begin, SimTime end) {
  if (part.chain.empty()) return {};
  return {to_affine(composed_at(part.chain, begin, begin)), to_affine(composed_at(part.chain, begin, end))};
}

void add_flexible(StepSide& side, const MovingPart& part, SimTime begin, SimTime end) {
  const auto [at_begin, at_end] = places(part, begin, end);
  part.flexible->form(part.form, begin, form_at_begin);
  part.flexible->form(part.form, std::max(begin, end - Duration{1}), form_at_end);  // a key may jump at the end
  if (form_at_end.vertices.size() != form_at_begin.vertices.size()) form_at_end = form_at_begin;
  const auto first = static_cast<std::uint32_t>(side.at_begin.size());
  for (const Vec3& v : form_at_begin.vertices) side.at_begin.push_back(multiply(at_begin.linear, v) + at_begin.offset);
  for (const Vec3& v : form_at_end.vertices) side.at_end.push_back(multiply(at_end.linear, v) + at_end.offset);
  for (collision::TriangleSoup::Face face : form_at_begin.faces) {
    for (std::uint32_t& corner : face.corners) corner += first;
    side.faces.push_back(face);
  }
}

void add_vertices(StepSide& side, const MovingPart& part, SimTime begin, SimTime end) {
  const auto [at_begin, at_end] = places(part, begin, end);
  for (const Vec3& v : part.body->vertices()) {
    side.at_begin.push_back(multiply(at_begin.linear, v) + at_begin.offset);
    side.at_end.push_back(multiply(at_end.linear, v) + at_end.offset);
  }
}

void add(StepSide& side, const MovingPart& part, SimTime begin, SimTime end) {
  part.flexible != nullptr ? add_flexible(side, part, begin, end) : add_vertices(side, part, begin, end);
}

void clear(StepSide& side) {
  side.at_begin.clear();
  side.at_end.clear();
  side.faces.clear();
}

struct Impact {
  SoupImpactState state = SoupImpactState::kSeparated;
  double fraction = 1.0;
  Vec3 normal = Vec3::UnitY();
  std::uint32_t polygon = 0;  // of the collidee
};

Vec3 at(const SoupStep& step, std::uint32_t corner, double fraction) {
  return step.at_begin[corner] + fraction * (step.at_end[corner] - step.at_begin[corner]);
}

// The normal of the collidee's face, on the side of the middle of the collider's.
Vec3 normal_of(const SoupStep& a, std::uint32_t face_a, const SoupStep& b, std::uint32_t face_b, double fraction) {
  const auto corner = [&](const SoupStep& step, std::uint32_t face, int i) {
    return at(step, step.faces[face].corners[static_cast<std::size_t>(i)], fraction);
  };
  const Vec3 p = corner(b, face_b, 0);
  const Vec3 n = (corner(b, face_b, 1) - p).cross(corner(b, face_b, 2) - p);
  const Vec3 middle = (corner(a, face_a, 0) + corner(a, face_a, 1) + corner(a, face_a, 2)) / 3.0;
  const double size = n.norm();
  if (!(size > 0.0)) return Vec3::UnitY();
  return n.dot(middle - p) < 0.0 ? Vec3(-n / size) : Vec3(n / size);
}

Impact soup_impact(const MovingPart& a, const MovingPart& b, SimTime begin, SimTime end, double margin_m) {
  clear(side_a);
  clear(side_b);
  const auto near_of = [&](const StepSide& side) {
    return collision::swept_box(side.step(), margin_m + 2.0 * collision::kAdvancementTolerance_m);
  };
  const auto gather = [&](const MovingPart& part, const StepSide& other) {
    const auto [at_begin, at_end] = places(part, begin, end);
    rigid.gather(part.body->surface->tree(), at_begin, at_end, near_of(other));
    return rigid.step();
  };
  SoupStep of_a, of_b;
  if (a.flexible != nullptr) add_flexible(side_a, a, begin, end);
  if (b.flexible != nullptr) add_flexible(side_b, b, begin, end);
  const auto is_empty = [](const MovingPart& part, const StepSide& side) {
    return part.flexible != nullptr ? side.faces.empty() : part.body->surface->soup().faces.empty();
  };
  if (is_empty(a, side_a) || is_empty(b, side_b)) return {};
  of_a = a.flexible != nullptr ? side_a.step() : gather(a, side_b);
  of_b = b.flexible != nullptr ? side_b.step() : gather(b, side_a);
  const collision::SoupImpact found = impacts.first_impact(of_a, of_b, {.margin_m = margin_m});
  Impact impact{found.state, found.fraction};
  if (found.state == SoupImpactState::kSeparated) return impact;
  impact.normal = normal_of(of_a, found.faces.a, of_b, found.faces.b, found.fraction);
  impact.polygon = found.polygons.b;
  return impact;
}

WorldBox box_at(const StepSide& side, double fraction) {
  WorldBox box;
  for (std::size_t i = 0; i < side.at_begin.size(); ++i) {
    box.merge(Vec3(side.at_begin[i] + fraction * (side.at_end[i] - side.at_begin[i])));
  }
  return box;
}

// How far a is above b along an axis, or below it.
double gap_of(const WorldBox& a, const WorldBox& b, int axis, bool above) {
  return above ? a.lo[axis] - b.hi[axis] : b.lo[axis] - a.hi[axis];
}

// The lowest of vertices that go straight on bends down, and the highest up, so a gap between two such boxes is never
// smaller than its chord: until the chord of some axis has closed, the boxes are apart.
Impact box_impact(double margin_m) {
  assert(margin_m >= 0.0 && side_a.at_begin.size() == side_a.at_end.size());
  Impact impact;
  if (side_a.at_begin.empty() || side_b.at_begin.empty()) return impact;
  const double near_m = margin_m + collision::kAdvancementTolerance_m;
  const double least_m = margin_m + 0.5 * collision::kAdvancementTolerance_m;
  const WorldBox last_a = box_at(side_a, 1.0), last_b = box_at(side_b, 1.0);
  double fraction = 0.0;
  for (int i = 0; i < kBoxSteps; ++i) {
    const WorldBox a = box_at(side_a, fraction), b = box_at(side_b, fraction);
    double apart_until = fraction;
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool above : {true, false}) {
        const double gap = gap_of(a, b, axis, above), last = gap_of(last_a, last_b, axis, above);
        if (gap <= near_m) continue;
        const double closes = last >= least_m ? 1.0 : (gap - least_m) / (gap - last);
        apart_until = std::max(apart_until, fraction + closes * (1.0 - fraction));
      }
    }
    if (apart_until == fraction) {
      impact.state = fraction == 0.0 ? SoupImpactState::kTouching : SoupImpactState::kHit;
      impact.fraction = fraction;
      return impact;
    }
    if (apart_until >= 1.0) return impact;
    fraction = apart_until;
  }
  impact.state = SoupImpactState::kUnsure;
  impact.fraction = fraction;
  return impact;
}

Impact impact_of(const PartQuery& query, SimTime begin, SimTime end, double margin_m) {
  if (query.type != CollisionType::kBox) {
    assert(query.a.size() == 1 && query.b.size() == 1);
    return soup_impact(query.a.front(), query.b.front(), begin, end, margin_m);
  }
  clear(side_a);
  clear(side_b);
  for (const MovingPart& part : query.a) add(side_a, part, begin, end);
  for (const MovingPart& part : query.b) add(side_b, part, begin, end);
  return box_impact(margin_m);
}

// How deep the triangles that touched at the begin of the last step are in each other.
double triangle_depth_m(const PartQuery& query) {
  const auto touching = impacts.touching_at_begin();
  const SoupStep of_a = query.a.front().flexible != nullptr ? side_a.step() : rigid.step();
  const SoupStep of_b = query.b.front().flexible != nullptr ? side_b.step() : rigid.step();
  double depth_m = 0.0;
  for (const collision::FacePair& faces : touching.first(std::min(touching.size(), kDepthsMax))) {
    depth_m =
        std::max(depth_m, collision::overlap_depth_m(of_a.triangle_at_begin(faces.a), of_b.triangle_at_begin(faces.b)));
  }
  return depth_m;
}

double box_depth_m() {
  const WorldBox a = box_at(side_a, 0.0), b = box_at(side_b, 0.0);
  double depth_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    depth_m = std::min({depth_m, -gap_of(a, b, axis, true), -gap_of(a, b, axis, false)});
  }
  return std::max(depth_m, 0.0);
}

SimTime time_of(const Impact& impact, SimTime begin, SimTime end) {
  const double ns = impact.fraction * static_cast<double>((end - begin).count());
  return begin + Duration{static_cast<std::int64_t>(std::floor(ns))};
}

}  // namespace

PartContact first_flexible_contact(const PartQuery& query, SimTime from, SimTime until, std::uint64_t& searches) {
  assert(from < until && query.is_flexible());
  PartContact none;
  none.at = from;
  for (SimTime t = from; t < until;) {
    const Step coarse = step_from(query, t, until, kCoarseError_m);
    ++searches;
    const Impact near = impact_of(query, t, coarse.end, coarse.margin_m);
    if (near.state != SoupImpactState::kSeparated) {
      for (SimTime u = time_of(near, t, coarse.end); u < coarse.end;) {
        const Step fine = step_from(query, u, coarse.end, kFineError_m);
        ++searches;
        const Impact hit = impact_of(query, u, fine.end, fine.margin_m);
        if (hit.state != SoupImpactState::kSeparated) {
          PartContact found;
          found.at = time_of(hit, u, fine.end);
          const bool overlaps = hit.state == SoupImpactState::kTouching && found.at == from;
          found.contact.state = overlaps ? ContactState::kOverlapped : ContactState::kContact;
          found.contact.time_s = to_seconds(found.at - from);
          found.contact.normal_world = found.contact.separating_normal_world = hit.normal;
          found.contact.collidee_polygon = hit.polygon;
          return found;
        }
        u = fine.end;
      }
    }
    t = coarse.end;
  }
  return none;
}

bool flexible_parts_touch(const PartQuery& query, SimTime t) {
  const SimTime end = t + Duration{1};
  const double margin_m = 2.0 * collision::kAdvancementTolerance_m + 2.0 * kFineError_m;
  const Impact impact = impact_of(query, t, end, margin_m);
  return impact.state == SoupImpactState::kTouching ||
         (impact.state != SoupImpactState::kSeparated && impact.fraction == 0.0);
}

double flexible_parts_touch_for_s(const PartQuery& query, SimTime t, SimTime until) {
  assert(t < until);
  const SimTime short_after = t + Duration{1};
  if (impact_of(query, t, short_after, 0.0).state != SoupImpactState::kTouching) return 0.0;
  const double depth_m = query.type == CollisionType::kBox ? box_depth_m() : triangle_depth_m(query);
  double speed_m_s = 0.0;
  for (const auto side : {query.a, query.b}) {
    double most_m_s = 0.0;
    for (const MovingPart& part : side) {
      std::optional<SimTime> end;
      most_m_s = std::max(most_m_s, bounds_of(part, t, to_seconds(until - t), end).speed_m_s);
      if (end) until = std::min(until, std::max(*end, short_after));
    }
    speed_m_s += most_m_s;
  }
  const double left_s = to_seconds(until - t);
  return speed_m_s * left_s < depth_m ? left_s : depth_m / speed_m_s;
}

}  // namespace peerd::replication
