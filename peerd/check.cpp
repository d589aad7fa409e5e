#include "peerd/check.hpp"

#include <ostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/vrml/reader.hpp"
#include "peerd/config/toml_input.hpp"
#include "replication/motion_world.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

void print_statistics(const ReadStatistics& s, std::ostream& out) {
  const auto row = [&](const char* name, std::size_t count, const char* what) {
    std::string label = std::string("  ") + name;
    label.resize(22, ' ');
    std::string number = std::to_string(count);
    if (number.size() < 10) number.insert(0, 10 - number.size(), ' ');
    out << label << number << (*what == '\0' ? "" : "  ") << what << '\n';
  };
  row("nodes", s.nodes, "");
  row("instances", s.instances, "groups, transforms and shapes; a USE counts again");
  row("shapes", s.shapes, "");
  row("meshes", s.meshes, "stored once however often they are used");
  row("polygons", s.polygons, "");
  row("vertices", s.vertices, "");
  row("polygons instanced", s.polygons_instanced, "a USE counts again");
  row("interests", s.interests, "pairs registered for collision");
  row("cannot collide yet", s.cannot_collide_yet, "shapes whose geometry is kept but has no polygons yet");
}

void print_text(const std::string& path, const std::string& text, const ReadResult& result,
                const std::vector<std::string>& unsupported, std::ostream& out, std::ostream& err) {
  std::size_t errors = 0;
  for (const Diagnostic& d : result.diagnostics) {
    err << render(d, path, text);
    if (d.severity == Severity::kError) ++errors;
  }
  for (const std::string& line : unsupported) err << path << ": note: unsupported: " << line << '\n';
  const std::size_t warnings = result.diagnostics.size() - errors;
  out << path << ": " << (result.scene ? "good" : counted(errors, "error"));
  if (warnings > 0) out << ", " << counted(warnings, "warning");
  out << '\n';
  if (result.scene) print_statistics(result.statistics, out);
}

Json to_json(const std::string& path, const ReadResult& result, const std::vector<std::string>& unsupported) {
  Json errors = Json::array();
  Json warnings = Json::array();
  for (const Diagnostic& d : result.diagnostics) {
    Json& list = d.severity == Severity::kError ? errors : warnings;
    list.push_back({{"line", d.where.line}, {"column", d.where.column}, {"message", d.message}});
  }
  const ReadStatistics& s = result.statistics;
  return {{"world", path},
          {"good", result.scene.has_value()},
          {"errors", errors},
          {"warnings", warnings},
          {"unsupported", unsupported},
          {"statistics",
           {{"nodes", s.nodes},
            {"instances", s.instances},
            {"shapes", s.shapes},
            {"meshes", s.meshes},
            {"polygons", s.polygons},
            {"vertices", s.vertices},
            {"polygons_instanced", s.polygons_instanced},
            {"interests", s.interests},
            {"cannot_collide_yet", s.cannot_collide_yet}}}};
}

// A path or a message may hold bytes that are no UTF-8, and JSON may not.
void print(const Json& json, std::ostream& out) {
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

}  // namespace

int run_check(const std::string& path, bool json, std::ostream& out, std::ostream& err) {
  const auto text = config::read_text_file(path);
  if (!text) {
    err << text.error().text << '\n';
    if (json) print({{"world", path}, {"good", false}, {"error", text.error().text}}, out);
    return text.error().exit_code;
  }
  const ReadResult result = read_world(*text);
  // What its interests ask for and collision can't answer yet: no error of the world's.
  std::vector<std::string> unsupported;
  if (result.scene) unsupported = replication::make_world_model(*result.scene)->unsupported;
  if (json) {
    print(to_json(path, result, unsupported), out);
  } else {
    print_text(path, *text, result, unsupported, out, err);
  }
  return result.scene ? 0 : 1;
}

}  // namespace peerd
