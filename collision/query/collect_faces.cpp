#include "collision/query/collect_faces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::collision {
namespace {

using Ref = WideTree::Ref;

Vec3 place(const Affine& m, const Vec3& p) { return multiply(m.linear, p) + m.offset; }

bool touch(const WorldBox& a, const WorldBox& b) {
  for (int k = 0; k < 3; ++k) {
    if (a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]) return false;
  }
  return true;
}

// The places to which one map takes the boxes of a tree's nodes. Each side is outwards by a bound of all rounding: of
// the tree, whose binary32 coordinates are off by 2^-23 of its extent, twice (a center and a half side); and of places
// in binary64, that of a box as that of a corner, some ten times 2^-53 of |linear| |p| + |offset| each.
class PlacedBoxes {
 public:
  PlacedBoxes(const WideTree& tree, const Affine& map)
      : map_(map), origin_(tree.origin()), from_tree_(1.0 / tree.scale()), sizes_(map.linear.cwiseAbs()) {
    const Vec3 tree_slack = Vec3::Constant(0x1p-21 * tree.extent_m());
    const Vec3 farthest = origin_.cwiseAbs() + Vec3::Constant(tree.extent_m());
    slack_ = multiply(sizes_, tree_slack) + 0x1p-46 * (multiply(sizes_, farthest) + map.offset.cwiseAbs()) +
             Vec3::Constant(0x1p-1000);
  }
  void merge(const WideTree::Node& node, std::size_t child, WorldBox& box) const {
    const auto of_child = [&](const auto& axes) {
      return Vec3(from_tree_ * Vec3(axes[0][child], axes[1][child], axes[2][child]));
    };
    const Vec3 center = place(map_, origin_ + of_child(node.center));
    const Vec3 half = multiply(sizes_, of_child(node.half)) + slack_;
    assert(half.minCoeff() >= 0.0);
    box.merge(WorldBox{center - half, center + half});
  }

 private:
  const Affine& map_;
  Vec3 origin_, slack_;
  double from_tree_;
  Mat3 sizes_;  // the absolute values of the linear part
};

class Collection {
 public:
  Collection(WideTree& tree, const Affine& at_begin, const Affine& at_end, const WorldBox& box,
             std::vector<std::uint32_t>& faces)
      : tree_(tree),
        at_begin_(at_begin),
        at_end_(at_end),
        boxes_at_begin_(tree, at_begin),
        boxes_at_end_(tree, at_end),
        box_(box),
        faces_(faces) {}

  // Trees of meshes are some ten nodes deep. A split leaves 15/16 of an axis's spread at most, so binary32 allows a few
  // thousand for triangles that were placed to that end.
  void visit(WideTree::ChildSlot slot) {
    const Ref ref = tree_.at(slot);
    if (ref.kind() == Ref::kLeaf) {
      visit_leaf(tree_.leaf(ref.index()));
      return;
    }
    assert(ref.kind() == Ref::kNode);
    for (std::size_t child = 0; child < WideTree::kWidth; ++child) {
      const WideTree::Node& node = tree_.node(ref.index());
      if (node.children[child].kind() == Ref::kNone) continue;
      WorldBox swept;
      boxes_at_begin_.merge(node, child, swept);
      boxes_at_end_.merge(node, child, swept);
      if (touch(swept, box_)) visit(WideTree::child_slot(ref, child));
    }
  }

 private:
  void visit_leaf(const WideTree::Leaf& leaf) {
    for (const std::uint32_t face : tree_.faces(leaf)) {
      WorldBox swept;
      for (const Vec3& corner : tree_.soup().triangle(face)) {
        swept.merge(place(at_begin_, corner));
        swept.merge(place(at_end_, corner));
      }
      if (touch(swept, box_)) faces_.push_back(face);
    }
  }

  WideTree& tree_;
  const Affine &at_begin_, &at_end_;
  PlacedBoxes boxes_at_begin_, boxes_at_end_;
  const WorldBox& box_;
  std::vector<std::uint32_t>& faces_;
};

}  // namespace

void collect_moving_faces(WideTree& tree, const Affine& at_begin, const Affine& at_end, const WorldBox& box,
                          std::vector<std::uint32_t>& faces) {
  faces.clear();
  if (box.is_empty()) return;
  Collection(tree, at_begin, at_end, box, faces).visit(WideTree::kRoot);
  std::ranges::sort(faces);
  assert(std::ranges::adjacent_find(faces) == faces.end());
}

void collect_faces(WideTree& tree, const WorldBox& box, std::vector<std::uint32_t>& faces) {
  const Affine here;
  collect_moving_faces(tree, here, here, box, faces);
}

}  // namespace peerd::collision
