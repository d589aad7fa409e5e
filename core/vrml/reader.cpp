#include "core/vrml/reader.hpp"

#include "core/vrml/lexer.hpp"
#include "core/vrml/parser.hpp"
#include "core/vrml/scene_builder.hpp"

namespace peerd {
namespace {

constexpr std::size_t kMaxTextBytes = std::size_t{1} << 31;  // places, indices and ids are 32 bits wide

ReadStatistics statistics_of(const Scene& scene) {
  ReadStatistics s;
  s.instances = scene.instances.size();
  s.meshes = scene.meshes.size();
  for (const Mesh& mesh : scene.meshes) {
    s.polygons += mesh.polygon_count();
    s.vertices += mesh.vertices.size();
  }
  for (const Instance& instance : scene.instances) {
    if (instance.kind != NodeKind::kShape) continue;
    ++s.shapes;
    if (instance.mesh >= 0)
      s.polygons_instanced += scene.meshes[static_cast<std::size_t>(instance.mesh)].polygon_count();
    if (!instance.unsupported_geometry.empty()) ++s.cannot_collide_yet;
  }
  for (const CollisionInterest& interest : scene.interests) s.interests += interest.collidees.size();
  return s;
}

}  // namespace

ReadResult read_world(std::string_view text) {
  ReadResult result;
  vrml::Problems problems;
  const auto begin = text.size() <= kMaxTextBytes
                         ? vrml::read_header(text)
                         : std::unexpected("the file is larger than 2 GiB, more than this reader takes");
  if (!begin) {
    problems.error({}, begin.error());
    result.diagnostics = problems.take();
    return result;
  }
  const vrml::NodeTree tree = vrml::parse(text, *begin, problems);
  Scene scene = vrml::build_scene(tree, text, problems);
  result.statistics = statistics_of(scene);
  result.statistics.nodes = tree.nodes.size();
  if (problems.errors() == 0) result.scene = std::move(scene);
  result.diagnostics = problems.take();
  return result;
}

}  // namespace peerd
