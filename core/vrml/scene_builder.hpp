#pragma once
#include "core/scene.hpp"
#include "core/vrml/node_tree.hpp"

namespace peerd::vrml {

// A world of more instances is refused: a few lines of nested USE can name billions.
inline constexpr std::uint64_t kMaxInstances = 1u << 20;

// The nodes of `text` as a scene. Reports what the parser could not know: indices, names, depth and number of
// instances. The scene counts only where `problems` has no error.
[[nodiscard]] Scene build_scene(const NodeTree& tree, std::string_view text, Problems& problems);

}  // namespace peerd::vrml
