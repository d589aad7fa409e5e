#include "peerd/lab/recorded/foxglove_messages.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"

namespace peerd::recorded {
namespace {

using Json = nlohmann::ordered_json;
using view::Color;

constexpr double kMark_s = 3.0;
constexpr double kArrow_m = 1.0;

Json time_of(double t_s) {
  const double whole = std::floor(t_s);
  return {{"sec", static_cast<std::int64_t>(whole)}, {"nsec", static_cast<std::int64_t>((t_s - whole) * 1e9)}};
}

Json vector_of(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }
Json vector_of(const Vec3& v) { return vector_of(v.x(), v.y(), v.z()); }
Json quaternion_of(const Quat& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }
Json pose_of(const Pose& pose) {
  return {{"position", vector_of(pose.position)}, {"orientation", quaternion_of(pose.orientation)}};
}
Json color_of(const Color& c, double alpha) { return {{"r", c[0]}, {"g", c[1]}, {"b", c[2]}, {"a", alpha}}; }

Json entity(double t_s, const std::string& id, const std::string& frame) {
  return {{"timestamp", time_of(t_s)},  {"frame_id", frame},      {"id", id},
          {"lifetime", time_of(0.0)},   {"frame_locked", true},   {"metadata", Json::array()},
          {"arrows", Json::array()},    {"cubes", Json::array()}, {"spheres", Json::array()},
          {"cylinders", Json::array()}, {"lines", Json::array()}, {"triangles", Json::array()},
          {"texts", Json::array()},     {"models", Json::array()}};
}

Json points_of(const view::DrawnGeometry& geometry, const view::DrawnShape& shape) {
  Json points = Json::array();
  for (const Eigen::Vector3f& p : geometry.positions) {
    points.push_back(vector_of(shape.node_from_shape * p.cast<double>()));
  }
  return points;
}

// Whether that format can show the Shape: no text, and of an LOD the first level alone.
bool can_show(const view::ScenePicture& scene, const view::DrawnShape& shape) {
  if (shape.mesh == view::DrawnShape::kNoMesh) return false;
  for (auto group = shape.group; group; group = scene.groups[*group].above) {
    if (scene.groups[*group].kind == view::DrawnGroup::Kind::kLevel && scene.groups[*group].number > 0) return false;
  }
  return true;
}

// Triangles, or lines one by one. Points have no size in that format, and are left out.
void add_shape(Json& entity, const view::ScenePicture& scene, const view::DrawnShape& shape) {
  using Mode = view::DrawnGeometry::Mode;
  const view::DrawnMesh& mesh = scene.meshes[shape.mesh];
  const view::DrawnGeometry& geometry = scene.geometries[mesh.geometry];
  const view::DrawnMaterial& material = scene.materials[mesh.material];
  const double alpha = 1.0 - material.transparency;
  Json colors = Json::array();
  for (const Color& color : geometry.colors) colors.push_back(color_of(color, alpha));
  Json primitive = {{"pose", pose_of(Pose{})},
                    {"points", points_of(geometry, shape)},
                    {"color", color_of(material.lit ? material.diffuse : material.emissive, alpha)},
                    {"colors", std::move(colors)},
                    {"indices", geometry.corners}};
  if (geometry.mode == Mode::kTriangles) {
    entity["triangles"].push_back(std::move(primitive));
  } else if (geometry.mode == Mode::kLines) {
    primitive.update({{"type", 2}, {"thickness", 1.0}, {"scale_invariant", true}});
    entity["lines"].push_back(std::move(primitive));
  }
}

Json schema_of(const std::string& name, Json properties) {
  return {{"title", name}, {"type", "object"}, {"properties", std::move(properties)}};
}
Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }
Json numbers(std::initializer_list<const char*> names, const char* type = "number") {
  Json properties = Json::object();
  for (const char* const name : names) properties[name] = {{"type", type}};
  return {{"type", "object"}, {"properties", properties}};
}
Json time_schema() { return numbers({"sec", "nsec"}, "integer"); }
Json text_schema() { return {{"type", "string"}}; }
Json object_schema(Json properties) { return {{"type", "object"}, {"properties", std::move(properties)}}; }

}  // namespace

