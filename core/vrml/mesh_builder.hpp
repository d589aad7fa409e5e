#pragma once
#include <optional>
#include <string_view>

#include "core/scene.hpp"
#include "core/vrml/node_tree.hpp"

namespace peerd::vrml {

// A Box of that size about the origin: six quads, corners counter-clockwise seen from outside.
[[nodiscard]] Mesh box_mesh(const Floats& size);

// An IndexedFaceSet's polygons as they are written, neither split nor cleaned. Reports indices that are out of range
// and polygons of fewer than three corners, each where it stands in `text`; none then.
[[nodiscard]] std::optional<Mesh> indexed_face_set_mesh(const NodeTree& tree, const Node& face_set,
                                                        std::string_view text, Problems& problems);

// The floats of an MFVec3f, by three.
[[nodiscard]] std::vector<Eigen::Vector3f> to_points(const std::vector<float>& floats);

}  // namespace peerd::vrml
