#include "peerd/view/picture/scene_picture.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include "core/motion/carriers.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/rotation.hpp"
#include "core/vrml/document.hpp"
#include "peerd/peer/node/node_tree.hpp"
#include "peerd/view/frames/driven_looks.hpp"
#include "peerd/view/frames/moving_forms.hpp"
#include "peerd/view/picks/page_sensor.hpp"
#include "peerd/view/picture/mesh_maker.hpp"
#include "peerd/view/picture/node_fields.hpp"
#include "peerd/view/picture/undrawn_list.hpp"

namespace peerd::view {
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
        forms_(view::moving_forms(scene_, motion_, carriers_)),
        looks_(scene_.document),
        meshes_(scene_, input.load_image, looks_, forms_, undrawn_) {}

  ScenePicture make();

 private:
  static constexpr std::uint32_t kTop = Instance::kNone;  // no instance: the top level
  static constexpr std::size_t kPreviews = 100;           // of one sensor; a file may use a node any number of times

  // Which children a node shows.
  struct Choices {
    std::int64_t in_file = -1;            // of a Switch or an LOD, the child that is there as the file has it
    bool is_one = false;                  // one of them is; false: all are
    std::optional<DrawnGroup> each = {};  // the viewer chooses among them
    [[nodiscard]] bool has(std::uint32_t i) const { return !is_one || in_file == i; }
  };

