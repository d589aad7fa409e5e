#include "core/formats/gltf/gltf_reader.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/formats/draft/node_draft.hpp"
#include "core/formats/gltf/accessors.hpp"
#include "core/formats/gltf/animations.hpp"
#include "core/formats/gltf/buffers.hpp"
#include "core/formats/gltf/container.hpp"
#include "core/formats/gltf/materials.hpp"
#include "core/formats/gltf/placement.hpp"
#include "core/formats/gltf/primitives.hpp"

namespace peerd::formats::gltf {
namespace {

using vrml::NodeRef;

// The memory that the library may need for the JSON [bytes], whatever its size and for each of its bytes. Files as
// people have them need about 14 bytes a byte.
constexpr std::uint64_t kBaseMemory = std::uint64_t{1} << 25, kMemoryOfByte = 18;

// The extensions whose content is read, or changes nothing that is read.
constexpr std::array<std::string_view, 3> kReadExtensions{"KHR_lights_punctual", "KHR_mesh_quantization",
                                                          "KHR_materials_unlit"};

bool is_read(const std::string& extension) {
  return std::ranges::find(kReadExtensions, extension) != kReadExtensions.end();
}

// Full light makes a white surface white: a viewer of glTF divides by pi (Lambert).
float full_share(double intensity) { return static_cast<float>(std::clamp(intensity / std::numbers::pi, 0.0, 1.0)); }

class GltfReader {
 public:
  GltfReader(const tinygltf::Model& model, const Buffers& buffers, const std::vector<ImageSource>& images,
             Reading& reading)
      : model_(model),
        accessors_(model, buffers, reading),
        materials_(model, buffers, images, reading),
        primitives_(model, accessors_, materials_, reading),
        transforms_(model.nodes.size()),
        visited_(model.nodes.size(), false),
        parents_(model.nodes.size()),
        reading_(reading) {}

  bool read();

 private:
  bool fail(const std::string& why) { return reading_.fail(0, why); }
  bool check_extensions();
  std::optional<std::vector<int>> roots();
  bool add_node(int index, std::size_t depth, const Mat3& above, std::vector<NodeRef>& siblings);
  bool set_placement(const tinygltf::Node& node, const std::string& path, NodeDraft& draft);
  void add_camera(const tinygltf::Node& node, const std::string& path, std::vector<NodeRef>& children);
  bool add_light(const tinygltf::Node& node, const std::string& path, const Mat3& world,
                 std::vector<NodeRef>& children);
  void name_what_is_not_kept(const tinygltf::Node& node, const std::string& path);
  void name_suns_that_would_turn();

