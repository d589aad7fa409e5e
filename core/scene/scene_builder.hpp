#pragma once
#include <memory>

#include "core/scene/scene.hpp"
#include "core/vrml/document.hpp"
#include "core/vrml/file_loader.hpp"

namespace peerd::vrml {

// Builds a scene of the nodes of a document. Reports mistakes that the parser could not know of: indices, names, depth
// and number of instances. The scene counts only where `problems` has no error.
[[nodiscard]] Scene build_scene(const std::shared_ptr<const Document>& document, const Tessellation& tessellation,
                                const ReadLimits& limits, Problems& problems);

}  // namespace peerd::vrml
