#include "peerd/cli/lab/volumes_command.hpp"

#include <algorithm>
#include <cassert>
#include <expected>
#include <optional>
#include <ostream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "collision/scene/joined_soup.hpp"
#include "collision/scene/surfaces.hpp"
#include "collision/tree/split_rule.hpp"
#include "collision/volumes/turned_volume.hpp"
#include "peerd/cli/lab/measured_shape.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;
using collision::TriangleSoup;
using collision::engines::KdopOptions;

// More triangles than any question is answered for.
constexpr std::size_t kTrianglesMax = std::size_t{1} << 25;

std::string_view name_of(collision::SplitRule rule) {
  return std::ranges::find(collision::kSplitRuleNames, rule, &collision::SplitRuleName::rule)->name;
}

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json to_json(const OverTurns& turns, std::size_t rotations) {
  return {{"mean", turns.sum / static_cast<double>(rotations)}, {"least", turns.least}, {"greatest", turns.greatest}};
}

Json to_json(const MeasuredHierarchy& hierarchy, bool levels) {
  Json out = {{"k", hierarchy.options.k},
              {"rule", name_of(hierarchy.options.tree.rule)},
              {"threshold", hierarchy.options.tree.split_threshold},
              {"height", hierarchy.height},
              {"least_height", hierarchy.least_height},
              {"nodes", hierarchy.nodes},
              {"bytes", hierarchy.bytes},
              {"build_s", hierarchy.build_s}};
  if (levels) out["level_percent"] = hierarchy.level_percent;
  return out;
}

Json to_json(const MeasuredShape& shape, const VolumesOptions& options, std::size_t rotations) {
  Json out = {{"path", shape.path},
              {"polygons", shape.polygons},
              {"triangles", shape.triangles},
              {"vertices", shape.vertices},
              {"box", {{"lo", to_json(shape.box.lo)}, {"hi", to_json(shape.box.hi)}}},
              {"hull", nullptr},
              {"percent", nullptr}};
  if (shape.tightness) {
    const ShapeTightness& t = *shape.tightness;
    out["hull"] = {{"corners", t.hull_corners}, {"volume_m3", t.hull_m3}};
    out["percent"] = {{"18-dop", to_json(t.kdop, rotations)},
                      {"aabb", to_json(t.aabb, rotations)},
                      {"obb", t.box},
                      {"sphere", t.ball}};
    if (options.curve) out["turned"] = t.turned;
  }
  Json& hierarchies = out["hierarchies"] = Json::array();
  for (const MeasuredHierarchy& each : shape.hierarchies) hierarchies.push_back(to_json(each, options.levels));
  return out;
}

void print_text(const MeasuredShape& shape, const VolumesOptions& options, std::size_t rotations, std::ostream& out) {
  out << (shape.path.empty() ? "all Shapes" : shape.path) << ": " << counted(shape.polygons, "polygon") << ", "
      << counted(shape.triangles, "triangle") << ", " << counted(shape.vertices, "vertex", "vertices") << '\n';
  if (shape.tightness) {
    const ShapeTightness& t = *shape.tightness;
    const auto n = static_cast<double>(rotations);
    out << fmt::format(
        "  convex hull: {:.6g} m^3, {}; of it, over {}: 18-DOP {:.2f} %, AABB {:.2f} %, OBB {:.2f} %, sphere {:.2f} "
        "%\n",
        t.hull_m3, counted(t.hull_corners, "corner"), counted(rotations, "rotation"), t.kdop.sum / n, t.aabb.sum / n,
        t.box, t.ball);
    for (std::size_t i = 0; options.curve && i < t.turned.size(); ++i) {
      out << fmt::format("  rotation {}: 18-DOP {:.2f} %, AABB {:.2f} %\n", i, t.turned[i][0], t.turned[i][1]);
    }
  } else {
    out << "  flat: there is no volume to compare with\n";
  }
  for (const MeasuredHierarchy& h : shape.hierarchies) {
    out << fmt::format("  k={},rule={},threshold={}: {} below the root (at least {}), {}, {}, built in {:.4g} s\n",
                       h.options.k, name_of(h.options.tree.rule), h.options.tree.split_threshold,
                       counted(h.height, "level"), h.least_height, counted(h.nodes, "node"), counted(h.bytes, "byte"),
                       h.build_s);
    for (std::size_t level = 0; level < h.level_percent.size(); ++level) {
      out << fmt::format("    level {}: {:.4g} % of the root's volume\n", level, h.level_percent[level]);
    }
  }
}

// What is measured: Shapes that collide, or all of them as one. The error names the Shape.
std::expected<std::vector<std::pair<std::string, TriangleSoup>>, std::string> soups_of(const Scene& scene, bool whole) {
  std::vector<std::pair<std::string, TriangleSoup>> out;
  if (whole) {
    auto soup = collision::joined_soup(scene, std::nullopt, kTrianglesMax);
    if (!soup) return std::unexpected(soup.error());
    if (!soup->faces.empty()) out.emplace_back("", *std::move(soup));
  }
  for (std::uint32_t i = 0; i < scene.instances.size() && !whole; ++i) {
    if (!collision::is_surface(scene, i, collision::Surfaces::kColliding)) continue;
    const ObjectId id = scene.id_of(i);
    auto soup = collision::joined_soup(scene, id, kTrianglesMax);
    if (!soup) return std::unexpected(scene.path_of(id) + ": " + soup.error());
    if (!soup->faces.empty()) out.emplace_back(scene.path_of(id), *std::move(soup));
  }
  if (out.empty()) return std::unexpected("it has no polygons that collide");
  return out;
}

}  // namespace

int run_volumes(const std::string& path, const VolumesOptions& options, std::ostream& out, std::ostream& err) {
  assert(options.steps >= 1);
  std::ostream* const json_errors = options.json ? &out : nullptr;
  std::vector<KdopOptions> hierarchies;
  for (const std::string& words : options.hierarchies) {
    const auto parsed = collision::engines::kdop_options(words);
    if (!parsed) return print_error({"error: --hierarchy: " + parsed.error()}, err, json_errors);
    hierarchies.push_back(*parsed);
  }
  const auto file = open_world(path, options.reading, err, json_errors);
  if (!file) return file.error();
  const auto soups = soups_of(*(*file)->result.scene, options.whole);
  if (!soups) return print_error({path + ": error: " + soups.error(), 1}, err, json_errors);
  const std::size_t rotations = collision::kTurnAxes.size() * options.steps;
  Json shapes = Json::array();
  for (const auto& [name, soup] : *soups) {
    const MeasuredShape shape = measure_shape(name, soup, options.steps, hierarchies, options.levels);
    if (options.json) {
      shapes.push_back(to_json(shape, options, rotations));
    } else {
      print_text(shape, options, rotations, out);
    }
  }
  if (options.json) {
    const Json all = {{"world", path}, {"rotations", rotations}, {"shapes", std::move(shapes)}};
    out << json_text(all) << '\n';
  }
  return 0;
}

}  // namespace peerd