  const tinygltf::Model& model_;
  Accessors accessors_;
  Materials materials_;
  Primitives primitives_;
  std::vector<NodeRef> transforms_;                  // of the nodes that are in the scene
  std::vector<bool> visited_;                        // nodes
  std::vector<std::optional<std::size_t>> parents_;  // of nodes
  std::vector<NodeRef> suns_;                        // directional lights, which shine on all
  std::vector<std::size_t> sun_nodes_;               // that have them
  Reading& reading_;
};

bool GltfReader::check_extensions() {
  for (const std::string& extension : model_.extensionsRequired) {
    if (!is_read(extension))
      return fail("it requires the extension " + vrml::quoted(extension) + ", which is not read");
  }
  std::set<std::string> unread(model_.extensionsUsed.begin(), model_.extensionsUsed.end());
  for (const auto& [extension, value] : model_.extensions) unread.insert(extension);
  for (const std::string& extension : unread) {
    if (!is_read(extension)) reading_.warn(0, "the extension " + vrml::quoted(extension) + " is not read");
  }
  return true;
}

// Returns the roots of the default scene. A file without one has its first scene; a file without scenes has all nodes
// that are nobody's child.
std::optional<std::vector<int>> GltfReader::roots() {
  if (!model_.scenes.empty()) {
    const int scene = std::max(model_.defaultScene, 0);
    if (static_cast<std::size_t>(scene) >= model_.scenes.size()) {
      fail("scene: there is no scene " + std::to_string(scene));
      return std::nullopt;
    }
    for (std::size_t i = 0; i < model_.scenes.size(); ++i) {
      if (static_cast<int>(i) == scene) continue;
      reading_.warn(0, "scenes/" + std::to_string(i) + " is not read: a world has one scene, which is scenes/" +
                           std::to_string(scene));
    }
    return model_.scenes[static_cast<std::size_t>(scene)].nodes;
  }
  std::vector<bool> is_child(model_.nodes.size(), false);
  for (const tinygltf::Node& node : model_.nodes) {
    for (const int child : node.children) {
      if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
        is_child[static_cast<std::size_t>(child)] = true;
    }
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

bool GltfReader::set_placement(const tinygltf::Node& node, const std::string& path, NodeDraft& draft) {
  const auto is = [&](const std::vector<double>& values, std::size_t count) {
    return values.size() == count &&
           std::ranges::all_of(values, [](double v) { return std::isfinite(static_cast<float>(v)); });
  };
  TransformValues values;
  if (!node.matrix.empty()) {
    if (!is(node.matrix, 16)) return fail(path + "its matrix must be sixteen numbers that binary32 can hold");
    const auto& m = node.matrix;
    if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0) {
      return fail(path + "the last row of its matrix must be 0 0 0 1");
    }
    if (!node.translation.empty() || !node.rotation.empty() || !node.scale.empty()) {
      return fail(path + "it has a matrix, and a translation, rotation or scale besides");
    }
    values = transform_of(std::span<const double, 16>(m.data(), 16));
  }
  const auto take = [&](const std::vector<double>& from, std::array<float, 3>& to) {
    std::ranges::transform(from, to.begin(), [](double v) { return static_cast<float>(v); });
  };
  if (!node.translation.empty()) {
    if (!is(node.translation, 3)) return fail(path + "its translation must be three numbers that binary32 can hold");
    take(node.translation, values.translation);
  }
  if (!node.scale.empty()) {
    if (!is(node.scale, 3)) return fail(path + "its scale must be three numbers that binary32 can hold");
    take(node.scale, values.scale);
  }
  if (!node.rotation.empty()) {
    if (!is(node.rotation, 4)) return fail(path + "its rotation must be four numbers that binary32 can hold");
    values.rotation = axis_angle(std::span<const double, 4>(node.rotation.data(), 4));
  }
  const TransformValues none;
  if (values.translation != none.translation) draft.floats("translation", values.translation);
  if (values.rotation[3] != 0.0F) draft.floats("rotation", values.rotation);
  if (values.scale != none.scale) draft.floats("scale", values.scale);
  const bool scales_alike = values.scale[0] == values.scale[1] && values.scale[1] == values.scale[2];
  if (values.scale_orientation[3] != 0.0F && !scales_alike) draft.floats("scaleOrientation", values.scale_orientation);
  return true;
}

void GltfReader::add_camera(const tinygltf::Node& node, const std::string& path, std::vector<NodeRef>& children) {
  if (node.camera < 0) return;
  if (static_cast<std::size_t>(node.camera) >= model_.cameras.size()) {
    return reading_.warn(0, path + "there is no camera " + std::to_string(node.camera));
  }
  const tinygltf::Camera& camera = model_.cameras[static_cast<std::size_t>(node.camera)];
  if (camera.type != "perspective") {
    return reading_.warn(0, path + "its camera is no Viewpoint: only perspective ones are");
  }
  if (!(camera.perspective.yfov > 0.0 && camera.perspective.yfov < std::numbers::pi)) {
    return reading_.warn(0, path + "its camera is no Viewpoint: its yfov must be between 0 and pi");
  }
  reading_.lose("of its perspective only yfov is kept: a Viewpoint has no aspectRatio, znear and zfar",
                "cameras/" + std::to_string(node.camera));
  const std::string& name = camera.name.empty() ? node.name : camera.name;
  children.push_back(NodeDraft(reading_.document, "Viewpoint", reading_.at(0))
                         .floats("position", {0, 0, 0})
                         .floats("fieldOfView", {static_cast<float>(camera.perspective.yfov)})
                         .string("description", name)
                         .add());
}

// A DirectionalLight of VRML97 lights only its siblings and their children, and one of glTF lights everything. So it is
// put at the top level, with the direction that it has at the start.
bool GltfReader::add_light(const tinygltf::Node& node, const std::string& path, const Mat3& world,
                           std::vector<NodeRef>& children) {
  const auto it = node.extensions.find("KHR_lights_punctual");
  if (it == node.extensions.end()) return true;
  const tinygltf::Value& index = it->second.Get("light");
  if (!index.IsInt() || index.GetNumberAsInt() < 0 ||
      static_cast<std::size_t>(index.GetNumberAsInt()) >= model_.lights.size()) {
    return fail(path + "there is no such light");
  }
  const tinygltf::Light& light = model_.lights[static_cast<std::size_t>(index.GetNumberAsInt())];
  const bool directional = light.type == "directional", spot = light.type == "spot";
  if (!directional && !spot && light.type != "point") return fail(path + "its light is of no type that glTF has");
  NodeDraft draft(reading_.document,
                  directional ? "DirectionalLight"
                  : spot      ? "SpotLight"
                              : "PointLight",
                  reading_.at(0));
  if (!(light.intensity >= 0.0)) return fail(path + "the intensity of its light is negative");
  const auto& cone = light.spot;
  if (spot && !(cone.innerConeAngle >= 0.0 && cone.innerConeAngle <= cone.outerConeAngle)) {
    return fail(path + "the cone of its light must have 0 <= innerConeAngle <= outerConeAngle");
  }
  // Half of pi may have been rounded up to binary32.
  if (spot && cone.outerConeAngle > std::numbers::pi / 2.0 + 1e-6) {
    reading_.lose("the cone of its light is wider than half of pi, and is clamped", path.substr(0, path.size() - 2));
  }
  if (!directional && !(light.range >= 0.0 && std::isfinite(static_cast<float>(light.range)))) {
    return fail(path + "the range of its light must be a number from 0 on that binary32 can hold");
  }
  if (light.color.size() == 3) {
    if (std::ranges::any_of(light.color, [](double share) { return !(share >= 0.0 && share <= 1.0); })) {
      reading_.lose("the colour of its light is outside of 0 to 1, and is clamped", path.substr(0, path.size() - 2));
    }
    draft.floats("color", {screen_share(light.color[0]), screen_share(light.color[1]), screen_share(light.color[2])});
  }
  draft.floats("intensity", {full_share(light.intensity)});
  if (!directional) {
    // Light falls off by the square of the distance [m], up to the range, without which it has no end.
    draft.floats("attenuation", {0, 0, 1});
    draft.floats("radius", {light.range > 0.0 ? static_cast<float>(light.range) : 1e6F});
  }
  if (spot) {
    draft.floats("cutOffAngle", {static_cast<float>(std::min(cone.outerConeAngle, std::numbers::pi / 2.0))});
    // A beamWidth is more than 0, and an innerConeAngle usually is 0.
    draft.floats("beamWidth", {std::max(static_cast<float>(cone.innerConeAngle), 1e-3F)});
  }
  if (light.intensity > std::numbers::pi) {
    reading_.warn(0, path + "its light is brighter than one of a world, and is shown as the brightest");
  }
  if (directional) {
    // Written out, as all sums are that peers must get the same bits of.
    const Vec3 back = world.col(2);
    const double length = std::sqrt(back.x() * back.x() + back.y() * back.y() + back.z() * back.z());
    if (!(length > 0.0 && std::isfinite(length))) {
      reading_.lose("its directional light has no direction: a node around it is scaled to nothing, or beyond numbers",
                    path.substr(0, path.size() - 2));
      return true;
    }
    const Vec3 to = -back / length;
    draft.floats("direction", {static_cast<float>(to.x()), static_cast<float>(to.y()), static_cast<float>(to.z())});
  }
  if (directional) sun_nodes_.push_back(static_cast<std::size_t>(&node - model_.nodes.data()));
  (directional ? suns_ : children).push_back(draft.add());
  return true;
}

// Names each directional light that an animation of its node, or of one above it, would turn.
void GltfReader::name_suns_that_would_turn() {
  std::vector<bool> turns(model_.nodes.size(), false);
  for (const tinygltf::Animation& animation : model_.animations) {
    for (const tinygltf::AnimationChannel& channel : animation.channels) {
      const bool is_there = channel.target_node >= 0 && static_cast<std::size_t>(channel.target_node) < turns.size();
      if (is_there && channel.target_path != "translation") turns[static_cast<std::size_t>(channel.target_node)] = true;
    }
  }
  for (const std::size_t sun : sun_nodes_) {
    std::optional<std::size_t> node = sun;
    while (node && !turns[*node]) node = parents_[*node];
    if (!node) continue;
    reading_.lose("its directional light stays as it is at first, although an animation turns it",
                  "nodes/" + std::to_string(sun));
  }
}

void GltfReader::name_what_is_not_kept(const tinygltf::Node& node, const std::string& path) {
  if (node.skin >= 0) reading_.warn(0, path + "its skin is not applied: the mesh keeps the form that its points have");
  for (const auto& [extension, value] : node.extensions) {
    if (extension != "KHR_lights_punctual") reading_.warn(0, path + vrml::quoted(extension) + " is not read");
  }
}

bool GltfReader::add_node(int index, std::size_t depth, const Mat3& above, std::vector<NodeRef>& siblings) {
  const std::string path = "nodes/" + std::to_string(index) + ": ";
  if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size()) return fail(path + "there is none");
  const auto place = static_cast<std::size_t>(index);
  const tinygltf::Node& node = model_.nodes[place];
  // A node has one parent, so that the nodes make no circle.
  if (visited_[place]) return fail(path + "it has more than one parent");
  if (depth + 2 > vrml::kMaxNesting) {
    return fail(path + "nodes are nested more than " + std::to_string(vrml::kMaxNesting - 2) + " deep");
  }
  visited_[place] = true;
  std::vector<NodeRef> children;
  if (node.mesh >= 0 && !primitives_.add_mesh(node.mesh, children)) return false;
  add_camera(node, path, children);
  const Mat3 world = linear_below(above, node);
  if (!add_light(node, path, world, children)) return false;
  name_what_is_not_kept(node, path);
  for (const int child : node.children) {
    if (child >= 0 && static_cast<std::size_t>(child) < parents_.size())
      parents_[static_cast<std::size_t>(child)] = place;
    if (!add_node(child, depth + 1, world, children)) return false;
  }
  NodeDraft draft(reading_.document, "Transform", reading_.at(0));
  draft.named(node.name);
  if (!set_placement(node, path, draft)) return false;
  transforms_[place] = draft.nodes("children", children).add();
  siblings.push_back(transforms_[place]);
  return reading_.has_room() || fail(path + std::string(kTooManyNodes));
}

bool GltfReader::read() {
  if (!check_extensions()) return false;
  const auto top = roots();
  if (!top) return false;
  std::vector<NodeRef> children;
  for (const int root : *top) {
    if (!add_node(root, 0, Mat3::Identity(), children)) return false;
  }
  children.insert(children.end(), suns_.begin(), suns_.end());
  vrml::Document& document = reading_.document;
  const Conversion& conversion = reading_.options.conversion;
  if (conversion != Conversion{}) {
    NodeDraft around(document, "Transform", reading_.at(0));
    const auto scale = static_cast<float>(conversion.metres_per_unit);
    around.floats("scale", {scale, scale, scale});
    if (conversion.z_up) around.floats("rotation", {1, 0, 0, -static_cast<float>(std::numbers::pi / 2.0)});
    children = {around.nodes("children", children).add()};
  }
  document.top_level = children;
  if (!add_animations(model_, accessors_, transforms_, reading_)) return false;
  name_suns_that_would_turn();
  // The times of animations count from the world's beginning.
  if (!document.routes.empty()) {
    document.top_level.push_back(NodeDraft(document, "WorldInfo", reading_.at(0)).flag("worldTimes", true).add());
  }
  return true;
}

// The library's messages have several lines, and may repeat what the file says at any length.
std::string sentence_of(const std::string& message) {
  const std::string line = message.substr(0, std::min<std::size_t>(message.find('\n'), 200));
  return line.empty() ? "it is no glTF" : line;
}

bool no_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return false;
}
bool no_file(const std::string&, void*) { return false; }
bool no_bytes(std::vector<unsigned char>*, std::string* why, const std::string&, void*) {
  *why = "no file is read here";
  return false;
}
std::string same_path(const std::string& path, void*) { return path; }
bool no_writing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }

