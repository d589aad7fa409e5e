#include "core/scene/geometry_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/geometry/mesh.hpp"
#include "core/scene/mended_geometry.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/element_positions.hpp"

namespace peerd::vrml {
namespace {

static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float) && alignof(Eigen::Vector3f) <= alignof(float));

constexpr double kLargest = std::numeric_limits<float>::max();

class GeometryReader {
 public:
  GeometryReader(const std::shared_ptr<const Document>& document, const Node& node, bool takes_heights,
                 Problems& problems)
      : document_(document), node_(node), takes_heights_(takes_heights), problems_(problems) {}

  std::optional<Geometry> read();

 private:
  template <class T>
  T one(std::string_view field) const {
    return value_of(node_, field).as<T>()[0];
  }
  // Returns elements of floats as elements of T, which is made of floats.
  template <class T>
  SharedArray<T> array(const Field& field) const {
    const auto* const elements = static_cast<const T*>(field.data);
    return {document_, {elements, field.count * sizeof(float) / sizeof(T)}};
  }
  template <class T>
  SharedArray<T> array(std::string_view field) const {
    return array<T>(value_of(node_, field));
  }
  std::optional<Geometry> read_face_set();
  bool check_corners(const FaceSetGeometry& faces, const Field& list);
  std::optional<Geometry> read_elevation_grid();
  std::optional<Geometry> read_extrusion();

  const std::shared_ptr<const Document>& document_;
  const Node& node_;
  bool takes_heights_;
  Problems& problems_;
};

std::optional<Geometry> GeometryReader::read() {
  if (node_.damaged) return std::nullopt;
  const std::string_view type = node_.type->name;
  if (type == "IndexedFaceSet") return read_face_set();
  if (type == "Box") {
    const auto size = value_of(node_, "size").as<float>();
    return BoxGeometry{{size[0], size[1], size[2]}};
  }
  if (type == "Sphere") return SphereGeometry{one<float>("radius")};
  if (type == "Cone") {
    return ConeGeometry{one<float>("bottomRadius"), one<float>("height"), one<bool>("side"), one<bool>("bottom")};
  }
  if (type == "Cylinder") {
    return CylinderGeometry{one<float>("radius"), one<float>("height"), one<bool>("side"), one<bool>("top"),
                            one<bool>("bottom")};
  }
  if (type == "ElevationGrid") return read_elevation_grid();
  if (type == "Extrusion") return read_extrusion();
  return NoSurface{type};
}

std::optional<Geometry> GeometryReader::read_face_set() {
  FaceSetGeometry faces;
  faces.ccw = one<bool>("ccw");
  faces.convex = one<bool>("convex");
  const std::span<const NodeRef> coord = value_of(node_, "coord").as<NodeRef>();
  if (!coord.empty() && coord[0].is_node()) {
    const Node& coordinate = document_->nodes[coord[0].index];
    if (coordinate.damaged) return std::nullopt;
    // An EXTERNPROTO that was not found may stand for the node.
    if (find_field(*coordinate.type, "point") != nullptr && coordinate.type->name == "Coordinate") {
      faces.points = array<Eigen::Vector3f>(value_of(coordinate, "point"));
    }
  }
  const Field* list = node_.find("coordIndex");
  if (list == nullptr) return faces;
  if (faces.points.empty() && list->count > 0) {
    problems_.warning(list->at, "this IndexedFaceSet has no points for its coordIndex: it has no polygons");
    return faces;
  }
  faces.corners = {document_, list->as<std::int32_t>()};
  if (!check_corners(faces, *list)) return std::nullopt;
  return faces;
}

bool GeometryReader::check_corners(const FaceSetGeometry& faces, const Field& list) {
  const auto points = static_cast<std::int64_t>(faces.points.size());
  std::optional<ElementPositions> positions;
  const bool is_vrml = problems_.kind_of(list.at) == TextKind::kVrml;  // other lists of numbers are not cut again
  const auto position = [&](std::size_t element) {
    if (!is_vrml) return list.at;
    if (!positions) positions.emplace(problems_.text_of(list.at), problems_.begin_of(list.at), list.at);
    return positions->at(element);
  };
  bool good = true;
  std::size_t few = 0, first_few = 0;
  const std::span<const std::int32_t> corners = faces.corners.span();
  std::size_t polygon = 0;  // its first element
  for (std::size_t i = 0; i <= corners.size(); ++i) {
    if (i < corners.size() && corners[i] != Mesh::kEndOfPolygon) {
      if (corners[i] >= 0 && corners[i] < points) continue;
      good = false;
      if (problems_.full()) break;
      problems_.fault(position(i),
                      "coordIndex " + std::to_string(corners[i]) + " is out of range: the Coordinate has points 0 to " +
                          std::to_string(points - 1),
                      "it has no polygons");
      continue;
    }
    // The last -1 may be left out; a -1 behind another closes nothing.
    if (i - polygon < 3 && i != polygon && few++ == 0) first_few = polygon;
    polygon = i + 1;
  }
  if (few > 0) {
    const auto first = [&] {
      return ElementPositions(problems_.text_of(list.at), problems_.begin_of(list.at), list.at).at(first_few);
    };
    problems_.warning(is_vrml ? first() : list.at,
                      std::to_string(few) + (few == 1 ? " polygon has" : " polygons have") +
                          " fewer than 3 corners, this one first: kept and numbered, without area");
  }
  return good;
}

