#include "core/x3d/polygon_sets.hpp"

#include <algorithm>
#include <cassert>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/vrml/element_positions.hpp"
#include "core/x3d/x3d_words.hpp"

namespace peerd::vrml {
namespace {

using Corners = std::vector<std::int32_t>;  // indices of points; -1 ends a polygon

// How the corners of a set make polygons (ISO/IEC 19775-1, 11.4).
enum class Shaping : std::uint8_t { kPolygons, kFan, kStrip };

void add_polygon(Corners& out, std::initializer_list<std::int32_t> corners) {
  out.insert(out.end(), corners);
  out.push_back(-1);
}

// Adds the triangles of one fan or one strip. Every second triangle of a strip is turned, so that all face one way.
void add_triangles(Corners& out, Shaping shaping, std::span<const std::int32_t> run) {
  for (std::size_t i = 2; i < run.size(); ++i) {
    if (shaping == Shaping::kFan) {
      add_polygon(out, {run[0], run[i - 1], run[i]});
    } else if (i % 2 == 0) {
      add_polygon(out, {run[i - 2], run[i - 1], run[i]});
    } else {
      add_polygon(out, {run[i - 1], run[i - 2], run[i]});
    }
  }
}

class PolygonSets {
 public:
  PolygonSets(Document& document, Problems& problems, const ReadLimits& limits)
      : document_(document),
        problems_(problems),
        left_(limits.expansion * (std::uint64_t{1} << 24) + limits.expansion * 8 * problems.bytes()) {}

  void keep() {
    for (Node& node : document_.nodes) {
      if (node.type->name == "ColorRGBA" && find_x3d_type("ColorRGBA") == node.type) {
        make_color(node);
      } else if (const auto shape = shape_of(*node.type)) {
        make_face_set(node, *shape);
      }
    }
    std::erase_if(document_.routes, [this](Route& route) { return !keep_route(route); });
  }

 private:
  struct Shape {
    Shaping shaping;
    std::size_t corners;  // of a polygon
    std::string_view counts;
    bool indexed;
  };

  static std::optional<Shape> shape_of(const NodeType& type) {
    constexpr std::pair<std::string_view, Shape> kShapes[] = {
        {"IndexedQuadSet", {Shaping::kPolygons, 4, "", true}},
        {"IndexedTriangleFanSet", {Shaping::kFan, 3, "", true}},
        {"IndexedTriangleSet", {Shaping::kPolygons, 3, "", true}},
        {"IndexedTriangleStripSet", {Shaping::kStrip, 3, "", true}},
        {"QuadSet", {Shaping::kPolygons, 4, "", false}},
        {"TriangleFanSet", {Shaping::kFan, 3, "fanCount", false}},
        {"TriangleSet", {Shaping::kPolygons, 3, "", false}},
        {"TriangleStripSet", {Shaping::kStrip, 3, "stripCount", false}},
    };
    if (type.role != NodeRole::kGeometry || find_node_type(type.name) == &type) return std::nullopt;
    for (const auto& [name, shape] : kShapes) {
      if (name == type.name && find_x3d_type(name) == &type) return shape;
    }
    return std::nullopt;
  }

  void make_color(Node& node) {
    const NodeType& color = *find_node_type("Color");
    std::vector<Field> fields;
    for (const Field& field : node.given()) {
      const std::span<const float> rgba = field.as<float>();
      const std::span<float> rgb = document_.arena.allocate<float>(rgba.size() / 4 * 3);
      bool opaque = true;
      for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = rgba[i / 3 * 4 + i % 3];
      for (std::size_t i = 3; i < rgba.size(); i += 4) opaque = opaque && rgba[i] == 1.0F;
      if (!opaque) problems_.warning(node.at, "the opacity of the colors of this ColorRGBA is not kept");
      fields.push_back({find_field(color, "color"), rgb.data(), static_cast<std::uint32_t>(rgb.size()), field.at});
    }
    take(node, color, fields);
  }