bool read_checked(std::string_view json, std::string_view binary, Reading& reading) {
  const auto checked =
      checked_json(json, reading.options.limits.expansion * (kBaseMemory + kMemoryOfByte * json.size()));
  if (!checked) return reading.fail(0, checked.error());
  tinygltf::Model model;
  std::string errors, warnings;
  // The library gets neither buffers nor images, and reads no file: all of those are read here, within limits.
  tinygltf::TinyGLTF library;
  library.SetImageLoader(no_image, nullptr);
  library.SetFsCallbacks({no_file, same_path, no_bytes, no_writing, nullptr});
  try {
    if (!library.LoadASCIIFromString(&model, &errors, &warnings, checked->text.data(),
                                     static_cast<unsigned int>(checked->text.size()), "")) {
      return reading.fail(0, sentence_of(errors));
    }
  } catch (const std::exception& error) {
    return reading.fail(0, sentence_of(error.what()));
  }
  // It may find errors and yet call the file good.
  if (!errors.empty()) return reading.fail(0, sentence_of(errors));
  if (!warnings.empty()) reading.warn(0, sentence_of(warnings));
  if (!model.asset.version.starts_with("2."))
    return reading.fail(0, "it is of glTF " + vrml::quoted(model.asset.version) + "; 2.0 is read");
  if (checked->extras > 0) {
    reading.warn(0, "its extras are not kept: " + std::to_string(checked->extras) +
                        " of its parts have data that only another program knows");
  }
  Buffers buffers;
  std::vector<ImageSource> images;
  return buffers.read(checked->buffers, binary, reading) && read_images(checked->images, reading, images) &&
         GltfReader(model, buffers, images, reading).read();
}

}  // namespace

bool read_gltf(std::string_view json, Reading& reading) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (json.starts_with(kByteOrderMark)) json.remove_prefix(kByteOrderMark.size());
  return read_checked(json, {}, reading);
}

bool read_glb(std::string_view bytes, Reading& reading) {
  const auto chunks = chunks_of(bytes);
  if (!chunks) return reading.fail(0, chunks.error());
  if (chunks->surplus_bytes > 0) {
    reading.warn(0, "the last " + std::to_string(chunks->surplus_bytes) +
                        " bytes of the file are not read: by its header it ends before them");
  }
  return read_checked(chunks->json, chunks->binary, reading);
}

}  // namespace peerd::formats::gltf
