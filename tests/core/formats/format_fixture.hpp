#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/tessellate.hpp"
#include "core/scene/reader.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::formats {

using NamedFiles = std::map<std::string, std::string, std::less<>>;

// Reads a file of that name, beside which those files are.
inline ReadResult read_file(const std::string& name, std::string_view bytes, const NamedFiles& files = {},
                            ReadOptions options = {}) {
  options.name = name;
  options.load = [files](std::string_view url, std::string_view) -> std::expected<LoadedFile, std::string> {
    const auto it = files.find(url);
    if (it == files.end()) return std::unexpected("there is no such file");
    return LoadedFile{it->first, it->second};
  };
  return read_world(bytes, options);
}

// A Shape of a scene: its path, and what it is made of in the world's frame.
struct ReadShape {
  std::string path;
  std::vector<Vec3> points;                         // [m]
  std::vector<std::vector<std::int32_t>> polygons;  // indices of points
};

inline std::vector<ReadShape> shapes_of(const ReadResult& result) {
  std::vector<ReadShape> shapes;
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << render(result, d);
  }
  if (!result.scene) return shapes;
  const Scene& scene = *result.scene;
  EXPECT_EQ(vrml::document_violation(*scene.document), "");
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const ObjectId id{i};
    EXPECT_EQ(scene.find(scene.path_of(id)), id) << scene.path_of(id);
    const Geometry* const geometry = scene.geometry(id);
    if (geometry == nullptr) continue;
    ReadShape& shape = shapes.emplace_back();
    shape.path = scene.path_of(id);
    const Mesh mesh = build_mesh(*geometry, scene.tessellation);
    for (const Eigen::Vector3f& p : mesh.vertices)
      shape.points.push_back(scene.world_from_local(id) * p.cast<double>());
    for (std::size_t p = 0; p < mesh.polygon_count(); ++p) {
      shape.polygons.emplace_back(mesh.polygon(p).begin(), mesh.polygon(p).end());
    }
  }
  return shapes;
}

// The first error of a file that cannot be read: one sentence, and no scene.
inline std::string error_of(const ReadResult& result) {
  EXPECT_FALSE(result.scene);
  std::size_t errors = 0;
  std::string first;
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity != Severity::kError) continue;
    if (errors++ == 0) first = d.message;
  }
  EXPECT_EQ(errors, 1U);
  return first;
}

// FILE: MESSAGE, or FILE:LINE: MESSAGE, of each warning. The file has no errors.
inline std::vector<std::string> warnings_of(const ReadResult& result) {
  std::vector<std::string> lines;
  for (const Diagnostic& d : result.diagnostics) {
    EXPECT_EQ(d.severity, Severity::kWarning) << d.message;
    lines.push_back(result.sources.at(d.source).name + (d.where.line == 0 ? "" : ":" + std::to_string(d.where.line)) +
                    ": " + d.message);
  }
  return lines;
}

// Appends the bytes of a number, least significant first.
template <class T>
void append(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}
template <class T>
void append_reversed(std::string& bytes, T value) {
  std::string raw;
  append(raw, value);
  bytes.append(raw.rbegin(), raw.rend());
}

}  // namespace peerd::formats
