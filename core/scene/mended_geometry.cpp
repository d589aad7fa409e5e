#include "core/scene/mended_geometry.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "core/geometry/mesh.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/element_positions.hpp"

namespace peerd::vrml {
namespace {

// Puts `elements` in the place of those of a field. Copies of a node share their fields, so the field is a new one.
template <class T>
void replace_elements(Document& document, Node& node, const Field& old, const std::vector<T>& elements) {
  std::vector<Field> fields(node.given().begin(), node.given().end());
  const auto kept = document.arena.copy(std::span<const T>(elements));
  auto field = std::ranges::find(fields, old.spec, &Field::spec);
  if (field == fields.end()) {
    field = fields.insert(field, old);
    field->at = node.at;
  }
  field->data = kept.data();
  field->count = static_cast<std::uint32_t>(kept.size());
  node.fields = document.arena.copy(std::span<const Field>(fields)).data();
  node.field_count = static_cast<std::uint32_t>(fields.size());
}

std::int64_t points_of(const Document& document, const Node& faces) {
  const std::span<const NodeRef> coord = value_of(faces, "coord").as<NodeRef>();
  if (coord.empty() || !coord[0].is_node()) return 0;
  const Node& coordinate = document.nodes[coord[0].index];
  return coordinate.type->name == "Coordinate" ? value_of(coordinate, "point").count / 3 : 0;
}

// Each corner of a polygon that names no point becomes the nearest before it that does, or the first behind it.
void mend_polygon(std::span<std::int32_t> corners, std::int64_t points) {
  const auto good = [&](std::int32_t corner) { return corner >= 0 && corner < points; };
  const auto first = std::ranges::find_if(corners, good);
  std::int32_t last = first == corners.end() ? 0 : *first;
  for (std::int32_t& corner : corners) {
    if (good(corner)) last = corner;
    corner = last;
  }
}

void mend_corners(Document& document, Node& node, Problems& problems) {
  const Field* const list = node.find("coordIndex");
  const std::int64_t points = points_of(document, node);
  if (list == nullptr || points == 0) return;
  const std::span<const std::int32_t> read = list->as<std::int32_t>();
  const auto is_wrong = [&](std::int32_t corner) {
    return corner != Mesh::kEndOfPolygon && (corner < 0 || corner >= points);
  };
  const auto wrong = std::ranges::find_if(read, is_wrong);
  if (wrong == read.end()) return;
  ElementPositions positions(problems.text_of(list->at), problems.begin_of(list->at), list->at);
  const auto others = std::ranges::count_if(wrong + 1, read.end(), is_wrong);
  problems.fault(positions.at(static_cast<std::size_t>(wrong - read.begin())),
                 "coordIndex " + std::to_string(*wrong) + " is out of range: the Coordinate has points 0 to " +
                     std::to_string(points - 1) +
                     (others > 0 ? ", and " + std::to_string(others) + " more of this list are" : std::string()),
                 "the corner before it in its polygon is taken");
  std::vector<std::int32_t> corners(read.begin(), read.end());
  for (auto begin = corners.begin(); begin != corners.end();) {
    const auto end = std::find(begin, corners.end(), Mesh::kEndOfPolygon);
    mend_polygon({begin, end}, points);
    begin = end == corners.end() ? end : end + 1;
  }
  replace_elements(document, node, *list, corners);
}

// Heights that a Script brings are no fault of the file: a grid without any is left to the reader of the geometry.
void mend_heights(Document& document, Node& node, Problems& problems) {
  const std::int64_t columns = value_of(node, "xDimension").as<std::int32_t>()[0];
  const std::int64_t rows = value_of(node, "zDimension").as<std::int32_t>()[0];
  const Field* const height = node.find("height");
  if (height == nullptr || height->count == 0 || columns < 0 || rows < 0) return;
  const std::int64_t wanted = columns * rows, found = height->count;
  if (found >= wanted || wanted > kMendedHeightsMax) return;
  problems.fault(height->at,
                 "this ElevationGrid of " + std::to_string(columns) + " by " + std::to_string(rows) + " needs " +
                     std::to_string(wanted) + " heights, it has " + std::to_string(found),
                 "those that are missing are 0");
  const std::span<const float> read = height->as<float>();
  std::vector<float> heights(read.begin(), read.end());
  heights.resize(static_cast<std::size_t>(wanted), 0.0F);
  replace_elements(document, node, *height, heights);
}

// `width` is how many floats make one element.
void mend_along_spine(Document& document, Node& node, std::string_view name, std::size_t width, Problems& problems) {
  const std::size_t wanted = value_of(node, "spine").count / 3;
  const Field& values = value_of(node, name);
  const std::size_t found = values.count / width;
  if (found == 1 || found >= wanted) return;
  const Field* const given = node.find(name);
  problems.fault(given != nullptr ? given->at : node.at,
                 quoted(name) + " has " + std::to_string(found) + " values for " + std::to_string(wanted) +
                     " spine points: one is needed, or one for each",
                 found == 0 ? "the default value serves all" : "the last one serves those that have none");
  const std::span<const float> read = found == 0 ? default_of(*values.spec).as<float>() : values.as<float>();
  std::vector<float> elements(read.begin(), read.end());
  if (found > 0) elements.reserve(wanted * width);
  while (found > 0 && elements.size() < wanted * width) elements.push_back(elements[elements.size() - width]);
  replace_elements(document, node, values, elements);
}

}  // namespace

void mend_geometry(Document& document, Problems& problems) {
  for (Node& node : document.nodes) {
    node.damaged = false;
    if (node.type->name == "IndexedFaceSet") mend_corners(document, node, problems);
    if (node.type->name == "ElevationGrid") mend_heights(document, node, problems);
    if (node.type->name != "Extrusion") continue;
    mend_along_spine(document, node, "scale", 2, problems);
    mend_along_spine(document, node, "orientation", 4, problems);
  }
}

}  // namespace peerd::vrml
