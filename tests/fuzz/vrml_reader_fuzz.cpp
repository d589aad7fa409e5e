// Any bytes at all: the reader must end, say where each problem is, and give a scene that keeps core/scene.hpp's word.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/vrml/reader.hpp"

namespace {

// Not assert: it must hold in every build.
void require(bool condition) {
  if (!condition) std::abort();
}

void check(const peerd::Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.polygon_count(); ++i) {
    require(!mesh.polygon(i).empty());
    for (const std::int32_t corner : mesh.polygon(i)) {
      require(corner >= 0 && static_cast<std::size_t>(corner) < mesh.vertices.size());
    }
  }
  for (const auto& v : mesh.vertices) require(std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()));
}

void check(const peerd::Scene& scene, std::uint32_t i) {
  const peerd::Instance& instance = scene.instances[i];
  require(instance.subtree_end > i && instance.subtree_end <= scene.instances.size());
  require(instance.parent < static_cast<std::int32_t>(i));
  require(instance.parent < 0 || instance.subtree_end <= scene.instances[instance.parent].subtree_end);
  require(std::abs(scene.transform({i}).rotation.norm() - 1.0) < 1e-12);
}

// Quadratic, so for some instances only.
void check_paths(const peerd::Scene& scene, std::uint32_t i) {
  const peerd::ObjectId id{i};
  require(scene.find(scene.path_of(id)) == id);
  const peerd::Pose pose = scene.rigid_pose(id);
  const peerd::Vec3 origin = scene.world_from_local(id).translation();
  require(pose.position == origin || !origin.allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const peerd::ReadResult result = peerd::read_world(text);
  const bool error =
      std::ranges::any_of(result.diagnostics, [](const auto& d) { return d.severity == peerd::Severity::kError; });
  require(error != result.scene.has_value());
  for (const peerd::Diagnostic& d : result.diagnostics) {
    require(d.where.line > 0 && d.where.column > 0 && d.offset <= result.sources.at(d.source).text.size());
    require(!render(result, d).empty());
  }
  if (!result.scene) return 0;
  const peerd::Scene& scene = *result.scene;
  for (const peerd::Geometry& geometry : scene.geometries) {
    // Grids and extrusions of a short text may be large; the reader has not built them, and nobody has asked.
    const peerd::MeshSize size_built = mesh_size(geometry, scene.tessellation);
    if (size_built.polygons < 10000) check(build_mesh(geometry, scene.tessellation));
  }
  const auto count = static_cast<std::uint32_t>(scene.instances.size());
  for (std::uint32_t i = 0; i < count; ++i) check(scene, i);
  for (std::uint32_t i = 0; i < std::min(count, 64u); ++i) check_paths(scene, i);
  for (const peerd::CollisionInterest& interest : scene.interests) {
    require(interest.collider.value < count);
    for (const peerd::ObjectId id : interest.collidees) require(id.value < count && id != interest.collider);
  }
  return 0;
}
