#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "collision/exact/ray_triangle.hpp"
#include "collision/tree/wide_tree.hpp"

namespace peerd::collision {

// A ray in a tree's coordinates. Its parameter here is a length on the tree's scale, but for a factor below 2, from the
// point of the ray's line that is nearest to the tree's origin, and so no coordinate is much larger than the tree; a
// hit at the parameter t of the ray has one in [first, last] as soon as 0 <= t <= the longest.
class WideRay {
 public:
  WideRay(const WideTree& tree, const Ray& ray);
  [[nodiscard]] bool reaches_tree() const { return reaches_tree_; }  // false: it certainly hits nothing
  void shorten(double longest);                                      // `longest` is a parameter of the original ray

  std::array<float, 3> start{}, inverse{};  // a point of it, and one over its direction, of which no component is 0
  float first = 0.0f, last = 0.0f;
  float slack = 0.0f;  // more than can be wrong about a point of the ray, seen from a box
  // For triangles: the direction's main axis and the two after it; the shear of the latter per unit of the former; the
  // parameter per unit of it; and more than can be wrong about a corner that was moved along the ray.
  std::array<std::size_t, 3> axes{};
  float shear_x = 0.0f, shear_y = 0.0f, per_main = 0.0f, moved_slack = 0.0f;

 private:
  double unit_, nearest_, scale_;  // parameter = (t * unit - nearest) * scale
  bool reaches_tree_;
};

// Begins to fetch what these tests read of a child that will be visited soon: of a node its axis-aligned boxes and its
// children, or a leaf.
inline void fetch_ahead(const WideTree& tree, WideTree::Ref ref) {
  constexpr std::size_t kLine = 64;
  const auto fetch = [](const void* begin, std::size_t bytes) {
    for (std::size_t at = 0; at < bytes; at += kLine) __builtin_prefetch(static_cast<const std::byte*>(begin) + at);
  };
  if (ref.kind() == WideTree::Ref::kNode) fetch(&tree.node(ref.index()), offsetof(WideTree::Node, oriented_center));
  if (ref.kind() == WideTree::Ref::kLeaf) fetch(&tree.leaf(ref.index()), sizeof(WideTree::Leaf));
}

using Entries = std::array<float, WideTree::kWidth>;  // no later than where the ray enters a box
// Finds which children's boxes a ray may enter, bit i for child i; and where it enters those.
[[nodiscard]] std::uint8_t test_ray_node(const WideTree::Node& node, const WideRay& ray, Entries& entries);
// Finds which triangles of a leaf a ray may hit.
[[nodiscard]] std::uint8_t test_ray_leaf(const WideTree::Leaf& leaf, const WideRay& ray);

// Half spaces in a tree's coordinates: normal . p + offset >= 0.
struct WidePlanes {
  static constexpr std::size_t kMaxPlanes = 16;
  struct Plane {
    std::array<float, 3> normal;
    float offset, slack;  // more than can be wrong about a distance from it
  };
  std::array<Plane, kMaxPlanes> planes;
  std::size_t count = 0;
};

using PlaneMask = std::uint16_t;  // bit i: plane i
static_assert(WidePlanes::kMaxPlanes <= 8 * sizeof(PlaneMask));
// Finds which children may reach into all half spaces of `active`; `crossed` receives, for each, the half spaces that
// it is not certainly wholly in.
[[nodiscard]] std::uint8_t test_planes_node(const WideTree::Node& node, const WidePlanes& planes, PlaneMask active,
                                            std::array<PlaneMask, WideTree::kWidth>& crossed);
// The same test for triangles, by their corners.
[[nodiscard]] std::uint8_t test_planes_leaf(const WideTree::Leaf& leaf, const WidePlanes& planes, PlaneMask active,
                                            std::array<PlaneMask, WideTree::kWidth>& crossed);

}  // namespace peerd::collision
