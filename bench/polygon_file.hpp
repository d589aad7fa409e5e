#pragma once
#include <array>
#include <expected>
#include <string>
#include <vector>

namespace peerd::bench {

// Polygons as a file has them: not split, merged or cleaned.
struct PolygonFile {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::vector<int>> polygons;  // of indices into `vertices`, all of which exist
};

// The file's format follows from its name's end, .obj (of which the v and f lines are read) or .off. The error is a
// sentence that names the file.
[[nodiscard]] std::expected<PolygonFile, std::string> read_polygon_file(const std::string& path);

}  // namespace peerd::bench
