#include "collision/query/ray_query.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <tuple>

#include "collision/query/wide_view.hpp"

namespace peerd::collision {
namespace {

using Ref = WideTree::Ref;

bool before(const RayHit& a, const RayHit& b) {
  return std::tie(a.t, a.polygon, a.face) < std::tie(b.t, b.polygon, b.face);
}

}  // namespace

// Depth first, children in the order in which the ray enters their boxes. What is entered after the nearest hit so far
// is left out; what is entered there is not, since a lower polygon may be hit there as well. Large trees are beyond the
// processor's nearer caches, so that what is entered is fetched ahead, and a leaf's faces before its triangles are
// tested.
std::optional<RayHit> RayQuery::nearest(WideTree& tree, const Ray& ray) {
  assert(is_usable(ray));
  std::optional<RayHit> nearest;
  WideRay wide(tree, ray);
  if (!wide.reaches_tree()) return nearest;
  Entries entries;
  stack_.clear();
  stack_.push_back({WideTree::kRoot, tree.peek(WideTree::kRoot), wide.first});
  while (!stack_.empty()) {
    const Visit visit = stack_.back();
    stack_.pop_back();
    if (visit.entry > wide.last) continue;
    const Ref ref = visit.ref.kind() == Ref::kPending ? tree.at(visit.place) : visit.ref;
    if (ref.kind() == Ref::kNode) {
      counters_.bv_tests += WideTree::kWidth;
      const WideTree::Node& node = tree.node(ref.index());
      const auto first = static_cast<std::ptrdiff_t>(stack_.size());
      for (std::uint32_t bits = test_ray_node(node, wide, entries); bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(bits));
        const Visit child{WideTree::child_slot(ref, i), node.children[i], entries[i]};
        fetch_ahead(tree, child.ref);
        auto at = stack_.insert(stack_.end(), child);  // a few: sorted as they come, the nearest last
        for (; at != stack_.begin() + first && (at - 1)->entry < child.entry; --at) *at = *(at - 1);
        *at = child;
      }
      continue;
    }
    assert(ref.kind() == Ref::kLeaf);
    const WideTree::Leaf& leaf = tree.leaf(ref.index());
    for (const std::uint32_t face : tree.faces(leaf)) __builtin_prefetch(&tree.soup().faces[face]);
    for (std::uint32_t bits = test_ray_leaf(leaf, wide); bits != 0; bits &= bits - 1) {
      const std::uint32_t face = tree.face(leaf, static_cast<std::size_t>(std::countr_zero(bits)));
      ++counters_.triangle_tests;
      const auto t = first_parameter(ray, tree.soup().triangle(face), counters_.orientation);
      if (!t || *t > ray.longest) continue;
      const RayHit hit{tree.soup().faces[face].polygon, face, *t, ray.origin + *t * ray.direction};
      if (nearest && !before(hit, *nearest)) continue;
      nearest = hit;
      wide.shorten(hit.t);
    }
  }
  assert(!nearest || (nearest->t >= 0.0 && nearest->t <= ray.longest));
  return nearest;
}

}  // namespace peerd::collision