std::string frame_transforms_schema() {
  const Json transform = object_schema({{"timestamp", time_schema()},
                                        {"parent_frame_id", text_schema()},
                                        {"child_frame_id", text_schema()},
                                        {"translation", numbers({"x", "y", "z"})},
                                        {"rotation", numbers({"x", "y", "z", "w"})}});
  return json_line(schema_of(kFrameTransforms, {{"transforms", list_of(transform)}}));
}

std::string scene_update_schema() {
  const Json anything = list_of({{"type", "object"}});
  Json of_entity = {{"timestamp", time_schema()},
                    {"frame_id", text_schema()},
                    {"id", text_schema()},
                    {"lifetime", time_schema()},
                    {"frame_locked", {{"type", "boolean"}}}};
  for (const char* const part :
       {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"}) {
    of_entity[part] = anything;
  }
  const Json deletion =
      object_schema({{"timestamp", time_schema()}, {"type", {{"type", "integer"}}}, {"id", text_schema()}});
  return json_line(
      schema_of(kSceneUpdate, {{"deletions", list_of(deletion)}, {"entities", list_of(object_schema(of_entity))}}));
}

std::string frame_transforms(double t_s, const std::vector<Transform>& transforms) {
  Json rows = Json::array();
  for (const Transform& t : transforms) {
    rows.push_back({{"timestamp", time_of(t_s)},
                    {"parent_frame_id", t.parent},
                    {"child_frame_id", t.child},
                    {"translation", vector_of(t.pose.position)},
                    {"rotation", quaternion_of(t.pose.orientation)}});
  }
  return json_line({{"transforms", rows}});
}

std::string scene_update(double t_s, const view::ScenePicture& scene, const std::string& prefix,
                         const std::string& world, std::vector<std::string>& before) {
  std::vector<Json> of_node;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const std::string frame = scene.nodes[i].id ? prefix + scene.node_paths[i] : world;
    ids.push_back(scene.nodes[i].id ? frame : prefix + "(what stands)");
    of_node.push_back(entity(t_s, ids.back(), frame));
  }
  for (const view::DrawnShape& shape : scene.shapes) {
    if (can_show(scene, shape)) add_shape(of_node[shape.node], scene, shape);
  }
  Json deletions = Json::array();
  for (const std::string& id : before) {
    if (std::ranges::find(ids, id) == ids.end()) {
      deletions.push_back({{"timestamp", time_of(t_s)}, {"type", 0}, {"id", id}});
    }
  }
  before = std::move(ids);
  return json_line({{"deletions", deletions}, {"entities", of_node}});
}

std::string contact_mark(double t_s, const ContactMark& mark, const std::string& world) {
  Json e = entity(t_s, mark.id, world);
  e["lifetime"] = time_of(kMark_s);
  const Quat along = Quat::FromTwoVectors(Vec3::UnitX(), mark.normal);  // arrows point along +x
  const Json color = color_of({1.0F, 0.7F, 0.1F}, 1.0);
  e["arrows"].push_back({{"pose", pose_of({mark.position, along})},
                         {"shaft_length", 0.7 * kArrow_m},
                         {"shaft_diameter", 0.08 * kArrow_m},
                         {"head_length", 0.3 * kArrow_m},
                         {"head_diameter", 0.2 * kArrow_m},
                         {"color", color}});
  e["texts"].push_back({{"pose", pose_of({mark.position, Quat::Identity()})},
                        {"billboard", true},
                        {"font_size", 14.0},
                        {"scale_invariant", true},
                        {"color", color},
                        {"text", mark.sentence}});
  return json_line({{"deletions", Json::array()}, {"entities", Json::array({e})}});
}

}  // namespace peerd::recorded
