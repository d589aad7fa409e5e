// Any bytes as a file of each format: the reader must end, say one sentence or give a scene that keeps
// core/scene/scene.hpp's word and a document that keeps core/vrml/document.hpp's. Each reader has a target of its own,
// by the file's name (PEERD_FUZZED_NAME), which counts where the content leaves the format open. Buffers, images and
// materials of any name are the same few bytes.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/geometry/tessellate.hpp"
#include "core/motion/inert_parts.hpp"
#include "core/scene/reader.hpp"
#include "core/writer/writer.hpp"
#include "tests/core/document_violation.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using peerd::fuzz::require;

peerd::ReadOptions options_for(std::size_t size) {
  peerd::ReadOptions options;
  options.name = PEERD_FUZZED_NAME;
  options.conversion = {.metres_per_unit = size % 2 == 0 ? 0.001 : 1.0, .z_up = size % 2 == 0};
  options.limits = {.text_bytes = 1u << 24, .nodes = 1u << 16, .instances = 1u << 16};
  options.load = [](std::string_view url, std::string_view) -> std::expected<peerd::LoadedFile, std::string> {
    return peerd::LoadedFile{std::string(url), "newmtl a\nKd 1 0 0\nmap_Kd a.png\n"};
  };
  return options;
}

void check(const peerd::Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.polygon_count(); ++i) {
    for (const std::int32_t corner : mesh.polygon(i)) {
      require(corner >= 0 && static_cast<std::size_t>(corner) < mesh.vertices.size());
    }
  }
  for (const auto& v : mesh.vertices) require(std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  peerd::ReadResult result = peerd::read_world(bytes, options_for(size));
  warn_of_inert_parts(result);
  const bool error =
      std::ranges::any_of(result.diagnostics, [](const auto& d) { return d.severity == peerd::Severity::kError; });
  require(error != result.scene.has_value());
  for (const peerd::Diagnostic& d : result.diagnostics) {
    require(d.offset <= result.sources.at(d.source).text.size());
    require(!render(result, d).empty());
  }
  if (!result.scene) return 0;
  const peerd::Scene& scene = *result.scene;
  require(peerd::vrml::document_violation(*scene.document).empty());
  for (const peerd::Geometry& geometry : scene.geometries) {
    const peerd::MeshSize built = mesh_size(geometry, scene.tessellation);
    if (built.polygons < 10000) check(build_mesh(geometry, scene.tessellation));
  }
  const auto count = static_cast<std::uint32_t>(scene.instances.size());
  for (std::uint32_t i = 0; i < std::min(count, 64u); ++i) {
    require(scene.find(scene.path_of(peerd::ObjectId{i})) == peerd::ObjectId{i});
  }
  // A world of another format is one of VRML97, too.
  if (count < 4096) {
    const auto written = write_world(scene);
    require(!written || peerd::read_world(written->text).scene.has_value());
  }
  return 0;
}