  void make_face_set(Node& node, const Shape& shape) {
    const NodeType& face_set = *find_node_type("IndexedFaceSet");
    std::vector<Field> fields;
    for (const Field& field : node.given()) {
      if (const FieldSpec* const same = find_field(face_set, field.spec->name)) {
        fields.push_back(field);
        fields.back().spec = same;
      }
    }
    const Field* const index = node.find("index");
    const Field* const counts = shape.counts.empty() ? nullptr : node.find(shape.counts);
    const Corners* const corners = corners_of(node, shape, index, counts);
    if (corners != nullptr && !corners->empty()) {
      fields.push_back({find_field(face_set, "coordIndex"), corners->data(),
                        static_cast<std::uint32_t>(corners->size()),
                        index != nullptr    ? index->at
                        : counts != nullptr ? counts->at
                                            : node.at});
    }
    // Normals that are not given are those of smooth corners; an IndexedFaceSet has flat polygons by itself.
    const Field* const per_vertex = node.find("normalPerVertex");
    const Field* const normal = node.find("normal");
    const bool smooth = (normal == nullptr || normal->count == 0 || !normal->as<NodeRef>()[0].is_node()) &&
                        (per_vertex == nullptr || per_vertex->as<bool>()[0]);
    if (smooth) {
      fields.push_back({find_field(face_set, "creaseAngle"),
                        document_.arena.copy(std::span<const float>(&kHalfTurn, 1)).data(), 1, node.at});
    }
    take(node, face_set, fields);
  }

  // Returns the polygons of a set; null where it has none, or an error is reported. Sets of the same corners share
  // them.
  const Corners* corners_of(const Node& node, const Shape& shape, const Field* index, const Field* counts) {
    const std::size_t points = points_of(node);
    const Field* const list = shape.indexed ? index : counts;
    const auto key = std::tuple(node.type, list == nullptr ? nullptr : list->data, points);
    if (const auto known = known_.find(key); known != known_.end()) return known->second.get();
    auto made = std::make_shared<Corners>();
    const Position at = list == nullptr ? node.at : list->at;
    bool good = points > 0;
    if (!good) {
      if (list != nullptr)
        problems_.warning(at, "this " + std::string(node.type->name) + " has no points: it has no polygons");
    } else if (shape.indexed) {
      if (index != nullptr) {
        good = check_index(shape, index->as<std::int32_t>(), points, at) &&
               add_indexed(*made, shape, index->as<std::int32_t>(), at);
      }
    } else if (shape.shaping == Shaping::kPolygons) {
      good = add_in_order(*made, shape, points, at);
    } else if (counts != nullptr) {
      good = add_runs(*made, shape, counts->as<std::int32_t>(), points, at);
    }
    if (good) document_.arrays.push_back(made);
    if (!good) made.reset();
    return known_.emplace(key, std::move(made)).first->second.get();
  }

  [[nodiscard]] std::size_t points_of(const Node& node) const {
    const Field* const coord = node.find("coord");
    if (coord == nullptr || coord->count == 0 || !coord->as<NodeRef>()[0].is_node()) return 0;
    const Field* const point = document_.nodes[coord->as<NodeRef>()[0].index].find("point");
    return point == nullptr ? 0 : point->count / 3;
  }

  // Takes numbers from what the file may grow to; false, and an error, where there are not so many.
  bool take_room(std::uint64_t numbers, Position at) {
    if (numbers <= left_) {
      left_ -= numbers;
      return true;
    }
    left_ = 0;
    if (std::exchange(full_, true)) return false;
    problems_.error(at, "with this node there are more polygons than a file of this size may ask for" +
                            std::string(ReadLimits::kRaised));
    return false;
  }

  // Fans and strips end at -1.
  bool check_index(const Shape& shape, std::span<const std::int32_t> index, std::size_t points, Position at) {
    const bool ends = shape.shaping != Shaping::kPolygons;
    for (std::size_t i = 0; i < index.size(); ++i) {
      if ((ends && index[i] == -1) || (index[i] >= 0 && static_cast<std::size_t>(index[i]) < points)) continue;
      ElementPositions positions(problems_.text_of(at), problems_.begin_of(at), at);
      problems_.fault(positions.at(i),
                      "index has " + std::to_string(index[i]) + ", but coord has " + std::to_string(points) +
                          " points, numbered from 0",
                      "this node has no polygons");
      return false;
    }
    return true;
  }

