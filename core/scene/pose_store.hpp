#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/math.hpp"
#include "core/scene/slot_pool.hpp"
#include "core/transform.hpp"

namespace peerd {

// The transform of a node with one, three cache lines. Only what most of them have; the rest is a TransformStretch.
struct alignas(32) PlacedTransform {
  std::array<double, 3> translation = {0, 0, 0};  // [m]
  std::array<double, 4> rotation = {0, 0, 0, 1};  // x, y, z, w
  std::uint32_t parent_pose = 0;                  // in PoseStore
  std::uint32_t stretch = kNoSlot;                // in PoseStore; none: scale 1, center 0
  Affine world;
};
struct TransformStretch {
  std::array<double, 3> scale, center;
  std::array<double, 4> scale_orientation;  // x, y, z, w
};

// The transforms of the nodes that have one, and their world poses as of the last update_world(). Slot 0 is that of the
// root: the identity.
class PoseStore {
 public:
  PoseStore();

  [[nodiscard]] PlacedTransform& operator[](std::uint32_t pose) { return placed_.items[pose]; }
  [[nodiscard]] const PlacedTransform& operator[](std::uint32_t pose) const { return placed_.items[pose]; }
  [[nodiscard]] const Affine& world(std::uint32_t pose) const { return placed_.items[pose].world; }

  void reserve(std::size_t poses) { placed_.items.reserve(poses); }
  std::uint32_t add(std::uint32_t parent_pose, const TransformFields& fields);
  void remove(std::uint32_t pose);

  void write(std::uint32_t pose, const TransformFields& fields);
  [[nodiscard]] TransformFields read(std::uint32_t pose) const;
  static void write_translation(PlacedTransform& placed, const Vec3& translation_m) {
    placed.translation = {translation_m[0], translation_m[1], translation_m[2]};
  }
  static void write_rotation(PlacedTransform& placed, const Quat& rotation) {  // unit
    placed.rotation = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
  }
  // Computes the world pose from that of the parent: world_from_parent * parent_from_local.
  void update_world(std::uint32_t pose);

  [[nodiscard]] std::size_t memory_bytes() const { return placed_.memory_bytes() + stretches_.memory_bytes(); }

 private:
  void drop_stretch(PlacedTransform& placed);

  SlotPool<PlacedTransform> placed_;
  SlotPool<TransformStretch> stretches_;
};

}  // namespace peerd
