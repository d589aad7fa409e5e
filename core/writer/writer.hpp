#pragma once
#include <expected>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/writer/write_options.hpp"

namespace peerd {

struct WrittenWorld {
  std::string text;                // VRML97, "#VRML V2.0 utf8"
  std::vector<std::string> notes;  // names and ROUTEs that had to change, one sentence each
};

// Writes a world as one text that reads back the same, as difference() in core/writer/scene_difference.hpp understands
// it; read and written again it is the same text. PROTOs stand expanded. The nodes beside the first node of their
// bodies (interpolators, Scripts, CollisionInterests, ..) stand behind the scene: nodes that would be seen or heard
// there, in a field of a Script, where nothing shows them. A WorldInfo in front says so where TimeSensors have times
// that edits have set, which a file cannot have otherwise. URLs stay as they are, relative to the file that they stood
// in. The function refuses worlds that no reader takes: nodes nested too deep once PROTOs are expanded. Linear time.
[[nodiscard]] std::expected<WrittenWorld, std::string> write_world(const Scene& scene,
                                                                   const WriteOptions& options = {});

}  // namespace peerd
