#include "peerd/view/picture/drawn_geometry.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <span>
#include <unordered_map>
#include <utility>

#include "core/box.hpp"
#include "core/geometry/tessellate.hpp"
#include "core/geometry/triangulation.hpp"
#include "peerd/view/picture/node_fields.hpp"

namespace peerd::view {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// At a point where more polygons meet, normals are flat: each corner looks at all polygons around its point.
constexpr std::uint32_t kPolygonsOfPoint = 512;

std::span<const Vector3f> vectors(std::span<const float> floats) {
  static_assert(sizeof(Vector3f) == 3 * sizeof(float));
  return {reinterpret_cast<const Vector3f*>(floats.data()), floats.size() / 3};
}

// Values that a geometry's corners, points or polygons take from a list, by an index of their own or by the geometry's.
struct Indexed {
  enum class By : std::uint8_t { kNothing, kCorner, kPoint, kPolygon };

  By by = By::kNothing;
  std::span<const std::int32_t> index;  // empty: the number of the corner's point, or of the polygon

  // `corner`: position in coordIndex.
  [[nodiscard]] std::size_t at(std::size_t corner, std::int32_t point, std::size_t polygon) const {
    if (by == By::kPolygon) return index.empty() ? polygon : number(polygon);
    return by == By::kPoint || index.empty() ? static_cast<std::size_t>(point) : number(corner);
  }

 private:
  [[nodiscard]] std::size_t number(std::size_t i) const {
    return i < index.size() && index[i] >= 0 ? static_cast<std::size_t>(index[i]) : ~std::size_t{0};
  }
};

// The bits of all that belongs to a vertex beside its point.
using VertexKey = std::array<std::uint32_t, 9>;
struct HashOfKey {
  std::size_t operator()(const VertexKey& key) const noexcept {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const std::uint32_t part : key) hash = (hash ^ part) * 0x100000001b3U;
    return static_cast<std::size_t>(hash ^ (hash >> 29));
  }
};

class SurfaceDrawer {
 public:
  explicit SurfaceDrawer(const GeometryToDraw& what)
      : what_(what), node_(what.node), mesh_(build_mesh(what.form, what.tessellation)) {}

  GeometryAsDrawn draw();

 private:
  struct Corner {
    std::size_t polygon = 0, k = 0;  // corner k of the polygon
    std::size_t at = 0;              // in coordIndex
    std::int32_t point = 0;
  };

  [[nodiscard]] bool is_face_set() const { return std::holds_alternative<FaceSetGeometry>(what_.form); }
  [[nodiscard]] bool is_grid() const { return std::holds_alternative<ElevationGridGeometry>(what_.form); }
  void measure_polygons();
  void find_neighbours();
  void read_colors();
  void read_normals();
  void read_texture_coordinates();
  [[nodiscard]] double crease_angle_rad() const;
  [[nodiscard]] bool all_within(const Indexed& by, std::size_t count) const;
  template <class Function>
  void for_each_corner(std::size_t polygon, Function function) const;
  [[nodiscard]] Vector3f normal_at(const Corner& corner);
  [[nodiscard]] Vector2f default_texture_coordinate(const Corner& corner) const;
  [[nodiscard]] Vector2f around_axis(const Corner& corner, float t) const;
  [[nodiscard]] std::uint32_t vertex(const Corner& corner, const Vector3f& normal);
  void draw_polygon(std::size_t polygon);
  bool draw_without_front(std::size_t polygon);
  [[nodiscard]] Vec3 area_of(std::size_t polygon, const CornerTriangle& triangle) const;
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    out_.geometry.corners.insert(out_.geometry.corners.end(), {a, b, c});
  }
  void note(const std::string& left_out) { out_.left_out.push_back(left_out); }

  const GeometryToDraw& what_;
  const vrml::Node& node_;
  Mesh mesh_;
  LocalBox box_;
  std::vector<Vec3> face_normals_;  // zero: the polygon has no front
  Triangulator triangulator_;
  std::vector<std::uint32_t> vertices_;  // of the polygon that is drawn
  std::vector<std::uint32_t> first_of_point_, polygons_of_point_;
  double cos_crease_ = 1.0;
  bool smooth_ = false;
  bool crowded_ = false;
  std::span<const Vector3f> colors_, normals_;
  std::span<const float> texture_coordinates_;
  Indexed color_by_, normal_by_, texture_by_;
  std::unordered_map<VertexKey, std::uint32_t, HashOfKey> known_;
  GeometryAsDrawn out_;
};

