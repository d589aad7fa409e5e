#pragma once
#include <string_view>

#include "core/formats/draft/reading.hpp"

namespace peerd::formats::gltf {

// Reads a glTF 2.0 file. Each node of its scene becomes a Transform of the node's name, whose children are the Shapes
// of the node's mesh, a Viewpoint or a light, and the Transforms of the nodes below it.
bool read_gltf(std::string_view json, Reading& reading);
bool read_glb(std::string_view bytes, Reading& reading);

}  // namespace peerd::formats::gltf
