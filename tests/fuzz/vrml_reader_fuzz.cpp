// Any bytes at all: the reader must end, say where each problem is, and give a scene that keeps core/scene/scene.hpp's
// word and a document that keeps core/vrml/document.hpp's. The input is a world and the files that it may name: what
// stands behind the first separator is "1.wrl", behind the next "2.wrl", and so on; the world itself is "0.wrl".
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/tessellate.hpp"
#include "core/motion/inert_parts.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/reader.hpp"
#include "tests/core/document_violation.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using peerd::fuzz::require;

constexpr std::string_view kSeparator = "\n@@@@\n";

std::vector<std::string_view> files_in(std::string_view input) {
  std::vector<std::string_view> files;
  while (true) {
    const std::size_t end = input.find(kSeparator);
    files.push_back(input.substr(0, end));
    if (end == std::string_view::npos) return files;
    input.remove_prefix(end + kSeparator.size());
  }
}

peerd::ReadOptions options_for(const std::vector<std::string_view>& files) {
  peerd::ReadOptions options;
  options.name = "0.wrl";
  options.limits = {.text_bytes = 1u << 24, .nodes = 1u << 16, .instances = 1u << 16};
  options.load = [&files](std::string_view url, std::string_view) -> std::expected<peerd::LoadedFile, std::string> {
    for (std::size_t i = 0; i < files.size(); ++i) {
      const std::string name = std::to_string(i) + ".wrl";
      if (url == name) return peerd::LoadedFile{name, std::string(files[i])};
    }
    return std::unexpected("no such file");
  };
  return options;
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
  require(std::abs(scene.transform(peerd::ObjectId{i}).rotation.norm() - 1.0) < 1e-12);
}

// Quadratic, so for some instances only.
void check_paths(const peerd::Scene& scene, std::uint32_t i) {
  const peerd::ObjectId id{i};
  require(scene.find(scene.path_of(id)) == id);
  const peerd::Pose pose = scene.rigid_pose(id);
  const peerd::Vec3 origin = scene.world_from_local(id).translation();
  require(pose.position == origin || !origin.allFinite());
}

// Instances that move by themselves are where PredefinedMotion says, whichever way time is asked for.
void check_movement(const peerd::Scene& scene) {
  peerd::PredefinedMotion motion(scene), back(scene);
  for (const peerd::ObjectId id : motion.driven_transforms()) {
    for (const double t : {0.0, 0.3, 1.0, 1.7, 1e6}) (void)motion.transform(id, t);
    for (const double t : {1e6, 1.7}) (void)back.transform(id, t);
    const peerd::Affine there = parent_from_local(motion.transform(id, 1.0));
    const peerd::Affine again = parent_from_local(back.transform(id, 1.0));
    const bool same = there.linear == again.linear && there.offset == again.offset;
    require(same || !(there.offset.allFinite() && there.linear.allFinite()));
    const auto piece = motion.piece(id, 1.0);
    require(piece.begin_s <= 1.0 && 1.0 < piece.end_s);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto files = files_in({reinterpret_cast<const char*>(data), size});
  peerd::ReadResult result = peerd::read_world(files[0], options_for(files));
  warn_of_inert_parts(result);
  const bool error =
      std::ranges::any_of(result.diagnostics, [](const auto& d) { return d.severity == peerd::Severity::kError; });
  require(error != result.scene.has_value());
  for (const peerd::Diagnostic& d : result.diagnostics) {
    require(d.where.line > 0 && d.where.column > 0 && d.offset <= result.sources.at(d.source).text.size());
    require(!render(result, d).empty());
  }
  if (!result.scene) return 0;
  const peerd::Scene& scene = *result.scene;
  require(peerd::vrml::document_violation(*scene.document).empty());
  for (const peerd::Geometry& geometry : scene.geometries) {
    // Grids and extrusions of a short text may be large; the reader has not built them, and nobody has asked.
    const peerd::MeshSize size_built = mesh_size(geometry, scene.tessellation);
    if (size_built.polygons < 10000) check(build_mesh(geometry, scene.tessellation));
  }
  const auto count = static_cast<std::uint32_t>(scene.instances.size());
  for (std::uint32_t i = 0; i < count; ++i) check(scene, i);
  for (std::uint32_t i = 0; i < std::min(count, 64u); ++i) check_paths(scene, i);
  for (const peerd::CollisionInterest& interest : scene.interests) {
    for (const auto* const side : {&interest.colliders, &interest.collidees}) {
      for (const peerd::ObjectId id : side->ends) require(id.number < count);
      require(side->named <= side->ends.size());
      if (side->patterns.empty()) require(side->named == side->ends.size());
    }
  }
  for (const peerd::KeySensor& sensor : scene.key_sensors)
    require(!sensor.recipient || sensor.recipient->number < count);
  require(scene.pending_inlines.empty());  // nothing was asked to be read later
  if (count < 4096) check_movement(scene);
  return 0;
}