template <class Function>
void SurfaceDrawer::for_each_corner(std::size_t polygon, Function function) const {
  const auto corners = mesh_.polygon(polygon);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    function(Corner{polygon, k, mesh_.polygon_begin[polygon] + k, corners[k]});
  }
}

// A polygon that crosses itself has parts that count against each other in Newell's sum. Where less than this part of
// them is left, that may be rounding, whose direction says nothing: the polygon is drawn from both sides.
constexpr double kLeastOfParts = 1e-9;

// The normals are Newell's sums, in the direction of the front.
void SurfaceDrawer::measure_polygons() {
  face_normals_.reserve(mesh_.polygon_count());
  for (std::size_t i = 0; i < mesh_.polygon_count(); ++i) {
    const auto corners = mesh_.polygon(i);
    Vec3 sum = Vec3::Zero();
    double parts = 0.0;
    const Vec3 first = mesh_.vertices[static_cast<std::size_t>(corners[0])].cast<double>();
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      const Vec3 a = mesh_.vertices[static_cast<std::size_t>(corners[k])].cast<double>() - first;
      const Vec3 b = mesh_.vertices[static_cast<std::size_t>(corners[k + 1])].cast<double>() - first;
      const Vec3 part = a.cross(b);
      sum += part;
      parts += part.norm();
    }
    const double length = sum.norm();
    const bool has_front = length > kLeastOfParts * parts && std::isfinite(length);
    face_normals_.push_back(has_front ? Vec3((mesh_.ccw ? sum : -sum) / length) : Vec3(Vec3::Zero()));
  }
}

void SurfaceDrawer::find_neighbours() {
  first_of_point_.assign(mesh_.vertices.size() + 1, 0);
  const auto visit = [&](auto function) {
    for (std::size_t i = 0; i < mesh_.polygon_count(); ++i) {
      if (face_normals_[i].isZero(0.0)) continue;
      for (const std::int32_t point : mesh_.polygon(i)) function(static_cast<std::size_t>(point), i);
    }
  };
  visit([&](std::size_t point, std::size_t) { ++first_of_point_[point + 1]; });
  for (std::size_t i = 1; i < first_of_point_.size(); ++i) first_of_point_[i] += first_of_point_[i - 1];
  polygons_of_point_.resize(first_of_point_.back());
  std::vector<std::uint32_t> next(first_of_point_.begin(), first_of_point_.end() - 1);
  visit([&](std::size_t point, std::size_t polygon) {
    polygons_of_point_[next[point]++] = static_cast<std::uint32_t>(polygon);
  });
}

// The round solids are drawn round: no two polygons of one round surface are farther apart than that, and caps are.
double SurfaceDrawer::crease_angle_rad() const {
  if (std::holds_alternative<BoxGeometry>(what_.form)) return 0.0;
  if (vrml::find_field(*node_.type, "creaseAngle") != nullptr) return value<float>(node_, "creaseAngle");
  const double step = 2.0 * std::numbers::pi / what_.tessellation.slices;
  return std::min(1.01 * std::max(step, std::numbers::pi / what_.tessellation.stacks), 1.5);
}

bool SurfaceDrawer::all_within(const Indexed& by, std::size_t count) const {
  for (std::size_t i = 0; i < mesh_.polygon_count(); ++i) {
    bool within = true;
    for_each_corner(i, [&](const Corner& c) { within = within && by.at(c.at, c.point, c.polygon) < count; });
    if (!within) return false;
  }
  return true;
}

void SurfaceDrawer::read_colors() {
  if (!is_face_set() && !is_grid()) return;
  const vrml::Node* const color = node_in(what_.document, node_, "color", "Color");
  if (color == nullptr) return;
  colors_ = vectors(values<float>(*color, "color"));
  color_by_.by = !value<bool>(node_, "colorPerVertex") ? Indexed::By::kPolygon
                 : is_face_set()                       ? Indexed::By::kCorner
                                                       : Indexed::By::kPoint;
  if (is_face_set()) color_by_.index = values<std::int32_t>(node_, "colorIndex");
  if (all_within(color_by_, colors_.size())) return;
  note("its colours: they do not match its polygons");
  color_by_ = {};
}

