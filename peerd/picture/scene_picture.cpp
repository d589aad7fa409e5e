#include "peerd/picture/scene_picture.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include "core/motion/carriers.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/rotation.hpp"
#include "core/vrml/document.hpp"
#include "peerd/picture/mesh_maker.hpp"
#include "peerd/picture/node_fields.hpp"
#include "peerd/picture/undrawn_list.hpp"

namespace peerd::picture {
namespace {

std::string_view field_of_children(NodeKind kind) {
  switch (kind) {
    case NodeKind::kLod:
      return "level";
    case NodeKind::kSwitch:
      return "choice";
    default:
      return "children";
  }
}

Color unclamped_color(const vrml::Node& node, std::string_view field) {
  const auto c = values<float>(node, field);
  return {c[0], c[1], c[2]};
}
std::vector<Color> colors_of(const vrml::Node& node, std::string_view field) {
  const auto floats = values<float>(node, field);
  std::vector<Color> out;
  for (std::size_t i = 0; i + 3 <= floats.size(); i += 3) out.push_back({floats[i], floats[i + 1], floats[i + 2]});
  return out;
}
template <class T, class Out>
std::vector<Out> list_of(const vrml::Node& node, std::string_view field) {
  const auto all = values<T>(node, field);
  return {all.begin(), all.end()};
}

class PictureMaker {
 public:
  explicit PictureMaker(const PictureInput& input)
      : input_(input),
        scene_(input.scene),
        document_(*scene_.document),
        motion_(scene_),
        carriers_(scene_, motion_, {}),
        meshes_(scene_, input.load_image, undrawn_) {}

  ScenePicture make();

 private:
  static constexpr std::uint32_t kTop = Instance::kNone;  // no instance: the top level

  void place_nodes();
  void visit(std::span<const vrml::NodeRef> children, std::uint32_t parent, std::uint32_t first, std::uint32_t end);
  void visit_instance(std::uint32_t index);
  void visit_part(const vrml::Node& node, std::uint32_t parent);
  void add_shape(std::uint32_t index);
  void add_light(const vrml::Node& node, DrawnLight::Kind kind, std::uint32_t parent);
  void add_viewpoint(const vrml::Node& node, std::uint32_t parent);
  void add_background(const vrml::Node& node, std::uint32_t parent);
  void add_fog(const vrml::Node& node, std::uint32_t parent);
  void add_navigation(const vrml::Node& node, std::uint32_t parent);
  void name_routes();
  void leave_out(std::uint32_t parent, std::string_view what, const std::string& why) {
    undrawn_.add([&] { return path_in(parent); }, std::string(what), why);
  }
  [[nodiscard]] std::string path_in(std::uint32_t parent) const {
    return parent == kTop ? std::string() : scene_.path_of(scene_.id_of(parent));
  }
  [[nodiscard]] std::uint32_t standing() const { return static_cast<std::uint32_t>(input_.movers.size()); }
  [[nodiscard]] std::uint32_t node_of(std::uint32_t instance) const {
    return instance == kTop ? standing() : node_of_instance_[instance];
  }
  // Maps the frame of the children of an instance to that of its node.
  [[nodiscard]] Eigen::Affine3d node_from(std::uint32_t instance) const;

