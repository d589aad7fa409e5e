#pragma once
#include <expected>
#include <string>

#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd::view {

// Returns the picture as glTF 2.0 binary. docs/reference/gateway.md says which node is what, and what extras there are.
// Colours become linear, as glTF has them; those in extras stay as the file has them. The error says that the picture
// is larger than such a file can be (4 GiB).
[[nodiscard]] std::expected<std::string, std::string> write_glb(const ScenePicture& picture);

}  // namespace peerd::view