  void place_nodes();
  void visit(std::span<const vrml::NodeRef> children, std::uint32_t parent, std::uint32_t first, std::uint32_t end);
  void visit_instance(std::uint32_t index);
  void visit_children(std::uint32_t index, const vrml::Node& node);
  [[nodiscard]] Choices choices_of(std::uint32_t parent) const;
  void enter_group(std::uint32_t instance, DrawnGroup group);
  void visit_part(const vrml::Node& node, std::uint32_t parent);
  void add_shape(std::uint32_t index);
  void add_light(const vrml::Node& node, DrawnLight::Kind kind, std::uint32_t parent);
  void add_sensor(const vrml::Node& node, std::uint32_t parent);
  void add_previews(DrawnSensor& sensor, std::uint32_t parent);
  void add_viewpoint(const vrml::Node& node, std::uint32_t parent);
  void add_background(const vrml::Node& node, std::uint32_t parent);
  void add_fog(const vrml::Node& node, std::uint32_t parent);
  void add_navigation(const vrml::Node& node, std::uint32_t parent);
  void name_routes();
  void add_tree();
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
  view::MovingForms forms_;
  view::DrivenLooks looks_;
  MeshMaker meshes_;
  std::vector<std::uint32_t> node_of_instance_;  // the node that it moves with
  std::optional<std::uint32_t> group_;           // around what is visited, the innermost
  bool is_chosen_ = true;  // what is visited is there as the file has it: no level or choice that is not
  std::map<std::uint32_t, DrawnSensor> sensors_;   // by their nodes of the document
  std::vector<const vrml::Route*> worked_routes_;  // from sensors, which a page works
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

// The viewer chooses a level of an LOD; a Switch shows what the file, or an edit, has chosen, for no ROUTE can do so: a
// Script alone sends whole numbers.
PictureMaker::Choices PictureMaker::choices_of(std::uint32_t parent) const {
  Choices choices;
  if (parent == kTop) return choices;
  const Instance& instance = scene_.instances[parent];
  const vrml::Node& node = document_.nodes[instance.node];
  if (instance.kind == NodeKind::kLod) {
    choices = {0, true, std::nullopt};
    if (!input_.all_levels) return choices;
    choices.each = DrawnGroup{.kind = DrawnGroup::Kind::kLevel};
    choices.each->center = vector_of(node, "center");
    choices.each->ranges_m = list_of<float, float>(node, "range");
  } else if (instance.kind == NodeKind::kSwitch) {
    choices = {value<std::int32_t>(node, "whichChoice"), true, std::nullopt};
  }
  return choices;
}

void PictureMaker::enter_group(std::uint32_t instance, DrawnGroup group) {
  const Eigen::Affine3d at = node_from(instance);
  if (!at.matrix().allFinite()) return;  // nor are its Shapes drawn
  group.id = scene_.id_of(instance);
  group.node = node_of(instance);
  group.above = group_;
  group.node_from_group = at;
  group_ = static_cast<std::uint32_t>(out_.groups.size());
  out_.groups.push_back(std::move(group));
  out_.group_paths.push_back(path_in(instance));
}

// Children that are instances are those that the scene has, in the file's order.
void PictureMaker::visit(std::span<const vrml::NodeRef> children, std::uint32_t parent, std::uint32_t first,
                         std::uint32_t end) {
  std::uint32_t instance = first;
  const Choices choices = choices_of(parent);
  const bool grouped = choices.each && children.size() > 1;
  if (!input_.all_levels && children.size() > 1 && parent != kTop && scene_.instances[parent].kind == NodeKind::kLod) {
    leave_out(parent, "LOD", "its first level, which collides, stands for all");
  }
  for (std::uint32_t i = 0; i < children.size(); ++i) {
    if (!children[i].is_node()) continue;
    const bool is_instance = instance != end && scene_.instances[instance].child_index == i;
    const auto outer = group_;
    const bool outer_is_chosen = std::exchange(is_chosen_, is_chosen_ && choices.has(i));
    if (grouped) {
      DrawnGroup group = *choices.each;
      group.number = i;
      group.count = static_cast<std::uint32_t>(children.size());
      enter_group(parent, std::move(group));
    }
    if (choices.each || choices.has(i)) {
      if (is_instance) {
        visit_instance(instance);
      } else {
        visit_part(document_.nodes[children[i].index], parent);
      }
    }
    if (is_instance) instance = scene_.instances[instance].subtree_end;
    group_ = outer;
    is_chosen_ = outer_is_chosen;
  }
}

void PictureMaker::visit_instance(std::uint32_t index) {
  const Instance& instance = scene_.instances[index];
  if (instance.node == Instance::kNone) return;
  if (instance.kind == NodeKind::kShape) return add_shape(index);
  const vrml::Node& node = document_.nodes[instance.node];
  const auto outer = group_;
  if (instance.kind == NodeKind::kBillboard) {
    DrawnGroup group{.kind = DrawnGroup::Kind::kBillboard};
    group.axis = vector_of(node, "axisOfRotation");
    enter_group(index, std::move(group));
  } else if (node.type->name == "Anchor") {
    DrawnGroup group{.kind = DrawnGroup::Kind::kAnchor};
    group.urls = list_of<std::string_view, std::string>(node, "url");
    group.description = value<std::string_view>(node, "description");
    enter_group(index, std::move(group));
  }
  visit_children(index, node);
  group_ = outer;
}

void PictureMaker::visit_children(std::uint32_t index, const vrml::Node& node) {
  const Instance& instance = scene_.instances[index];
  const vrml::Field* const children = node.find(field_of_children(instance.kind));
  if (instance.kind == NodeKind::kInline && children == nullptr) leave_out(index, "Inline", "it has not been read");
  if (children == nullptr || children->count == 0) return;
  visit(children->as<vrml::NodeRef>(), index, index + 1, instance.subtree_end);
}

void PictureMaker::add_shape(std::uint32_t index) {
  const ObjectId id = scene_.id_of(index);
  const auto text = meshes_.text_of(id);
  const auto mesh = text ? std::optional(DrawnShape::kNoMesh) : meshes_.mesh_of(id);
  if (!mesh) return;
  const Eigen::Affine3d at = node_from(index);
  if (!at.matrix().allFinite()) return leave_out(index, "Shape", "its place is beyond what numbers can say");
  out_.shapes.push_back({id, node_of(index), *mesh, at, group_, forms_.of_shape(id), text});
  out_.shape_paths.push_back(scene_.path_of(id));
}

void PictureMaker::visit_part(const vrml::Node& node, std::uint32_t parent) {
  const std::string_view type = node.type->name;
  if (node.damaged) return;
  if (!is_chosen_) {
    if (type.ends_with("Light")) leave_out(parent, type, "it is in a level beyond the first");
    return;
  }
  if (type == "DirectionalLight") return add_light(node, DrawnLight::Kind::kDirectional, parent);
  if (type == "PointLight") return add_light(node, DrawnLight::Kind::kPoint, parent);
  if (type == "SpotLight") return add_light(node, DrawnLight::Kind::kSpot, parent);
  if (type == "Viewpoint") return add_viewpoint(node, parent);
  if (type == "Background") return add_background(node, parent);
  if (type == "Fog") return add_fog(node, parent);
  if (type == "NavigationInfo") return add_navigation(node, parent);
  if (view::is_page_sensor(type)) return add_sensor(node, parent);
  if (type == "VisibilitySensor") return leave_out(parent, type, "no viewer works it");
  if (type == "Sound") return leave_out(parent, type, "no viewer plays it");
  if (type == "Script") return leave_out(parent, type, "it is kept and not run");
  if (vrml::find_node_type(type) == nullptr) leave_out(parent, type, "its EXTERNPROTO was not found");
}

void PictureMaker::add_light(const vrml::Node& node, DrawnLight::Kind kind, std::uint32_t parent) {
  const auto number = static_cast<std::uint32_t>(&node - document_.nodes.data());
  const auto driven_on = looks_.find(number, "on");
  if (!value<bool>(node, "on") && !driven_on) return;
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
  light.on = value<bool>(node, "on");
  light.driven_on = driven_on;
  light.driven_color = looks_.find(number, "color");
  light.driven_intensity = looks_.find(number, "intensity");
  if (kind == kDirectional && parent != kTop) {
    leave_out(parent, node.type->name, "it shines on everything, not only on its siblings");
  }
  out_.lights.push_back(light);
}

// A file may use one sensor in many places: what it does is read once.
void PictureMaker::add_sensor(const vrml::Node& node, std::uint32_t parent) {
  const auto number = static_cast<std::uint32_t>(&node - document_.nodes.data());
  const auto [known, is_new] = sensors_.try_emplace(number);
  DrawnSensor& sensor = known->second;
  if (is_new) {
    view::SensorReading reading = view::read_sensor(scene_, number);
    for (const std::string& why : reading.left_out) leave_out(parent, reading.sensor.type, why);
    worked_routes_.insert(worked_routes_.end(), reading.worked.begin(), reading.worked.end());
    sensor.what = std::move(reading.sensor);
    if (sensor.what.enabled) add_previews(sensor, parent);
  }
  const Eigen::Affine3d at = node_from(parent);
  if (sensor.what.targets.empty() || !at.matrix().allFinite() || !sensor.what.enabled) return;
  sensor.node = node_of(parent);
  sensor.node_from_sensor = at;
  out_.sensors.push_back(sensor);
  out_.sensor_paths.push_back(path_in(parent));
}

// A sensor's previews: all that its ROUTEs translate and turn, wherever the file uses it.
void PictureMaker::add_previews(DrawnSensor& sensor, std::uint32_t parent) {
  for (std::uint32_t i = 0; i < sensor.what.targets.size(); ++i) {
    const view::PageSensor::Target& target = sensor.what.targets[i];
    const vrml::Node& node = document_.nodes[target.node];
    const bool turns = target.field == "rotation";
    if (node.type->name != "Transform" || (!turns && target.field != "translation")) continue;
    for (std::uint32_t at = 0; at < scene_.instances.size(); ++at) {
      const Instance& instance = scene_.instances[at];
      const std::uint32_t above = instance.parent < 0 ? kTop : static_cast<std::uint32_t>(instance.parent);
      if (instance.node != target.node || node_of(at) != node_of(above)) continue;
      if (sensor.previews.size() == kPreviews) {
        return leave_out(parent, sensor.what.type, "a drag is shown in 100 places, and not in all that it moves");
      }
      Eigen::Affine3d frame = node_from(above);
      if (turns) frame.translate((vector_of(node, "translation") + vector_of(node, "center")).cast<double>());
      if (!frame.matrix().allFinite()) continue;  // nor are its Shapes drawn
      sensor.previews.push_back(
          {i, path_in(at), node_of(at), frame, list_of<float, float>(node, turns ? "rotation" : "translation")});
    }
  }
}

void PictureMaker::add_viewpoint(const vrml::Node& node, std::uint32_t parent) {
  DrawnViewpoint view;
  view.def = node.def;
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
    if (!is_seen || route.to == nullptr || looks_.find(route.to_node, route.to->name)) continue;
    if (std::ranges::find(worked_routes_, &route) != worked_routes_.end()) continue;
    undrawn_.add([&] { return std::string(to.def); }, std::string(to.type->name),
                 "no ROUTE changes its " + std::string(route.to->name));
  }
}

void PictureMaker::add_tree() {
  NodeTree tree = node_tree(scene_);
  out_.tree.left_out = tree.left_out;
  out_.tree.rows.reserve(tree.rows.size());
  for (NodeRow& row : tree.rows) {
    const vrml::Node& node = document_.nodes[row.node];
    out_.tree.rows.push_back({row.depth, std::string(node.type->name), std::move(row.name), std::string(node.def)});
  }
}

ScenePicture PictureMaker::make() {
  out_.world = input_.world;
  out_.revision = input_.revision;
  place_nodes();
  visit(document_.top_level, kTop, 0, static_cast<std::uint32_t>(scene_.instances.size()));
  name_routes();
  meshes_.finish(out_);
  add_tree();
  out_.undrawn = undrawn_.take();
  return std::move(out_);
}

}  // namespace

ScenePicture picture_of(const PictureInput& input) {
  assert(input.scene.document != nullptr);
  return PictureMaker(input).make();
}

}  // namespace peerd::view
