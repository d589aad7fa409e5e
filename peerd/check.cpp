#include "peerd/check.hpp"

#include <ostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/scene_statistics.hpp"
#include "peerd/config/world_file.hpp"
#include "replication/motion_world.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

void print_statistics(const SceneStatistics& s, std::ostream& out) {
  const auto row = [&](const char* name, std::uint64_t count, const char* what) {
    std::string label = std::string("  ") + name;
    label.resize(22, ' ');
    std::string number = std::to_string(count);
    if (number.size() < 10) number.insert(0, 10 - number.size(), ' ');
    out << label << number << (*what == '\0' ? "" : "  ") << what << '\n';
  };
  row("nodes", s.nodes, "PROTOs expanded");
  row("instances", s.instances, "groups and shapes; a USE counts again");
  row("groups", s.groups, "");
  row("shapes", s.shapes, "");
  row("depth", s.depth, "of the deepest instance");
  row("geometries", s.geometries, "stored once however often they are used");
  row("polygons", s.polygons, "");
  row("triangles", s.triangles, "that the polygons are cut into");
  row("polygons instanced", s.polygons_instanced, "a USE counts again");
  row("interests", s.interests, "pairs registered for collision");
  row("key sensors", s.key_sensors, "");
  row("routes", s.routes, "");
}

void print_text(const std::string& path, const ReadResult& result,
                const std::vector<std::string>& unsupported, std::ostream& out, std::ostream& err) {
  std::size_t errors = 0;
  for (const Diagnostic& d : result.diagnostics) {
    err << render(result, d);
    if (d.severity == Severity::kError) ++errors;
  }
  for (const std::string& line : unsupported) err << path << ": note: unsupported: " << line << '\n';
  const std::size_t warnings = result.diagnostics.size() - errors;
  out << path << ": " << (result.scene ? "good" : counted(errors, "error"));
  if (warnings > 0) out << ", " << counted(warnings, "warning");
  out << '\n';
  if (result.scene) print_statistics(statistics_of(*result.scene), out);
}

Json to_json(const std::string& path, const ReadResult& result, const std::vector<std::string>& unsupported) {
  Json errors = Json::array();
  Json warnings = Json::array();
  for (const Diagnostic& d : result.diagnostics) {
    Json& list = d.severity == Severity::kError ? errors : warnings;
    list.push_back({{"file", result.sources.at(d.source).name}, {"line", d.where.line}, {"column", d.where.column}, {"message", d.message}});
  }
  const SceneStatistics s = result.scene ? statistics_of(*result.scene) : SceneStatistics{};
  return {{"world", path},
          {"good", result.scene.has_value()},
          {"errors", errors},
          {"warnings", warnings},
          {"unsupported", unsupported},
          {"statistics",
           {{"nodes", s.nodes},
            {"instances", s.instances},
            {"groups", s.groups},
            {"shapes", s.shapes},
            {"depth", s.depth},
            {"geometries", s.geometries},
            {"polygons", s.polygons},
            {"triangles", s.triangles},
            {"polygons_instanced", s.polygons_instanced},
            {"triangles_instanced", s.triangles_instanced},
            {"interests", s.interests},
            {"key_sensors", s.key_sensors},
            {"routes", s.routes},
            {"pending_inlines", s.pending_inlines}}}};
}

// A path or a message may hold bytes that are no UTF-8, and JSON may not.
void print(const Json& json, std::ostream& out) {
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

}  // namespace

int run_check(const std::string& path, bool json, std::ostream& out, std::ostream& err) {
  const auto file = config::read_world_file(path);
  if (!file) {
    err << file.error().text << '\n';
    if (json) print({{"world", path}, {"good", false}, {"error", file.error().text}}, out);
    return file.error().exit_code;
  }
  const ReadResult& result = (*file)->result;
  // What its interests ask for and collision can't answer yet: no error of the world's.
  std::vector<std::string> unsupported;
  if (result.scene) unsupported = replication::make_world_model(*result.scene)->unsupported;
  if (json) {
    print(to_json(path, result, unsupported), out);
  } else {
    print_text(path, result, unsupported, out, err);
  }
  return result.scene ? 0 : 1;
}

}  // namespace peerd
