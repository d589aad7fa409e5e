#include "peerd/cli/commands/export_command.hpp"

#include <cstdint>
#include <filesystem>
#include <ostream>

#include <nlohmann/json.hpp>

#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/view/picture/gltf_writer.hpp"
#include "peerd/view/picture/scene_picture.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t triangles_of(const view::ScenePicture& drawn) {
  std::uint64_t count = 0;
  for (const view::DrawnShape& shape : drawn.shapes) {
    if (shape.mesh == view::DrawnShape::kNoMesh) continue;
    const view::DrawnGeometry& geometry = drawn.geometries[drawn.meshes[shape.mesh].geometry];
    if (geometry.mode == view::DrawnGeometry::Mode::kTriangles) count += geometry.corners.size() / 3;
  }
  return count;
}

// Names the parts that glTF has no words for: peerd's own page shows them, by the file's extras, and other programs do
// not.
void name_what_others_miss(view::ScenePicture& drawn, const Scene& scene) {
  using Kind = view::DrawnGroup::Kind;
  const auto name = [&](ObjectId id, const char* what, const char* why) {
    drawn.undrawn.push_back({scene.path_of(id), what, why, 1});
  };
  for (const view::DrawnGroup& group : drawn.groups) {
    if (group.kind == Kind::kBillboard) name(group.id, "Billboard", "other programs do not turn it");
    if (group.kind == Kind::kAnchor) name(group.id, "Anchor", "other programs do not follow it");
  }
  for (const view::DrawnShape& shape : drawn.shapes) {
    if (shape.text) name(shape.id, "Text", "other programs do not draw it");
  }
}

Json to_json(const view::Undrawn& undrawn) {
  return {{"path", undrawn.path}, {"what", undrawn.what}, {"why", undrawn.why}, {"count", undrawn.count}};
}

void print_text(const view::ScenePicture& drawn, const ExportOptions& options, std::size_t bytes, std::ostream& out) {
  out << options.gltf << ": " << counted(bytes, "byte") << "; " << counted(drawn.shapes.size(), "Shape") << " of "
      << counted(drawn.meshes.size(), "mesh", "meshes") << ", " << counted(triangles_of(drawn), "triangle") << "; "
      << counted(drawn.nodes.size() - 1, "node moves", "nodes move") << " by themselves\n";
  for (std::size_t i = 0; i < drawn.undrawn.size(); ++i) {
    if (i == kShownProblems) {
      out << "  .. and " << drawn.undrawn.size() - i << " more; --json names them\n";
      break;
    }
    const view::Undrawn& u = drawn.undrawn[i];
    out << "  " << (u.path.empty() ? u.what : u.path + " (" + u.what + ")") << ": " << u.why;
    if (u.count > 1) out << ", and " << u.count - 1 << " more";
    out << '\n';
  }
}

}  // namespace

int run_export(const std::string& path, const ExportOptions& options, std::ostream& out, std::ostream& err) {
  std::ostream* const json = options.json ? &out : nullptr;
  const auto file = open_world(path, options.reading, err, json);
  if (!file) return file.error();
  const Scene& scene = *(*file)->result.scene;
  auto input = view::input_at(scene, options.at_s, std::filesystem::path(path).filename().string(),
                              view::images_of(local_files(view::kImage_bytes), path));
  input.all_levels = false;  // glTF has no words for levels: other programs would show them all at once
  auto drawn = view::picture_of(input);
  name_what_others_miss(drawn, scene);
  const auto written = view::write_glb(drawn);
  if (!written) return print_error({path + ": error: " + written.error(), 1}, err, json);
  if (const auto kept = write_text_file(options.gltf, *written); !kept) return print_error(kept.error(), err, json);
  if (!options.json) {
    print_text(drawn, options, written->size(), out);
    return 0;
  }
  Json undrawn = Json::array();
  for (const view::Undrawn& each : drawn.undrawn) undrawn.push_back(to_json(each));
  const Json all = {{"world", path},
                    {"time_s", options.at_s},
                    {"file", options.gltf},
                    {"bytes", written->size()},
                    {"nodes", drawn.nodes.size()},
                    {"shapes", drawn.shapes.size()},
                    {"meshes", drawn.meshes.size()},
                    {"triangles", triangles_of(drawn)},
                    {"images", drawn.images.size()},
                    {"lights", drawn.lights.size()},
                    {"viewpoints", drawn.viewpoints.size()},
                    {"undrawn", std::move(undrawn)}};
  out << json_text(all) << '\n';
  return 0;
}

}  // namespace peerd
