#include "peerd/check.hpp"

#include <cerrno>
#include <cstring>
#include <expected>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>

#include "core/vrml/reader.hpp"

namespace peerd {
namespace {

enum ExitCode { kGood = 0, kFinding = 1, kEnvironment = 3 };

using Json = nlohmann::ordered_json;

std::expected<std::string, std::string> read_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return std::unexpected("'" + path + "' is a folder: give the path of a .wrl file in it");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file.peek() != std::ifstream::traits_type::eof()) text << file.rdbuf();
  if (!file.is_open() || file.bad() || text.bad()) {
    const std::string reason = errno != 0 ? std::strerror(errno) : "reading failed";
    return std::unexpected("cannot read '" + path + "' (" + reason + "): check the path and its permissions");
  }
  return std::move(text).str();
}

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

// What stands in the way of collisions without being an error.
void print_unsupported(const Scene& scene, const std::string& path, std::ostream& out) {
  constexpr std::size_t kShown = 10;
  std::size_t found = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.unsupported_geometry.empty() || ++found > kShown) continue;
    out << path << ':' << instance.where.line << ':' << instance.where.column << ": note: the "
        << instance.unsupported_geometry << " of " << scene.path_of(ObjectId{static_cast<std::uint32_t>(i)})
        << " cannot collide yet\n";
  }
  if (found > kShown) out << path << ": note: and " << counted(found - kShown, "more shape") << '\n';
}

void print_text(const std::string& path, const std::string& text, const ReadResult& result, std::ostream& out,
                std::ostream& err) {
  std::size_t errors = 0;
  for (const Diagnostic& d : result.diagnostics) {
    err << render(d, path, text);
    if (d.severity == Severity::kError) ++errors;
  }
  if (result.scene) print_unsupported(*result.scene, path, err);
  const std::size_t warnings = result.diagnostics.size() - errors;
  out << path << ": " << (result.scene ? "good" : counted(errors, "error"));
  if (warnings > 0) out << ", " << counted(warnings, "warning");
  out << '\n';
  if (result.scene) print_statistics(result.statistics, out);
}

Json to_json(const std::string& path, const ReadResult& result) {
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
  const auto text = read_file(path);
  if (!text) {
    err << "peerd check: " << text.error() << '\n';
    if (json) print({{"world", path}, {"good", false}, {"error", text.error()}}, out);
    return kEnvironment;
  }
  const ReadResult result = read_world(*text);
  if (json) {
    print(to_json(path, result), out);
  } else {
    print_text(path, *text, result, out, err);
  }
  return result.scene ? kGood : kFinding;
}

}  // namespace peerd
