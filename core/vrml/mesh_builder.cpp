#include "core/vrml/mesh_builder.hpp"

#include <algorithm>

#include "core/vrml/parser.hpp"

namespace peerd::vrml {
namespace {

bool bool_of(const Node& node, std::string_view field, bool otherwise) {
  const FieldValue* value = node.find(field);
  return value == nullptr ? otherwise : std::get<bool>(value->value);
}

class IndexProblems {
 public:
  IndexProblems(std::string_view text, const FieldValue& list, Problems& problems)
      : spots_(text, list), problems_(problems) {}

  void out_of_range(std::size_t element, std::int32_t index, std::size_t points) {
    const std::string range = points == 0 ? "has no points" : "has points 0 to " + std::to_string(points - 1);
    report(element, "coordIndex " + std::to_string(index) + " is out of range: the Coordinate " + range);
  }
  void too_few_corners(std::size_t element, std::size_t corners) {
    report(element, "a polygon needs at least 3 corners, this one has " + std::to_string(corners));
  }
  [[nodiscard]] bool any() const { return any_; }

 private:
  void report(std::size_t element, std::string message) {
    any_ = true;
    if (!problems_.full()) problems_.error(spots_.at(element), std::move(message));
  }

  ElementSpots spots_;
  Problems& problems_;
  bool any_ = false;
};

}  // namespace

Mesh box_mesh(const Floats& size) {
  const Eigen::Vector3f half(0.5f * size[0], 0.5f * size[1], 0.5f * size[2]);
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {  // bits 0, 1, 2: the positive side of x, y, z
    const Eigen::Vector3f sign((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    mesh.vertices.push_back(sign.cwiseProduct(half));
  }
  mesh.polygon_begin = {0, 4, 8, 12, 16, 20, 24};
  mesh.indices = {
      0, 4, 6, 2,  // -x
      1, 3, 7, 5,  // +x
      0, 1, 5, 4,  // -y
      2, 6, 7, 3,  // +y
      0, 2, 3, 1,  // -z
      4, 5, 7, 6,  // +z
  };
  return mesh;
}

std::vector<Eigen::Vector3f> to_points(const std::vector<float>& floats) {
  std::vector<Eigen::Vector3f> points(floats.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {floats[3 * i], floats[3 * i + 1], floats[3 * i + 2]};
  return points;
}

std::optional<Mesh> indexed_face_set_mesh(const NodeTree& tree, const Node& face_set, std::string_view text,
                                          Problems& problems) {
  Mesh mesh;
  mesh.where = face_set.spot.where;
  mesh.ccw = bool_of(face_set, "ccw", true);
  if (face_set.damaged) return std::nullopt;

  const FieldValue* coord = face_set.find("coord");
  if (coord != nullptr && std::get<NodeRef>(coord->value)) {
    const Node& coordinate = tree.nodes[std::get<NodeRef>(coord->value).index];
    if (coordinate.damaged) return std::nullopt;
    const FieldValue* point = coordinate.find("point");
    if (point != nullptr) mesh.vertices = to_points(std::get<std::vector<float>>(point->value));
  }
  const FieldValue* list = face_set.find("coordIndex");
  if (list == nullptr) return mesh;

  const auto& written = std::get<std::vector<std::int32_t>>(list->value);
  IndexProblems bad(text, *list, problems);
  mesh.indices.reserve(written.size());
  mesh.polygon_begin.push_back(0);
  std::size_t polygon = 0;  // first element of this polygon in `written`
  for (std::size_t i = 0; i <= written.size(); ++i) {
    if (bad.any() && problems.full()) break;
    if (i < written.size() && written[i] != -1) {
      const std::int32_t index = written[i];
      if (index < 0 || static_cast<std::size_t>(index) >= mesh.vertices.size()) {
        bad.out_of_range(i, index, mesh.vertices.size());
      }
      mesh.indices.push_back(static_cast<std::uint32_t>(index));
      continue;
    }
    // The last -1 may be left out.
    if (i == written.size() && polygon == i) break;
    if (i - polygon < 3) bad.too_few_corners(std::min(i, written.size() - 1), i - polygon);
    mesh.polygon_begin.push_back(static_cast<std::uint32_t>(mesh.indices.size()));
    polygon = i + 1;
  }
  if (bad.any()) return std::nullopt;
  return mesh;
}

}  // namespace peerd::vrml
