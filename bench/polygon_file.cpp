#include "bench/polygon_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

namespace peerd::bench {
namespace {

PolygonFile read_obj(std::istream& in) {
  PolygonFile file;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      auto& p = file.vertices.emplace_back();
      words >> p[0] >> p[1] >> p[2];
    } else if (word == "f") {  // i, i/t or i/t/n; negative: counted from the last
      auto& corners = file.polygons.emplace_back();
      while (words >> word) {
        const int i = std::atoi(word.c_str());
        corners.push_back(i < 0 ? static_cast<int>(file.vertices.size()) + i : i - 1);
      }
    }
  }
  return file;
}

std::optional<PolygonFile> read_off(std::istream& in) {
  std::stringstream words;  // without comments
  for (std::string line; std::getline(in, line);) words << line.substr(0, line.find('#')) << '\n';
  std::string magic;
  std::size_t vertices = 0, polygons = 0, edges = 0;
  if (!(words >> magic) || magic != "OFF" || !(words >> vertices >> polygons >> edges)) return std::nullopt;
  PolygonFile file;
  for (std::array<double, 3> p; file.vertices.size() < vertices && words >> p[0] >> p[1] >> p[2];) {
    file.vertices.push_back(p);
  }
  while (file.polygons.size() < polygons) {
    std::size_t count = 0;
    words >> count;
    auto& corners = file.polygons.emplace_back();
    for (int corner = 0; corners.size() < count && words >> corner;) corners.push_back(corner);
    if (!words) return std::nullopt;
    std::string colours;
    std::getline(words, colours);
  }
  return file;
}

}  // namespace

std::expected<PolygonFile, std::string> read_polygon_file(const std::string& path) {
  std::ifstream in(path);
  if (!in) return std::unexpected(path + " cannot be read");
  std::optional<PolygonFile> file;
  if (path.ends_with(".obj")) file = read_obj(in);
  if (path.ends_with(".off")) file = read_off(in);
  if (!file) return std::unexpected(path + " is neither an OBJ nor an OFF file");
  const auto exists = [&](int i) { return i >= 0 && static_cast<std::size_t>(i) < file->vertices.size(); };
  for (const auto& corners : file->polygons) {
    if (!std::ranges::all_of(corners, exists))
      return std::unexpected(path + " has a polygon of vertices that it hasn't");
  }
  return std::move(*file);
}

}  // namespace peerd::bench