  const PictureInput& input_;
  const Scene& scene_;
  const vrml::Document& document_;
  PredefinedMotion motion_;
  Carriers carriers_;
  UndrawnList undrawn_;
  MeshMaker meshes_;
  std::vector<std::uint32_t> flexible_;          // geometries
  std::vector<std::uint32_t> node_of_instance_;  // the node that it moves with
  ScenePicture out_;
};

void PictureMaker::place_nodes() {
  std::vector<std::uint32_t> mover(scene_.instances.size(), Instance::kNone);
  for (std::uint32_t i = 0; i < input_.movers.size(); ++i) {
    const PictureInput::Mover& each = input_.movers[i];
    mover[scene_.index_of(each.id)] = i;
    out_.nodes.push_back({each.id, each.pose, each.owner});
    out_.node_paths.push_back(scene_.path_of(each.id));
    out_.node_names.emplace_back(scene_.at(each.id).def);
  }
  out_.nodes.push_back({std::nullopt, {}, kNobody});
  out_.node_paths.emplace_back();
  out_.node_names.emplace_back();
  node_of_instance_.resize(scene_.instances.size());
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const std::int32_t parent = scene_.instances[i].parent;
    assert(parent < static_cast<std::int32_t>(i));
    const std::uint32_t above = parent < 0 ? standing() : node_of_instance_[static_cast<std::uint32_t>(parent)];
    node_of_instance_[i] = mover[i] == Instance::kNone ? above : mover[i];
  }
}

Eigen::Affine3d PictureMaker::node_from(std::uint32_t instance) const {
  if (instance == kTop) return Eigen::Affine3d::Identity();
  const std::uint32_t node = node_of(instance);
  const ObjectId id = scene_.id_of(instance);
  return node == standing() ? scene_.world_from_local(id) : scene_.object_from_shape(input_.movers[node].id, id);
}

// Children that are instances are those that the scene has, in the file's order.
void PictureMaker::visit(std::span<const vrml::NodeRef> children, std::uint32_t parent, std::uint32_t first,
                         std::uint32_t end) {
  std::uint32_t instance = first;
  std::int64_t chosen = -1;  // of a Switch or an LOD, the child that is there; -1: all are
  if (parent != kTop && scene_.instances[parent].kind == NodeKind::kLod) chosen = 0;
  if (parent != kTop && scene_.instances[parent].kind == NodeKind::kSwitch) {
    const std::int32_t which = value<std::int32_t>(document_.nodes[scene_.instances[parent].node], "whichChoice");
    chosen = which < 0 ? static_cast<std::int64_t>(children.size()) : which;
  }
  for (std::uint32_t i = 0; i < children.size(); ++i) {
    if (!children[i].is_node()) continue;
    if (instance != end && scene_.instances[instance].child_index == i) {
      visit_instance(instance);
      instance = scene_.instances[instance].subtree_end;
    } else if (chosen < 0 || chosen == i) {
      visit_part(document_.nodes[children[i].index], parent);
    }
  }
}

void PictureMaker::visit_instance(std::uint32_t index) {
  const Instance& instance = scene_.instances[index];
  if (!instance.drawn || instance.node == Instance::kNone) return;
  if (instance.kind == NodeKind::kShape) return add_shape(index);
  const vrml::Node& node = document_.nodes[instance.node];
  const vrml::Field* const children = node.find(field_of_children(instance.kind));
  const std::size_t count = children == nullptr ? 0 : children->as<vrml::NodeRef>().size();
  if (instance.kind == NodeKind::kBillboard) leave_out(index, "Billboard", "it does not turn towards the viewer");
  if (instance.kind == NodeKind::kLod && count > 1) {
    leave_out(index, "LOD", "its first level is drawn at any distance");
  }
  if (node.type->name == "Anchor") leave_out(index, "Anchor", "its link is not followed");
  if (instance.kind == NodeKind::kInline && children == nullptr) leave_out(index, "Inline", "it has not been read");
  if (count > 0) visit(children->as<vrml::NodeRef>(), index, index + 1, instance.subtree_end);
}

void PictureMaker::add_shape(std::uint32_t index) {
  const ObjectId id = scene_.id_of(index);
  const auto mesh = meshes_.mesh_of(id);
  if (!mesh) return;
  const Eigen::Affine3d at = node_from(index);
  if (!at.matrix().allFinite()) return leave_out(index, "Shape", "its place is beyond what numbers can say");
  out_.shapes.push_back({id, node_of(index), *mesh, at});
  out_.shape_paths.push_back(scene_.path_of(id));
  if (carriers_.distorted(id) || std::ranges::binary_search(flexible_, scene_.instances[index].geometry)) {
    leave_out(index, "Shape", "it changes its shape as the world moves, and keeps that of the picture");
  }
}

void PictureMaker::visit_part(const vrml::Node& node, std::uint32_t parent) {
  const std::string_view type = node.type->name;
  if (node.damaged) return;
  if (type == "DirectionalLight") return add_light(node, DrawnLight::Kind::kDirectional, parent);
  if (type == "PointLight") return add_light(node, DrawnLight::Kind::kPoint, parent);
  if (type == "SpotLight") return add_light(node, DrawnLight::Kind::kSpot, parent);
  if (type == "Viewpoint") return add_viewpoint(node, parent);
  if (type == "Background") return add_background(node, parent);
  if (type == "Fog") return add_fog(node, parent);
  if (type == "NavigationInfo") return add_navigation(node, parent);
  constexpr std::string_view kSensors[] = {"CylinderSensor", "PlaneSensor", "ProximitySensor",
                                           "SphereSensor",   "TouchSensor", "VisibilitySensor"};
  if (std::ranges::find(kSensors, type) != std::end(kSensors)) return leave_out(parent, type, "no viewer works it");
  if (type == "Sound") return leave_out(parent, type, "no viewer plays it");
  if (type == "Script") return leave_out(parent, type, "it is kept and not run");
  if (vrml::find_node_type(type) == nullptr) leave_out(parent, type, "its EXTERNPROTO was not found");
}

void PictureMaker::add_light(const vrml::Node& node, DrawnLight::Kind kind, std::uint32_t parent) {
  if (!value<bool>(node, "on")) return;
  using enum DrawnLight::Kind;
  DrawnLight light;
  light.kind = kind;
  light.node = node_of(parent);
  const Eigen::Affine3d at = node_from(parent);
  Vec3 direction(0, 0, -1);
  if (kind != kPoint) direction = at.linear() * vector_of(node, "direction").cast<double>();
  if (kind != kDirectional) {
    light.node_from_light.position = at * vector_of(node, "location").cast<double>();
    light.attenuation = vector_of(node, "attenuation");
    light.radius_m = value<float>(node, "radius");
  }
  if (kind == kSpot) {
    light.beam_width_rad = value<float>(node, "beamWidth");
    light.cut_off_angle_rad = value<float>(node, "cutOffAngle");
  }
  const bool is_finite = light.node_from_light.position.allFinite() && std::isfinite(direction.norm());
  if (!is_finite || !(direction.norm() > 0.0))
    return leave_out(parent, node.type->name, "it has no direction or place");
  light.node_from_light.orientation = Quat::FromTwoVectors(-Vec3::UnitZ(), direction);
  light.color = unclamped_color(node, "color");
  light.intensity = value<float>(node, "intensity");
  light.ambient_intensity = value<float>(node, "ambientIntensity");
  if (kind == kDirectional && parent != kTop) {
    leave_out(parent, node.type->name, "it shines on everything, not only on its siblings");
  }
  out_.lights.push_back(light);
}

void PictureMaker::add_viewpoint(const vrml::Node& node, std::uint32_t parent) {
  DrawnViewpoint view;
  view.description = value<std::string_view>(node, "description");
  view.node = node_of(parent);
  const Eigen::Affine3d at = node_from(parent);
  view.node_from_camera.position = at * vector_of(node, "position").cast<double>();
  const Quat turned = vrml::to_quat(values<float>(node, "orientation").first<4>());
  // The rigid part of the frame: the product of the rotations of its path.
  Quat above = parent == kTop ? Quat::Identity() : scene_.rigid_pose(scene_.id_of(parent)).orientation;
  if (view.node != standing()) {
    above = scene_.rigid_pose(input_.movers[view.node].id).orientation.conjugate() * above;
  }
  view.node_from_camera.orientation = (above * turned).normalized();
  const double angle = value<float>(node, "fieldOfView");
  if (angle > 0.0 && angle < std::numbers::pi) view.field_of_view_rad = angle;
  if (!view.node_from_camera.position.allFinite()) return leave_out(parent, "Viewpoint", "it has no place");
  out_.viewpoints.push_back(std::move(view));
}

void PictureMaker::add_background(const vrml::Node& node, std::uint32_t parent) {
  if (out_.background) return leave_out(parent, "Background", "nothing binds it: another one is first");
  DrawnBackground& background = out_.background.emplace();
  background.sky_angles_rad = list_of<float, float>(node, "skyAngle");
  background.ground_angles_rad = list_of<float, float>(node, "groundAngle");
  background.sky_colors = colors_of(node, "skyColor");
  background.ground_colors = colors_of(node, "groundColor");
  for (const std::string_view url : {"backUrl", "bottomUrl", "frontUrl", "leftUrl", "rightUrl", "topUrl"}) {
    if (!values<std::string_view>(node, url).empty()) return leave_out(parent, "Background", "its pictures");
  }
}

void PictureMaker::add_fog(const vrml::Node& node, std::uint32_t parent) {
  if (out_.fog) return leave_out(parent, "Fog", "nothing binds it: another one is first");
  out_.fog = {unclamped_color(node, "color"), value<std::string_view>(node, "fogType") == "EXPONENTIAL",
              value<float>(node, "visibilityRange")};
}

void PictureMaker::add_navigation(const vrml::Node& node, std::uint32_t parent) {
  if (out_.navigation) return leave_out(parent, "NavigationInfo", "nothing binds it: another one is first");
  out_.navigation = {list_of<std::string_view, std::string>(node, "type"), list_of<float, float>(node, "avatarSize"),
                     value<float>(node, "speed"), value<float>(node, "visibilityLimit"),
                     value<bool>(node, "headlight")};
}

// ROUTEs into what is drawn and does not move anything.
void PictureMaker::name_routes() {
  for (const vrml::Route& route : document_.routes) {
    const vrml::Node& to = document_.nodes[route.to_node];
    const bool is_seen = to.type->role == vrml::NodeRole::kDisplay || to.type->role == vrml::NodeRole::kSwitch ||
                         to.type->role == vrml::NodeRole::kGeometry;
    if (!is_seen || route.to == nullptr) continue;
    undrawn_.add([&] { return std::string(to.def); }, std::string(to.type->name),
                 "no ROUTE changes its " + std::string(route.to->name));
  }
}

ScenePicture PictureMaker::make() {
  out_.world = input_.world;
  out_.revision = input_.revision;
  flexible_ = motion_.flexible_geometries();
  std::ranges::sort(flexible_);
  place_nodes();
  visit(document_.top_level, kTop, 0, static_cast<std::uint32_t>(scene_.instances.size()));
  name_routes();
  meshes_.finish(out_);
  out_.undrawn = undrawn_.take();
  return std::move(out_);
}

}  // namespace

ScenePicture picture_of(const PictureInput& input) {
  assert(input.scene.document != nullptr);
  return PictureMaker(input).make();
}

}  // namespace peerd::picture
