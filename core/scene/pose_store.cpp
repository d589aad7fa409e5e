#include "core/scene/pose_store.hpp"

#include <cstring>
#include <utility>

namespace peerd {

namespace {

// Compares bits, so that -0 is not taken for 0: the sign can show in a product.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;  // NOLINT(bugprone-suspicious-memory-comparison): -0 differs from 0
}

std::array<double, 3> stored(const Vec3& v) { return {v[0], v[1], v[2]}; }
std::array<double, 4> stored(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }
Vec3 loaded(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
Quat loaded(const std::array<double, 4>& q) { return {q[3], q[0], q[1], q[2]}; }

}  // namespace

PoseStore::PoseStore() {
  static_assert(sizeof(PlacedTransform) == 160);
  placed_.items.emplace_back();
}

std::uint32_t PoseStore::add(std::uint32_t parent_pose, const TransformFields& fields) {
  const std::uint32_t pose = placed_.take();
  placed_.items[pose].parent_pose = parent_pose;
  write(pose, fields);
  return pose;
}

void PoseStore::remove(std::uint32_t pose) {
  drop_stretch(placed_.items[pose]);
  placed_.give_back(pose);
}

void PoseStore::drop_stretch(PlacedTransform& placed) {
  if (placed.stretch != kNoSlot) stretches_.give_back(std::exchange(placed.stretch, kNoSlot));
}

void PoseStore::write(std::uint32_t pose, const TransformFields& fields) {
  PlacedTransform& placed = placed_.items[pose];
  write_translation(placed, fields.translation);
  write_rotation(placed, fields.rotation);
  const TransformFields usual;
  const TransformStretch stretch{stored(fields.scale), stored(fields.center), stored(fields.scale_orientation)};
  if (same_bits(stretch, {stored(usual.scale), stored(usual.center), stored(usual.scale_orientation)})) {
    drop_stretch(placed);
    return;
  }
  if (placed.stretch == kNoSlot) placed.stretch = stretches_.take();
  stretches_.items[placed.stretch] = stretch;
}

TransformFields PoseStore::read(std::uint32_t pose) const {
  const PlacedTransform& placed = placed_.items[pose];
  TransformFields out;
  out.translation = loaded(placed.translation);
  out.rotation = loaded(placed.rotation);
  if (placed.stretch != kNoSlot) {
    const TransformStretch& stretch = stretches_.items[placed.stretch];
    out.scale = loaded(stretch.scale);
    out.center = loaded(stretch.center);
    out.scale_orientation = loaded(stretch.scale_orientation);
  }
  return out;
}

void PoseStore::update_world(std::uint32_t pose) {
  PlacedTransform& placed = placed_.items[pose];
  placed.world = multiply(placed_.items[placed.parent_pose].world, parent_from_local(read(pose)));
}

}  // namespace peerd