  bool add_indexed(Corners& out, const Shape& shape, std::span<const std::int32_t> index, Position at) {
    if (!take_room(4 * index.size(), at)) return false;
    if (shape.shaping == Shaping::kPolygons) {
      for (std::size_t i = 0; i + shape.corners <= index.size(); i += shape.corners) {
        const auto polygon = index.subspan(i, shape.corners);
        out.insert(out.end(), polygon.begin(), polygon.end());
        out.push_back(-1);
      }
      warn_of_rest(index.size() % shape.corners, at);
      return true;
    }
    for (std::size_t begin = 0; begin < index.size();) {
      const auto end = static_cast<std::size_t>(
          std::ranges::find_if(index.subspan(begin), [](std::int32_t corner) { return corner < 0; }) - index.begin());
      const auto run = index.subspan(begin, end - begin);
      if (run.size() == 1 || run.size() == 2) warn_of_rest(run.size(), at);
      add_triangles(out, shape.shaping, run);
      begin = end + 1;
    }
    return true;
  }

  bool add_in_order(Corners& out, const Shape& shape, std::size_t points, Position at) {
    if (!take_room(2 * points, at)) return false;
    for (std::size_t i = 0; i + shape.corners <= points; i += shape.corners) {
      for (std::size_t corner = i; corner < i + shape.corners; ++corner) {
        out.push_back(static_cast<std::int32_t>(corner));
      }
      out.push_back(-1);
    }
    warn_of_rest(points % shape.corners, at);
    return true;
  }

  bool add_runs(Corners& out, const Shape& shape, std::span<const std::int32_t> counts, std::size_t points,
                Position at) {
    if (!take_room(4 * static_cast<std::uint64_t>(points), at)) return false;
    std::size_t begin = 0;
    Corners run;
    for (const std::int32_t count : counts) {
      if (count < 3) {
        problems_.fault(at, "a fan or a strip has at least three points, and not " + std::to_string(count),
                        "this node has no polygons");
        return false;
      }
      if (static_cast<std::size_t>(count) > points - begin) {
        problems_.fault(
            at, "there are " + std::to_string(points) + " points, fewer than the fans or strips of this node take",
            "this node has no polygons");
        return false;
      }
      run.resize(static_cast<std::size_t>(count));
      for (std::size_t i = 0; i < run.size(); ++i) run[i] = static_cast<std::int32_t>(begin + i);
      add_triangles(out, shape.shaping, run);
      begin += run.size();
    }
    warn_of_rest(points - begin, at);
    return true;
  }

  void warn_of_rest(std::size_t count, Position at) {
    if (count == 0) return;
    problems_.warning(at, count == 1 ? "one corner makes no polygon; it is left out"
                                     : std::to_string(count) + " corners make no polygon; they are left out");
  }

  void take(Node& node, const NodeType& type, const std::vector<Field>& fields) {
    const auto kept = document_.arena.copy(std::span<const Field>(fields));
    node.type = &type;
    node.fields = kept.data();
    node.field_count = static_cast<std::uint32_t>(kept.size());
  }

  bool keep_route(Route& route) {
    const auto kept = [&](std::uint32_t node, const FieldSpec*& spec) {
      const NodeType& type = *document_.nodes[node].type;
      if (type.name != "IndexedFaceSet" && type.name != "Color") return true;
      const bool own =
          !type.fields.empty() && spec >= type.fields.data() && spec < type.fields.data() + type.fields.size();
      if (own) return true;
      const FieldSpec* const same = find_field(type, spec->name);
      if (same == nullptr || same->type != spec->type) {
        problems_.warning(route.at, quoted(spec->name) + " is a field of X3D that is not kept; the ROUTE is left out");
        return false;
      }
      spec = same;
      return true;
    };
    return kept(route.from_node, route.from) && kept(route.to_node, route.to);
  }

  static constexpr float kHalfTurn = 3.1415927F;  // [rad]

  Document& document_;
  Problems& problems_;
  std::uint64_t left_;  // numbers that sets may still become
  bool full_ = false;   // there were too many, which is reported
  std::map<std::tuple<const NodeType*, const void*, std::size_t>, std::shared_ptr<Corners>> known_;
};

}  // namespace

void keep_polygon_sets(Document& document, Problems& problems, const ReadLimits& limits) {
  PolygonSets(document, problems, limits).keep();
}

}  // namespace peerd::vrml
