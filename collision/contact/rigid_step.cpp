#include "collision/contact/rigid_step.hpp"

#include <cassert>
#include <cmath>

#include "collision/exact/infinity.hpp"
#include "collision/query/collect_faces.hpp"

namespace peerd::collision {

void RigidStep::gather(WideTree& tree, const Affine& world_at_begin, const Affine& world_at_end, const WorldBox& near) {
  collect_moving_faces(tree, world_at_begin, world_at_end, near, of_soup_);
  at_begin_.clear();
  at_end_.clear();
  faces_.clear();
  const TriangleSoup& soup = tree.soup();
  for (const std::uint32_t face : of_soup_) {
    const auto first = static_cast<std::uint32_t>(at_begin_.size());
    for (const Vec3& corner : soup.triangle(face)) {
      at_begin_.push_back(multiply(world_at_begin.linear, corner) + world_at_begin.offset);
      at_end_.push_back(multiply(world_at_end.linear, corner) + world_at_end.offset);
    }
    faces_.push_back({{first, first + 1, first + 2}, soup.faces[face].polygon});
  }
  assert(at_begin_.size() == 3 * faces_.size() && at_end_.size() == at_begin_.size());
}

WorldBox swept_box(const SoupStep& soup, double margin_m) {
  assert(margin_m >= 0.0);
  WorldBox box;
  for (std::uint32_t face = 0; face < soup.faces.size(); ++face) box.merge(swept_box(soup.triangle(face)));
  if (box.is_empty()) return box;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = std::nextafter(box.lo[k] - margin_m, -kInfinity);
    box.hi[k] = std::nextafter(box.hi[k] + margin_m, kInfinity);
  }
  return box;
}

}  // namespace peerd::collision
