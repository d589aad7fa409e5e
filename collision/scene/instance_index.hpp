#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/scene.hpp"

namespace peerd::collision {

// Finds the instances that have a given Transform, or a given geometry: several where a node is USEd more than once.
class InstanceIndex {
 public:
  // `member` is Instance::transform or Instance::geometry, and `count` how many of them the scene has.
  InstanceIndex(const Scene& scene, std::uint32_t Instance::*member, std::size_t count);

  // The indices of the instances whose member has that value, in ascending order; `value` is below the count.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t value) const {
    assert(value + std::size_t{1} < begin_.size());
    return std::span(instances_).subspan(begin_[value], begin_[value + 1] - begin_[value]);
  }

 private:
  std::vector<std::uint32_t> begin_;      // by value, and one more: where its instances begin in `instances_`
  std::vector<std::uint32_t> instances_;  // by value, then by index
};

}  // namespace peerd::collision
