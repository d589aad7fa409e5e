#pragma once
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "core/scene.hpp"
#include "core/vrml/diagnostics.hpp"

namespace peerd {

struct ReadStatistics {
  std::size_t nodes = 0;               // written in the text, of any type
  std::size_t instances = 0;           // a USE counts again
  std::size_t shapes = 0;              // instances that are Shapes
  std::size_t meshes = 0;              // geometry with polygons, stored once however often it is USEd
  std::size_t polygons = 0;            // of the meshes
  std::size_t vertices = 0;            // of the meshes
  std::size_t polygons_instanced = 0;  // of the Shapes: a USE counts again
  std::size_t interests = 0;           // pairs of collider and collidee
  std::size_t cannot_collide_yet = 0;  // Shapes whose geometry is kept but has no polygons yet
};

struct ReadResult {
  std::optional<Scene> scene;           // there exactly where no diagnostic is an error
  std::vector<Diagnostic> diagnostics;  // in the order of the text
  ReadStatistics statistics;
};

// Reads a VRML97 world with the seed's extensions (ISO/IEC 14772-1; seed, appendix C). A pure function of the text: no
// file is opened. Reports all problems in one pass. Linear in the text; memory is a small multiple of it.
[[nodiscard]] ReadResult read_world(std::string_view text);

}  // namespace peerd
