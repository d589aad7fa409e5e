#include "replication/physics/world/flexible_parts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/transform.hpp"

namespace peerd::replication {
namespace {

// World times beyond which a count of nanoseconds would overflow [s].
constexpr double kLatestWorldTime_s = 3.2e9;

}  // namespace

FlexibleParts::FlexibleParts(const WorldModel& model, std::optional<SimTime> world_zero)
    : motion_(*model.scene), zero_(world_zero) {
  for (const FlexiblePart& part : model.flexible) {
    const auto carrier =
        part.carrier == ModelNode::kNone ? std::nullopt : std::optional(model.nodes[part.carrier].object);
    parts_.emplace_back(*model.scene, motion_, part.shape, carrier);
  }
}

bool FlexibleParts::set_world_zero(std::optional<SimTime> zero) {
  if (zero == zero_) return false;
  zero_ = zero;
  return true;
}

// Before world time has begun everything is as the file has it, as before 0.
double FlexibleParts::world_s(SimTime t) const { return zero_ ? to_seconds(t - *zero_) : -1.0; }

void FlexibleParts::form(std::uint32_t part, SimTime t, Form& out) {
  assert(part < parts_.size());
  const double t_s = world_s(t);
  out.vertices.clear();
  out.faces.clear();
  const FlexibleShape& shape = parts_[part];
  const auto soup = collision::make_soup(shape.mesh(motion_, t_s));
  if (!soup) return;  // a vertex is no number: nothing of it can touch, as in collide
  const Affine place = shape.carrier_from_shape(motion_, t_s);
  for (const Vec3& v : soup->vertices) out.vertices.push_back(multiply(place.linear, v) + place.offset);
  out.faces = soup->faces;
}

FlexibleParts::Course FlexibleParts::course(std::uint32_t part, SimTime t, double h_s) {
  assert(part < parts_.size() && h_s > 0.0);
  const FlexibleShape::Course c = parts_[part].course(motion_, world_s(t), h_s);
  const double end_s = std::min(kLatestWorldTime_s, c.end_s);
  Course course;
  course.bounds.distance_m = c.distance_m;
  course.bounds.speed_m_s = c.speed_m_s;
  course.bounds.acceleration_m_s2 = c.acceleration_m_s2;
  if (zero_ && end_s < kLatestWorldTime_s)
    course.end = *zero_ + Duration{static_cast<std::int64_t>(std::ceil(end_s * 1e9))};
  return course;
}

}  // namespace peerd::replication
