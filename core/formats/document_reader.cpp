#include "core/formats/document_reader.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "core/formats/draft/reading.hpp"
#include "core/formats/gltf/gltf_reader.hpp"
#include "core/formats/mesh/obj_reader.hpp"
#include "core/formats/mesh/off_reader.hpp"
#include "core/formats/mesh/ply_reader.hpp"
#include "core/formats/mesh/stl_reader.hpp"
#include "core/formats/world_kind.hpp"
#include "core/parser/parser.hpp"

namespace peerd::formats {
namespace {

bool is_binary(WorldKind kind, std::string_view bytes) {
  if (kind == WorldKind::kPly) return bytes.substr(0, 64).find("format binary") != std::string_view::npos;
  return kind == WorldKind::kStlBinary || kind == WorldKind::kGltf || kind == WorldKind::kGlb;
}

bool read(WorldKind kind, std::string_view bytes, Reading& reading) {
  switch (kind) {
    case WorldKind::kObj:
      return read_obj(bytes, reading);
    case WorldKind::kStlText:
      return read_stl_text(bytes, reading);
    case WorldKind::kStlBinary:
      return read_stl_binary(bytes, reading);
    case WorldKind::kPly:
      return read_ply(bytes, reading);
    case WorldKind::kOff:
      return read_off(bytes, reading);
    case WorldKind::kGltf:
      return gltf::read_gltf(bytes, reading);
    case WorldKind::kGlb:
      return gltf::read_glb(bytes, reading);
    case WorldKind::kVrml:
    case WorldKind::kX3d:
    case WorldKind::kX3dClassic:
      break;
  }
  return true;
}

// Reads a file of a format that is neither VRML97 nor X3D, and counts in `so_far` what it asks for.
std::shared_ptr<vrml::Document> read_as(WorldKind kind, Source world, vrml::Problems& problems,
                                        const vrml::ParseOptions& options, Expansion& so_far) {
  auto document = std::make_shared<vrml::Document>();
  const std::string_view bytes = world.text;
  world.kind = is_binary(kind, bytes) ? TextKind::kBinary : TextKind::kLines;
  const std::uint64_t taken = std::min(problems.bytes(), options.limits.text_bytes);
  const bool fits = bytes.size() <= options.limits.text_bytes - taken;
  const std::string name = taken == 0 ? "it" : vrml::quoted(world.name);
  if (!fits) world.text = {};
  const auto begin = problems.open(std::move(world));
  if (!begin || !fits) {
    problems.error(0, name + " is larger than " + std::to_string(options.limits.text_bytes - taken) +
                          " bytes, more than this reader takes");
    return document;
  }
  Reading reading(*document, problems, options, *begin, so_far);
  static_cast<void>(read(kind, bytes, reading));  // what is wrong is an error in `problems`
  so_far[static_cast<std::size_t>(Asked::kNodes)] += document->nodes.size();
  reading.report_losses();
  return document;
}

// Reads a file that an Inline names. The WorldInfo that says how times count is taken off: the world around the file
// says that.
std::shared_ptr<const vrml::Document> read_inlined(Source& file, vrml::Problems& problems,
                                                   const vrml::ParseOptions& options, Expansion& so_far) {
  const WorldKind kind = kind_of(file.text, file.name);
  if (is_text_of_nodes(kind)) return nullptr;
  const std::size_t errors = problems.errors();
  auto document = read_as(kind, std::move(file), problems, options, so_far);
  if (problems.errors() > errors) return std::make_shared<vrml::Document>();
  if (!document->nodes.empty() && document->nodes.back().type->name == "WorldInfo") {
    document->nodes.pop_back();
    document->top_level.pop_back();
  }
  return document;
}

}  // namespace

std::shared_ptr<vrml::Document> read_document(Source world, vrml::Problems& problems,
                                              const vrml::ParseOptions& options) {
  Expansion so_far{};
  const WorldKind kind = kind_of(world.text, world.name);
  if (!is_text_of_nodes(kind)) return read_as(kind, std::move(world), problems, options, so_far);
  return vrml::parse(std::move(world), problems, options,
                     [&so_far](Source& file, vrml::Problems& reported, const vrml::ParseOptions& asked) {
                       return read_inlined(file, reported, asked, so_far);
                     });
}

}  // namespace peerd::formats
