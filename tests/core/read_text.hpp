#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/reader.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/document.hpp"
#include "tests/core/document_violation.hpp"

namespace peerd {

// The header stands in line 1, so the first line of `body` is line 2.
inline std::string world_text(const std::string& body) { return "#VRML V2.0 utf8\n" + body; }

// Files are files in memory by name, with or without their header line; packed ones as they are.
using Files = std::map<std::string, std::string, std::less<>>;

inline constexpr const char* kWorldName = "world.wrl";

// URLs are relative to the folder of the file that has them; "." and ".." are resolved, so a file has one name.
inline std::string resolved(std::string_view url, std::string_view base) {
  if (url.starts_with('/')) return std::string(url.substr(1));
  const std::size_t slash = base.rfind('/');
  std::string path(slash == std::string_view::npos ? "" : base.substr(0, slash + 1));
  for (std::string_view rest = url; !rest.empty();) {
    const std::size_t end = std::min(rest.find('/'), rest.size() - 1) + 1;
    const std::string_view part = rest.substr(0, end);
    rest.remove_prefix(end);
    if (part == "./") continue;
    if (part == "../") {
      path.erase(path.find_last_of('/', path.size() - 2) + 1);
    } else {
      path += part;
    }
  }
  return path;
}

inline FileLoader loader_of(Files files, std::vector<std::string>* asked = nullptr) {
  return [files = std::move(files), asked](std::string_view url,
                                           std::string_view base) -> std::expected<LoadedFile, std::string> {
    const std::string name = resolved(url, base);
    if (asked != nullptr) asked->push_back(name);
    const auto it = files.find(name);
    if (it == files.end()) return std::unexpected("no such file");
    const bool whole = it->second.starts_with('#') || it->second.starts_with('\x1f');
    return LoadedFile{name, whole ? it->second : world_text(it->second)};
  };
}

inline ReadResult read_body(const std::string& body, const Files& files = {}, ReadOptions options = {}) {
  // The texts are kept for as long as the result may point into them.
  static std::map<std::string, std::string> texts;
  if (options.name.empty()) options.name = kWorldName;
  Files all = files;
  all.emplace(options.name, body);
  if (!options.load) options.load = loader_of(std::move(all));
  return read_world(texts.try_emplace(body, world_text(body)).first->second, options);
}

inline Scene scene_of(const std::string& body, const Files& files = {}, const ReadOptions& options = {}) {
  ReadResult result = read_body(body, files, options);
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << render(result, d);
  }
  if (!result.scene) {
    Scene none;
    none.document = std::make_shared<vrml::Document>();
    return none;
  }
  return std::move(*result.scene);
}

// Returns LINE:COLUMN: MESSAGE of each problem; warnings begin with "warning ", problems in another file with its name.
inline std::vector<std::string> lines_of(const ReadResult& result) {
  std::vector<std::string> lines;
  for (const Diagnostic& d : result.diagnostics) {
    lines.push_back((d.severity == Severity::kWarning ? "warning " : "") +
                    (d.source == 0 ? "" : result.sources.at(d.source).name + ":") + std::to_string(d.where.line) + ":" +
                    std::to_string(d.where.column) + ": " + d.message);
  }
  return lines;
}
inline std::vector<std::string> problems_of(const std::string& body, const Files& files = {},
                                            const ReadOptions& options = {}) {
  return lines_of(read_body(body, files, options));
}
inline std::vector<std::string> errors_of(const std::string& body, const Files& files = {},
                                          const ReadOptions& options = {}) {
  std::vector<std::string> lines = problems_of(body, files, options);
  std::erase_if(lines, [](const std::string& line) { return line.starts_with("warning "); });
  return lines;
}

// A world with an error in it, and the lines that the reader reports.
struct BadCase {
  const char* name;
  const char* body;
  std::vector<std::string> problems;
};

// Returns the paths of all instances, in order.
inline std::vector<std::string> paths_of(const Scene& scene) {
  std::vector<std::string> paths;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) paths.push_back(scene.path_of(ObjectId{i}));
  return paths;
}
// Returns the instances that collide.
inline std::vector<std::string> solid_of(const Scene& scene) {
  std::vector<std::string> paths;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (scene.instances[i].collides) paths.push_back(scene.path_of(ObjectId{i}));
  }
  return paths;
}
inline std::vector<std::string> drawn_of(const Scene& scene) {
  std::vector<std::string> paths;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (scene.instances[i].drawn) paths.push_back(scene.path_of(ObjectId{i}));
  }
  return paths;
}

namespace vrml {

inline std::vector<std::uint32_t> nodes_of_type(const Document& document, std::string_view type) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < document.nodes.size(); ++i) {
    if (document.nodes[i].type->name == type) nodes.push_back(i);
  }
  return nodes;
}

inline std::vector<float> floats(const Node& node, std::string_view field) {
  const auto f = value_of(node, field).as<float>();
  return {f.begin(), f.end()};
}
// Returns all nodes of a type, in the order of the document.
inline std::vector<std::vector<float>> floats_of(const Document& document, std::string_view type,
                                                 std::string_view field) {
  std::vector<std::vector<float>> all;
  for (const std::uint32_t i : nodes_of_type(document, type)) all.push_back(floats(document.nodes[i], field));
  return all;
}

// Returns NODE.FIELD > NODE.FIELD of each ROUTE: by DEF name, or by type where there is none.
inline std::vector<std::string> routes_of(const Document& document) {
  std::vector<std::string> routes;
  const auto end = [&](std::uint32_t index, const FieldSpec* field) {
    const Node& node = document.nodes.at(index);
    return std::string(node.def.empty() ? node.type->name : node.def) + "." + std::string(field->name);
  };
  for (const Route& route : document.routes) {
    routes.push_back(end(route.from_node, route.from) + " > " + end(route.to_node, route.to));
  }
  return routes;
}

}  // namespace vrml
}  // namespace peerd