std::optional<Geometry> GeometryReader::read_elevation_grid() {
  ElevationGridGeometry grid{.x_dimension = one<std::int32_t>("xDimension"),
                             .z_dimension = one<std::int32_t>("zDimension"),
                             .x_spacing = one<float>("xSpacing"),
                             .z_spacing = one<float>("zSpacing"),
                             .height = array<float>("height"),
                             .ccw = one<bool>("ccw")};
  const std::int64_t wanted = std::int64_t{grid.x_dimension} * grid.z_dimension;
  const auto found = static_cast<std::int64_t>(grid.height.size());
  if (found == 0 && wanted > 0 && takes_heights_) {
    problems_.warning(node_.at, "this ElevationGrid has no heights until set_height brings them: it has no polygons");
    grid.x_dimension = grid.z_dimension = 0;
    return grid;
  }
  if (found < wanted) {
    const Field* heights = node_.find("height");
    const Position at = heights != nullptr ? heights->at : node_.at;
    const std::string why = "this ElevationGrid of " + std::to_string(grid.x_dimension) + " by " +
                            std::to_string(grid.z_dimension) + " needs " + std::to_string(wanted) +
                            " heights, it has " + std::to_string(found);
    if (wanted > kMendedHeightsMax) {
      problems_.error(at, why);
    } else {
      problems_.fault(at, why, "it has no polygons");
    }
    return std::nullopt;
  }
  if (found > wanted) {
    problems_.warning(
        node_.find("height")->at,
        std::to_string(found - wanted) + " heights are more than this ElevationGrid needs; they are not used");
    grid.height = {document_, grid.height.span().first(static_cast<std::size_t>(wanted))};
  }
  const double width = std::max(grid.x_dimension - 1, 0) * double{grid.x_spacing};
  const double length = std::max(grid.z_dimension - 1, 0) * double{grid.z_spacing};
  if (std::max(width, length) > kLargest) {
    problems_.error(node_.at, "this ElevationGrid is larger than binary32 can say");
    return std::nullopt;
  }
  return grid;
}

std::optional<Geometry> GeometryReader::read_extrusion() {
  ExtrusionGeometry extrusion{.cross_section = array<std::array<float, 2>>("crossSection"),
                              .spine = array<Eigen::Vector3f>("spine"),
                              .scale = array<std::array<float, 2>>("scale"),
                              .orientation = array<std::array<float, 4>>("orientation"),
                              .begin_cap = one<bool>("beginCap"),
                              .end_cap = one<bool>("endCap"),
                              .ccw = one<bool>("ccw")};
  // One value serves all spine points (6.18); values beyond those of the spine are not used; fewer are undefined.
  const auto check = [&](std::string_view name, std::size_t count) {
    if (count == 1 || count >= extrusion.spine.size()) return true;
    const Field* field = node_.find(name);
    problems_.fault(field != nullptr ? field->at : node_.at,
                    quoted(name) + " has " + std::to_string(count) + " values for " +
                        std::to_string(extrusion.spine.size()) + " spine points: one is needed, or one for each",
                    "it has no polygons");
    return false;
  };
  const bool scale = check("scale", extrusion.scale.size());
  const bool orientation = check("orientation", extrusion.orientation.size());
  if (!scale || !orientation) return std::nullopt;
  const auto largest = [&](std::string_view name) {
    double most = 0;
    for (const float f : value_of(node_, name).as<float>()) most = std::max(most, std::abs(double{f}));
    return most;
  };
  // However the cross-section is turned, no coordinate of it exceeds twice its largest.
  if (largest("spine") + 2 * largest("crossSection") * largest("scale") > kLargest) {
    problems_.error(node_.at, "this Extrusion is larger than binary32 can say");
    return std::nullopt;
  }
  return extrusion;
}

}  // namespace

std::optional<Geometry> read_geometry(const std::shared_ptr<const Document>& document, const Node& node,
                                      bool takes_heights, Problems& problems) {
  return GeometryReader(document, node, takes_heights, problems).read();
}

}  // namespace peerd::vrml