void SurfaceDrawer::read_normals() {
  cos_crease_ = std::cos(std::clamp(crease_angle_rad(), 0.0, std::numbers::pi));
  smooth_ = cos_crease_ < 1.0;
  if (!is_face_set() && !is_grid()) return;
  const vrml::Node* const normal = node_in(what_.document, node_, "normal", "Normal");
  if (normal == nullptr) return;
  normals_ = vectors(values<float>(*normal, "vector"));
  normal_by_.by = !value<bool>(node_, "normalPerVertex") ? Indexed::By::kPolygon
                  : is_face_set()                        ? Indexed::By::kCorner
                                                         : Indexed::By::kPoint;
  if (is_face_set()) normal_by_.index = values<std::int32_t>(node_, "normalIndex");
  const auto unusable = std::ranges::find_if(normals_, [](const Vector3f& n) {
    const double length = n.cast<double>().norm();
    return !std::isfinite(length) || length <= 1e-6;
  });
  if (!all_within(normal_by_, normals_.size())) {
    note("its normals: they do not match its polygons");
  } else if (unusable != normals_.end()) {
    note("its normals: vector " + std::to_string(unusable - normals_.begin()) + " has no length");
  } else {
    return;
  }
  normal_by_ = {};
}

void SurfaceDrawer::read_texture_coordinates() {
  if (!what_.texture || (!is_face_set() && !is_grid())) return;
  const vrml::Node* const given = node_in(what_.document, node_, "texCoord", "TextureCoordinate");
  if (given == nullptr) return;
  texture_coordinates_ = values<float>(*given, "point");
  texture_by_.by = is_face_set() ? Indexed::By::kCorner : Indexed::By::kPoint;
  if (is_face_set()) texture_by_.index = values<std::int32_t>(node_, "texCoordIndex");
  if (all_within(texture_by_, texture_coordinates_.size() / 2)) return;
  note("its texture coordinates: they do not match its polygons");
  texture_by_ = {};
}

Vector3f SurfaceDrawer::normal_at(const Corner& c) {
  if (normal_by_.by != Indexed::By::kNothing) {
    return normals_[normal_by_.at(c.at, c.point, c.polygon)].cast<double>().normalized().cast<float>();
  }
  const Vec3& own = face_normals_[c.polygon];
  if (!smooth_) return own.cast<float>();
  const auto point = static_cast<std::size_t>(c.point);
  const std::uint32_t first = first_of_point_[point], end = first_of_point_[point + 1];
  if (end - first > kPolygonsOfPoint) {
    crowded_ = true;
    return own.cast<float>();
  }
  Vec3 sum = Vec3::Zero();
  for (std::uint32_t i = first; i < end; ++i) {
    const Vec3& other = face_normals_[polygons_of_point_[i]];
    if (own.dot(other) >= cos_crease_ - 1e-9) sum += other;
  }
  const double length = sum.norm();
  return length > 1e-6 ? Vector3f((sum / length).cast<float>()) : Vector3f(own.cast<float>());
}

// The texture is wrapped around the axis counter-clockwise, seen from above, beginning at the back.
Vector2f SurfaceDrawer::around_axis(const Corner& c, float t) const {
  const auto angle = [](double x, double z) {
    const double a = std::atan2(-x, -z);
    return a < 0.0 ? a + 2.0 * std::numbers::pi : a;
  };
  Vec3 middle = Vec3::Zero();
  for (const std::int32_t point : mesh_.polygon(c.polygon)) {
    middle += mesh_.vertices[static_cast<std::size_t>(point)].cast<double>();
  }
  const Vec3 p = mesh_.vertices[static_cast<std::size_t>(c.point)].cast<double>();
  const double of_middle = angle(middle.x(), middle.z());
  double of_corner = std::hypot(p.x(), p.z()) > 0.0 ? angle(p.x(), p.z()) : of_middle;
  if (of_corner < of_middle - std::numbers::pi) of_corner += 2.0 * std::numbers::pi;
  if (of_corner > of_middle + std::numbers::pi) of_corner -= 2.0 * std::numbers::pi;
  return {static_cast<float>(of_corner / (2.0 * std::numbers::pi)), t};
}

