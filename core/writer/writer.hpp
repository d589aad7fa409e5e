#pragma once
#include <expected>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/writer/write_options.hpp"

namespace peerd {

struct WrittenWorld {
  std::string text;                // VRML97, "#VRML V2.0 utf8"
  std::vector<std::string> notes;  // what could not stay as it was: names and ROUTEs, one sentence each
};

// A world as one text that reads back the same, as difference() in core/writer/scene_difference.hpp understands it;
// read and written again it is the same text. PROTOs stand expanded. What their bodies hold beside the first node
// (interpolators, Scripts, CollisionInterests, ..) stands behind the scene: nodes that would be seen or heard there, in
// a field of a Script, where nothing shows them. URLs stay as they are, relative to the file that they stood in.
// Refuses what no reader takes: nodes nested too deep once PROTOs are expanded. Linear time.
[[nodiscard]] std::expected<WrittenWorld, std::string> write_world(const Scene& scene,
                                                                   const WriteOptions& options = {});

}  // namespace peerd
