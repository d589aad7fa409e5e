#pragma once
#include <cstdint>
#include <vector>

#include "collision/contact/deforming_contact.hpp"
#include "collision/tree/wide_tree.hpp"
#include "core/transform.hpp"

namespace peerd::collision {

// The part of a large soup that can matter in a step: those of its triangles that come near a box, as a SoupStep. Its
// tree is built only where it is near, and only the corners of those triangles are computed.
//
// The soup is moved as a whole, from its places under one map to those under another: rigid poses, or with scale and
// shear. Between them each corner moves along a straight line; what lies between a chord and the arc of a body that
// turns is for the caller to bound. An object keeps its memory.
class RigidStep {
 public:
  // The maps take the soup's frame to the world; places are as binary64 rounds multiply(m.linear, p) + m.offset. `near`
  // is a box of the world: all that the other soup sweeps, and the margin.
  void gather(WideTree& tree, const Affine& world_at_begin, const Affine& world_at_end, const WorldBox& near);

  // The triangles that were gathered, in the order of the soup's faces, with the soup's polygons. Valid until the next
  // gather().
  [[nodiscard]] SoupStep step() const { return {at_begin_, at_end_, faces_}; }
  // The soup's face that a face of step() is.
  [[nodiscard]] std::uint32_t face_of_soup(std::uint32_t face) const { return of_soup_[face]; }

 private:
  std::vector<std::uint32_t> of_soup_;
  std::vector<Vec3> at_begin_, at_end_;  // three for each face, in its order
  std::vector<TriangleSoup::Face> faces_;
};

// The box of all that the faces of a soup sweep, and a margin on each side [m], rounded outwards.
[[nodiscard]] WorldBox swept_box(const SoupStep& soup, double margin_m);

}  // namespace peerd::collision
