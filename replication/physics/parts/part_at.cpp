#include "replication/physics/parts/part_at.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {

PartAt part_at(const WorldModel& model, const MotionWorld& world, FlexibleParts* flexible, std::uint32_t part,
               SimTime t, double h_s) {
  assert(part < model.nodes.size() + model.flexible.size() && h_s >= 0.0);
  PartAt out;
  const std::uint32_t frame = model.frame_of(part);
  if (frame != ModelNode::kNone) out.state = world.at(model.nodes[frame].object, t);
  if (!model.is_flexible(part)) {
    out.body = &model.bodies[part];
    out.center = out.body->center;
    out.radius_m = out.body->radius_m;
    out.extent_m = out.body->extent_m();
    return out;
  }
  assert(flexible != nullptr);
  const auto number = part - static_cast<std::uint32_t>(model.nodes.size());
  FlexibleParts::Form form;
  flexible->form(number, t, form);
  WorldBox box;
  for (const Vec3& v : form.vertices) box.merge(v);
  if (box.is_empty()) return out;
  out.center = 0.5 * box.lo + 0.5 * box.hi;
  for (const Vec3& v : form.vertices) out.radius_m = std::max(out.radius_m, (v - out.center).norm());
  if (h_s > 0.0) out.radius_m += h_s * flexible->course(number, t, h_s).bounds.speed_m_s;
  out.extent_m = out.center.norm() + out.radius_m;
  return out;
}

}  // namespace peerd::replication
