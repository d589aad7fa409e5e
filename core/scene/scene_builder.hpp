#pragma once
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/scene/around.hpp"
#include "core/scene/scene.hpp"
#include "core/vrml/document.hpp"
#include "core/vrml/file_loader.hpp"

namespace peerd::vrml {

// What the nodes of an edited document have been bound to, when names in them could be read: by their index.
struct Bindings {
  LastingIds<ObjectId> ids;                                     // of the instances that will be there
  std::map<std::uint32_t, CollisionInterest> interests;         // CollisionInterests; others ask for nothing
  std::map<std::uint32_t, std::optional<ObjectId>> recipients;  // of KeySensors; others are left out
  std::map<std::uint32_t, std::string> bases;                   // of Inlines that have not been read
};

// Builds a scene of the nodes of a document. Reports mistakes that the parser could not know of: indices, names, depth
// and number of instances. The scene counts only where `problems` has no error.
[[nodiscard]] Scene build_scene(const std::shared_ptr<const Document>& document, const Tessellation& tessellation,
                                const ReadLimits& limits, Problems& problems, const Around& around = {});
// The same of an edited document, whose texts have been found to be good. The first problem is an error of what the
// edits make of them.
[[nodiscard]] std::expected<Scene, std::string> rebuild_scene(const std::shared_ptr<const Document>& document,
                                                              const Tessellation& tessellation,
                                                              const ReadLimits& limits, const Bindings& bindings);

}  // namespace peerd::vrml