Vector2f SurfaceDrawer::default_texture_coordinate(const Corner& c) const {
  const Vector3f p = mesh_.vertices[static_cast<std::size_t>(c.point)];
  const Vec3& n = face_normals_[c.polygon];
  const auto part = [&](int axis, bool reversed = false) {
    const float size = box_.hi[axis] - box_.lo[axis];
    const float at = size > 0.0F ? (p[axis] - box_.lo[axis]) / size : 0.0F;
    return reversed ? 1.0F - at : at;
  };
  const bool is_side = std::abs(n.y()) < 0.9999;
  if (std::holds_alternative<BoxGeometry>(what_.form)) {
    if (std::abs(n.x()) > 0.5) return {part(2, n.x() > 0.0), part(1)};
    if (std::abs(n.y()) > 0.5) return {part(0), part(2, n.y() > 0.0)};
    return {part(0, n.z() < 0.0), part(1)};
  }
  if (std::holds_alternative<SphereGeometry>(what_.form)) {
    const float radius = 0.5F * (box_.hi.y() - box_.lo.y());
    const float height = radius > 0.0F ? std::clamp(p.y() / radius, -1.0F, 1.0F) : 0.0F;
    return around_axis(c, 0.5F + std::asin(height) / std::numbers::pi_v<float>);
  }
  if (std::holds_alternative<ConeGeometry>(what_.form) || std::holds_alternative<CylinderGeometry>(what_.form)) {
    return is_side ? around_axis(c, part(1)) : Vector2f(part(0), part(2, n.y() > 0.0));
  }
  if (const auto* const grid = std::get_if<ElevationGridGeometry>(&what_.form)) {
    const auto columns = static_cast<std::int32_t>(grid->x_dimension);
    const auto column = c.point % columns, row = c.point / columns;
    return {static_cast<float>(column) / static_cast<float>(columns - 1),
            static_cast<float>(row) / static_cast<float>(grid->z_dimension - 1)};
  }
  if (const auto* const extrusion = std::get_if<ExtrusionGeometry>(&what_.form)) {
    const std::size_t edges = extrusion->cross_section.size() - 1, segments = extrusion->spine.size() - 1;
    if (c.polygon < edges * segments) {
      const std::size_t j = c.polygon % edges + (c.k == 1 || c.k == 2 ? 1 : 0);
      const std::size_t i = c.polygon / edges + (c.k >= 2 ? 1 : 0);
      return {static_cast<float>(j) / static_cast<float>(edges), static_cast<float>(i) / static_cast<float>(segments)};
    }
    Eigen::Vector2f lo = Vector2f::Constant(std::numeric_limits<float>::max()), hi = -lo;
    for (const auto& q : extrusion->cross_section) {
      lo = lo.cwiseMin(Vector2f(q[0], q[1]));
      hi = hi.cwiseMax(Vector2f(q[0], q[1]));
    }
    const std::int32_t first = std::ranges::min(mesh_.polygon(c.polygon));
    const auto& q = extrusion->cross_section[static_cast<std::size_t>(c.point - first) % (edges + 1)];
    const float size = std::max((hi - lo).maxCoeff(), std::numeric_limits<float>::min());
    return (Vector2f(q[0], q[1]) - lo) / size;
  }
  // The longest side of the box gives s, the next one t (6.23); of equal ones the first of x, y and z.
  std::array<int, 3> axes = {0, 1, 2};
  const Vector3f size = box_.hi - box_.lo;
  std::ranges::stable_sort(axes, [&](int a, int b) { return size[a] > size[b]; });
  const float longest = std::max(size[axes[0]], std::numeric_limits<float>::min());
  return {(p[axes[0]] - box_.lo[axes[0]]) / longest, (p[axes[1]] - box_.lo[axes[1]]) / longest};
}

