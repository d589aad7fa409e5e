#include "collision/engines/motion_bounds.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "collision/engines/volume_tree.hpp"
#include "collision/scene/surfaces.hpp"

namespace peerd::collision::engines {
namespace {

constexpr double kNever_s = -std::numeric_limits<double>::infinity();

}  // namespace

MotionBounds::MotionBounds(const Scene& scene) : scene_(scene), motion_(scene), meshes_(scene) {}

MotionBounds::Object MotionBounds::object_of(ObjectId id) {
  Object object;
  const std::vector<std::uint32_t> flexible = motion_.flexible_geometries();
  for (std::uint32_t i = scene_.index_of(id); i < scene_.at(id).subtree_end; ++i) {
    if (!is_surface(scene_, i, Surfaces::kColliding)) continue;
    const std::uint32_t geometry = scene_.instances[i].geometry;
    object.is_flexible |= std::ranges::binary_search(flexible, geometry);
    const LocalBox& box = meshes_.local_box(geometry);
    if (box.is_empty()) continue;
    PlacedShape shape;
    shape.farthest_m = box.lo.cwiseAbs().cwiseMax(box.hi.cwiseAbs()).cast<double>().norm();
    for (auto up = static_cast<std::int32_t>(i); up >= 0; up = scene_.instances[static_cast<std::size_t>(up)].parent) {
      const auto at = static_cast<std::uint32_t>(up);
      if (scene_.instances[at].transform != Instance::kNone) shape.path.push_back(scene_.id_of(at));
    }
    std::ranges::reverse(shape.path);
    object.shapes.push_back(std::move(shape));
  }
  return object;
}

void MotionBounds::set_objects(std::span<const ObjectId> objects) {
  objects_.clear();
  for (const ObjectId id : objects) objects_.push_back(object_of(id));
}

void MotionBounds::set_time(double now_s) {
  assert(now_s >= now_s_);
  now_s_ = now_s;
}

// At the very end of a cycle a TimeSensor sends its last fraction, and the first one right after: the present place may
// be that of the rates before.
bool MotionBounds::has_just_changed(ObjectId id) {
  if (!motion_.moves_in_parent(id)) return false;
  return motion_.field_rates(id, now_s_ - kRounding * (1.0 + std::abs(now_s_))).end_s <= now_s_;
}

// A translation moves evenly until its rates end, so two places that it has by then tell its velocity, but for the
// rounding of their difference.
MotionBounds::Velocity MotionBounds::translation_velocity(ObjectId id, const PredefinedMotion::FieldRates& rates) {
  if (rates.translation_m_s == 0.0) return {};
  const double h = 0.5 * std::min(rates.end_s - now_s_, 1.0), then_s = now_s_ + h;
  const Vec3 from = rates.fields.translation, to = motion_.transform(id, then_s).translation;
  if (!(then_s - now_s_ > 0.0)) return {.error_m_s = rates.translation_m_s};
  return {.m_s = (to - from) / (then_s - now_s_), .error_m_s = kRounding * (from.norm() + to.norm()) / h};
}

// At each Transform p' = L p + b: with rates of its fields, |L|, |L'|, |L''|, |b'| and |b''| are bounded as
// FlexibleShape::course() bounds them. What the translations add to the velocity is known with its direction, and is
// kept apart from the rest, which is only bounded.
SpaceTimeBound MotionBounds::bound_of(const PlacedShape& shape) {
  SpaceTimeBound out{.end_s = std::numeric_limits<double>::infinity()};
  double reach = shape.farthest_m, speed = 0.0;
  for (std::size_t i = shape.path.size(); i-- > 0;) {
    const PredefinedMotion::FieldRates r = motion_.field_rates(shape.path[i], now_s_);
    out.end_s = std::min(out.end_s, has_just_changed(shape.path[i]) ? now_s_ : r.end_s);
    const double w = r.rotation_rad_s, u = r.scale_orientation_rad_s, s1 = r.scale_1_s;
    const double a0 = r.fields.scale.cwiseAbs().maxCoeff() + kHorizon_s * s1;
    const double x1 = 2.0 * u * a0 + s1, x2 = 4.0 * u * (u * a0 + s1);
    const double a1 = w * a0 + x1, a2 = w * w * a0 + 2.0 * w * x1 + x2;
    const double center = r.fields.center.norm() + kHorizon_s * r.center_m_s;
    const double b1 = (1.0 + a0) * r.center_m_s + a1 * center, b2 = a2 * center + 2.0 * a1 * r.center_m_s;
    out.acceleration_m_s2 = a2 * reach + 2.0 * a1 * speed + a0 * out.acceleration_m_s2 + b2;
    const Velocity v = translation_velocity(shape.path[i], r);
    out.spread_m_s = a1 * reach + a0 * out.spread_m_s + b1 + v.error_m_s;
    out.velocity_m_s = parent_from_local(r.fields).linear * out.velocity_m_s + v.m_s;
    speed = a1 * reach + a0 * speed + r.translation_m_s + b1;
    reach = a0 * reach + r.fields.translation.norm() + kHorizon_s * r.translation_m_s + (1.0 + a0) * center;
  }
  if (speed > 0.0) out.end_s = std::min(out.end_s, now_s_ + kHorizon_s);
  out.spread_m_s += kRounding * speed;
  out.rounding_m = kRounding * reach;
  return out;
}

SpaceTimeBound MotionBounds::bound(BroadIndex index) {
  assert(index < objects_.size());
  Object& object = objects_[index];
  if (object.bounded_at_s == now_s_) return object.bound;
  object.bounded_at_s = now_s_;
  object.bound = {.end_s = object.is_flexible ? kNever_s : std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < object.shapes.size() && !object.is_flexible; ++i) {
    const SpaceTimeBound of_shape = bound_of(object.shapes[i]);
    if (i == 0) object.bound.velocity_m_s = of_shape.velocity_m_s;
    const double aside_m_s = (of_shape.velocity_m_s - object.bound.velocity_m_s).norm();
    object.bound.spread_m_s = std::max(object.bound.spread_m_s, of_shape.spread_m_s + aside_m_s);
    object.bound.acceleration_m_s2 = std::max(object.bound.acceleration_m_s2, of_shape.acceleration_m_s2);
    object.bound.rounding_m = std::max(object.bound.rounding_m, of_shape.rounding_m);
    object.bound.end_s = std::min(object.bound.end_s, of_shape.end_s);
  }
  return object.bound;
}

}  // namespace peerd::collision::engines
