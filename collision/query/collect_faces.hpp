#pragma once
#include <cstdint>
#include <vector>

#include "collision/tree/wide_tree.hpp"
#include "core/transform.hpp"

namespace peerd::collision {

// Finds the faces of a soup that touch `box` (in the soup's frame), by the boxes of their corners: exactly those, in
// ascending order. Only nodes of the tree whose boxes are near are built and visited, so that a few faces of a large
// soup cost a few nodes. `faces` keeps its memory.
void collect_faces(WideTree& tree, const WorldBox& box, std::vector<std::uint32_t>& faces);

// The same for a soup whose corners move along straight lines from their places under `at_begin` to those under
// `at_end`: a face touches the box where the box of its six places does. Places are as binary64 rounds
// multiply(m.linear, p) + m.offset. `box` is in the frame to which the two lead.
void collect_moving_faces(WideTree& tree, const Affine& at_begin, const Affine& at_end, const WorldBox& box,
                          std::vector<std::uint32_t>& faces);

}  // namespace peerd::collision