std::uint32_t SurfaceDrawer::vertex(const Corner& c, const Vector3f& normal) {
  DrawnGeometry& g = out_.geometry;
  Color color{};
  if (color_by_.by != Indexed::By::kNothing) {
    const Vector3f& at = colors_[color_by_.at(c.at, c.point, c.polygon)];
    color = {at[0], at[1], at[2]};
  }
  Vector2f texture = Vector2f::Zero();
  if (what_.texture) {
    if (texture_by_.by == Indexed::By::kNothing) {
      texture = default_texture_coordinate(c);
    } else {
      const std::size_t at = 2 * texture_by_.at(c.at, c.point, c.polygon);
      texture = {texture_coordinates_[at], texture_coordinates_[at + 1]};
    }
    texture = *what_.texture * texture;
  }
  const auto number = static_cast<std::uint32_t>(g.positions.size());
  if (smooth_ || normal_by_.by != Indexed::By::kNothing) {  // a flat polygon shares its vertices with no other
    VertexKey key{static_cast<std::uint32_t>(c.point)};
    std::memcpy(&key[1], normal.data(), 3 * sizeof(float));
    std::memcpy(&key[4], color.data(), 3 * sizeof(float));
    std::memcpy(&key[7], texture.data(), 2 * sizeof(float));
    const auto [known, is_new] = known_.try_emplace(key, number);
    if (!is_new) return known->second;
  }
  g.positions.push_back(mesh_.vertices[static_cast<std::size_t>(c.point)]);
  g.normals.push_back(normal);
  if (color_by_.by != Indexed::By::kNothing) g.colors.push_back(color);
  if (what_.texture) g.texture_coordinates.push_back(texture);
  if (what_.moving) g.points.push_back(static_cast<std::uint32_t>(c.point));
  return number;
}

// A polygon that crosses itself has triangles that run the other way round. They are turned, so that all its triangles
// show their fronts to one side.
void SurfaceDrawer::draw_polygon(std::size_t polygon) {
  vertices_.clear();
  for_each_corner(polygon, [&](const Corner& c) { vertices_.push_back(vertex(c, normal_at(c))); });
  for (const CornerTriangle& t : triangulator_.triangulate(mesh_, polygon)) {
    const bool runs_back = (mesh_.ccw ? area_of(polygon, t) : -area_of(polygon, t)).dot(face_normals_[polygon]) < 0.0;
    const bool as_written = runs_back != mesh_.ccw;
    add_triangle(vertices_[t[0]], vertices_[t[as_written ? 1 : 2]], vertices_[t[as_written ? 2 : 1]]);
  }
}

// A polygon whose parts make up for each other, as those of a bow tie do, collides and so is drawn: from both sides,
// with the normals of its triangles. Returns whether there is anything to draw.
bool SurfaceDrawer::draw_without_front(std::size_t polygon) {
  bool any = false;
  for (const CornerTriangle& t : triangulator_.triangulate(mesh_, polygon)) {
    const Vec3 area = area_of(polygon, t);
    const double length = area.norm();
    if (!(length > 0.0) || !std::isfinite(length)) continue;
    any = true;
    for (const double side : {1.0, -1.0}) {
      const Vector3f normal = (side / length * area).cast<float>();
      const auto corner = [&](std::size_t k) {
        const std::size_t at = mesh_.polygon_begin[polygon] + t[k];
        return vertex({polygon, t[k], at, mesh_.polygon(polygon)[t[k]]}, normal);
      };
      const std::uint32_t a = corner(0), b = corner(1), c = corner(2);
      add_triangle(a, side > 0.0 ? b : c, side > 0.0 ? c : b);
    }
  }
  return any;
}

