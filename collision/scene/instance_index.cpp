#include "collision/scene/instance_index.hpp"

namespace peerd::collision {

// A counting sort: the sizes of the lists, their beginnings, then the instances.
InstanceIndex::InstanceIndex(const Scene& scene, std::uint32_t Instance::*member, std::size_t count)
    : begin_(count + 1) {
  for (const Instance& i : scene.instances) {
    assert(i.*member == Instance::kNone || i.*member < count);
    if (i.*member != Instance::kNone) ++begin_[i.*member + 1];
  }
  for (std::size_t t = 0; t < count; ++t) begin_[t + 1] += begin_[t];
  instances_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (const std::uint32_t t = scene.instances[i].*member; t != Instance::kNone) instances_[next[t]++] = i;
  }
}

}  // namespace peerd::collision
