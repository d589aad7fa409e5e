#include "collision/wide_query.hpp"

#include <algorithm>
#include <bit>

#include "collision/triangle_distance.hpp"
#include "collision/wide_overlap.hpp"

namespace peerd::collision {

using Ref = WideTree::Ref;

namespace {

PolygonPair polygons(const WideTree& a, const WideTree& b, const FacePair& faces) {
  return {a.soup().faces[faces.a].polygon, b.soup().faces[faces.b].polygon};
}

}  // namespace

// Depth first, children in their order. What the kernels let through beyond what touches costs time and changes no
// answer, and it changes no order: so the first pair found is the first that there is.
template <class Test>
bool WideQuery::descend(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, double room_m, Test test) {
  const WideMotion motion(a, b, a_from_b, room_m);
  Masks masks;
  const auto for_bits_downwards = [](std::uint32_t bits, auto&& then) {
    while (bits != 0) {
      const auto i = static_cast<std::size_t>(std::bit_width(bits) - 1);
      bits ^= 1u << i;
      then(i);
    }
  };
  const auto test_triangles = [&](const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b) {
    test_leaves(leaf_a, leaf_b, motion, masks);
    for (std::size_t row = 0; row < leaf_b.count; ++row) {
      if (masks[row] == 0) continue;
      const Triangle in_b = b.soup().triangle(leaf_b.faces[row]);
      const Triangle moved = {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])};
      for (std::uint32_t bits = masks[row]; bits != 0; bits &= bits - 1) {
        const std::uint32_t face_a = leaf_a.faces[static_cast<std::size_t>(std::countr_zero(bits))];
        ++counters_.triangle_tests;
        if (test(FacePair{face_a, leaf_b.faces[row]}, moved)) return true;
      }
    }
    return false;
  };

  stack_.clear();
  stack_.emplace_back(WideTree::kRoot, WideTree::kRoot);
  while (!stack_.empty()) {
    const auto [place_a, place_b] = stack_.back();
    stack_.pop_back();
    const Ref of_a = a.at(place_a), of_b = b.at(place_b);
    const bool node_a = of_a.kind() == Ref::kNode, node_b = of_b.kind() == Ref::kNode;
    if (node_a && node_b) {
      counters_.bv_tests += 64;
      test_nodes(a.node(of_a.index()), b.node(of_b.index()), motion, masks);
      for (std::size_t row = WideTree::kWidth; row-- > 0;) {
        for_bits_downwards(masks[row], [&](std::size_t i) {
          stack_.emplace_back(WideTree::place(of_a, i), WideTree::place(of_b, row));
        });
      }
    } else if (node_a) {
      counters_.bv_tests += 8;
      for_bits_downwards(test_node_leaf(a.node(of_a.index()), b.leaf(of_b.index()), motion),
                         [&](std::size_t i) { stack_.emplace_back(WideTree::place(of_a, i), place_b); });
    } else if (node_b) {
      counters_.bv_tests += 8;
      for_bits_downwards(test_leaf_node(a.leaf(of_a.index()), b.node(of_b.index()), motion),
                         [&](std::size_t i) { stack_.emplace_back(place_a, WideTree::place(of_b, i)); });
    } else if (test_triangles(a.leaf(of_a.index()), b.leaf(of_b.index()))) {
      return true;
    }
  }
  return false;
}

bool WideQuery::find_pair(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, PolygonPair& pair) {
  return descend(a, b, a_from_b, 0.0, [&](const FacePair& faces, const Triangle& of_b) {
    if (!touch(a.soup().triangle(faces.a), of_b, counters_.orientation)) return false;
    pair = polygons(a, b, faces);
    return true;
  });
}

const std::vector<PolygonPair>& WideQuery::all_pairs(WideTree& a, WideTree& b, const RelativeMotion& a_from_b) {
  pairs_.clear();
  (void)descend(a, b, a_from_b, 0.0, [&](const FacePair& faces, const Triangle& of_b) {
    if (touch(a.soup().triangle(faces.a), of_b, counters_.orientation)) pairs_.push_back(polygons(a, b, faces));
    return false;
  });
  std::ranges::sort(pairs_);
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  return pairs_;
}

const std::vector<FacePair>& WideQuery::faces_within(WideTree& a, WideTree& b, const RelativeMotion& a_from_b,
                                                     double distance_m) {
  faces_.clear();
  (void)descend(a, b, a_from_b, distance_m, [&](const FacePair& faces, const Triangle& of_b) {
    if (triangle_distance(a.soup().triangle(faces.a), of_b).distance <= distance_m) faces_.push_back(faces);
    return false;
  });
  std::ranges::sort(faces_);
  return faces_;
}

}  // namespace peerd::collision