// Returns the normal of the triangle as its corners run, as long as twice its area.
Vec3 SurfaceDrawer::area_of(std::size_t polygon, const CornerTriangle& triangle) const {
  const auto at = [&](std::size_t k) -> Vec3 {
    const std::int32_t point = mesh_.polygon(polygon)[triangle[k]];
    return mesh_.vertices[static_cast<std::size_t>(point)].cast<double>();
  };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

GeometryAsDrawn SurfaceDrawer::draw() {
  out_.geometry.form = what_.moving;
  box_ = box_of(mesh_);
  measure_polygons();
  read_colors();
  read_normals();
  read_texture_coordinates();
  if (smooth_ && normal_by_.by == Indexed::By::kNothing) find_neighbours();
  std::size_t flat = 0;
  for (std::size_t i = 0; i < mesh_.polygon_count(); ++i) {
    if (!face_normals_[i].isZero(0.0)) {
      draw_polygon(i);
    } else if (!draw_without_front(i)) {
      ++flat;
    }
  }
  if (flat > 0) note(std::to_string(flat) + (flat == 1 ? " polygon" : " polygons") + " without area");
  if (crowded_) note("its smooth normals at points of more than " + std::to_string(kPolygonsOfPoint) + " polygons");
  return std::move(out_);
}

// The points and colours of an IndexedLineSet or a PointSet.
struct Points {
  std::span<const Vector3f> at, colors;
};
Points points_of(const GeometryToDraw& what) {
  Points out;
  if (const auto* const coord = node_in(what.document, what.node, "coord", "Coordinate")) {
    out.at = vectors(values<float>(*coord, "point"));
  }
  if (const auto* const color = node_in(what.document, what.node, "color", "Color")) {
    out.colors = vectors(values<float>(*color, "color"));
  }
  return out;
}

GeometryAsDrawn draw_points(const GeometryToDraw& what) {
  GeometryAsDrawn out;
  const Points points = points_of(what);
  out.geometry.mode = DrawnGeometry::Mode::kPoints;
  out.geometry.positions.assign(points.at.begin(), points.at.end());
  for (std::uint32_t i = 0; i < points.at.size(); ++i) out.geometry.corners.push_back(i);
  if (points.colors.empty()) return out;
  if (points.colors.size() < points.at.size()) {
    out.left_out.emplace_back("its colours: they do not match its points");
    return out;
  }
  for (std::size_t i = 0; i < points.at.size(); ++i) {
    out.geometry.colors.push_back({points.colors[i][0], points.colors[i][1], points.colors[i][2]});
  }
  return out;
}

GeometryAsDrawn draw_lines(const GeometryToDraw& what) {
  GeometryAsDrawn out;
  DrawnGeometry& g = out.geometry;
  g.mode = DrawnGeometry::Mode::kLines;
  const Points points = points_of(what);
  const auto corners = values<std::int32_t>(what.node, "coordIndex");
  Indexed by;
  if (!points.colors.empty()) {
    by.by = value<bool>(what.node, "colorPerVertex") ? Indexed::By::kCorner : Indexed::By::kPolygon;
    by.index = values<std::int32_t>(what.node, "colorIndex");
  }
  std::size_t line = 0;
  bool is_begun = false, colors_match = true, points_match = true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] == Mesh::kEndOfPolygon) {
      line += is_begun ? 1 : 0;
      is_begun = false;
      continue;
    }
    if (corners[i] < 0 || static_cast<std::size_t>(corners[i]) >= points.at.size()) {
      points_match = is_begun = false;
      continue;
    }
    const auto vertex = static_cast<std::uint32_t>(g.positions.size());
    g.positions.push_back(points.at[static_cast<std::size_t>(corners[i])]);
    if (by.by != Indexed::By::kNothing) {
      const std::size_t color = by.at(i, corners[i], line);
      colors_match = colors_match && color < points.colors.size();
      const Vector3f at = color < points.colors.size() ? points.colors[color] : Vector3f(Vector3f::Ones());
      g.colors.push_back({at[0], at[1], at[2]});
    }
    if (is_begun) g.corners.insert(g.corners.end(), {vertex - 1, vertex});
    is_begun = true;
  }
  if (!points_match) out.left_out.emplace_back("lines to points that it does not have");
  if (!colors_match) {
    out.left_out.emplace_back("its colours: they do not match its lines");
    g.colors.clear();
  }
  return out;
}

}  // namespace

GeometryAsDrawn draw(const GeometryToDraw& what) {
  const auto* const none = std::get_if<NoSurface>(&what.form);
  if (none == nullptr) return SurfaceDrawer(what).draw();
  if (none->type == "IndexedLineSet") return draw_lines(what);
  if (none->type == "PointSet") return draw_points(what);
  return {};  // a Text, which is none of triangles (MeshMaker::text_of)
}

}  // namespace peerd::view
