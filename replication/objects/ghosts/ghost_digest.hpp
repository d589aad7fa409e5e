#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The sums of numbers that stand for objects and where they are, so that two peers which have the same objects at the
// same places have the same sums, in whatever order they add them. Positions [m] and components of quaternions are
// rounded to 2^-20: a last bit that differs seldom changes a sum.
class GhostSums {
 public:
  void add(ObjectId object, const KinematicState& state);

  [[nodiscard]] bool empty() const { return objects_ == 0; }
  // 0 for a sum to which nothing has been added.
  [[nodiscard]] std::uint16_t of_group(std::size_t group) const;
  [[nodiscard]] std::array<std::uint16_t, kGhostGroups> groups() const;
  [[nodiscard]] std::array<std::uint16_t, kGhostBuckets> buckets_of(std::size_t group) const;

 private:
  std::array<std::array<std::uint64_t, kGhostBuckets>, kGhostGroups> sums_{};
  std::size_t objects_ = 0;
};

// The group of an object, and its bucket in that group.
[[nodiscard]] std::size_t ghost_group(ObjectId object);
[[nodiscard]] std::size_t ghost_bucket(ObjectId object);

}  // namespace peerd::replication
