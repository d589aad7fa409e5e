#include "core/formats/gltf/primitives.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "core/formats/draft/node_draft.hpp"

namespace peerd::formats::gltf {
namespace {

using vrml::NodeRef;

// How an attribute is kept: the node and its field, and the numbers of one value.
struct Use {
  const char* attribute;
  const char* node;
  const char* field;
  std::size_t width;  // 0: three or four
};
constexpr std::array<Use, 4> kUses{{{"POSITION", "Coordinate", "point", 3},
                                    {"NORMAL", "Normal", "vector", 3},
                                    {"TEXCOORD_0", "TextureCoordinate", "point", 2},
                                    {"COLOR_0", "Color", "color", 0}}};

int attribute_of(const tinygltf::Primitive& primitive, const char* name) {
  const auto it = primitive.attributes.find(name);
  return it == primitive.attributes.end() ? -1 : it->second;
}

bool is_surface(int mode) { return mode >= TINYGLTF_MODE_TRIANGLES && mode <= TINYGLTF_MODE_TRIANGLE_FAN; }

// The polygons or lines of indices in a mode (glTF 2.0, 3.7.2.1), each with a -1 behind it.
std::vector<std::int32_t> list_of(int mode, const std::vector<std::uint32_t>& corners) {
  std::vector<std::int32_t> list;
  const auto add = [&](std::initializer_list<std::uint32_t> indices) {
    for (const std::uint32_t index : indices) list.push_back(static_cast<std::int32_t>(index));
    list.push_back(-1);
  };
  const std::size_t n = corners.size();
  switch (mode) {
    case TINYGLTF_MODE_LINE:
      for (std::size_t i = 0; i + 1 < n; i += 2) add({corners[i], corners[i + 1]});
      break;
    case TINYGLTF_MODE_LINE_LOOP:
    case TINYGLTF_MODE_LINE_STRIP:
      list.assign(corners.begin(), corners.end());
      if (mode == TINYGLTF_MODE_LINE_LOOP) list.push_back(static_cast<std::int32_t>(corners.front()));
      list.push_back(-1);
      break;
    case TINYGLTF_MODE_TRIANGLES:
      list.resize(n / 3 * 4);
      for (std::size_t i = 0; i < n / 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) list[4 * i + k] = static_cast<std::int32_t>(corners[3 * i + k]);
        list[4 * i + 3] = -1;
      }
      break;
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      for (std::size_t i = 0; i + 2 < n; ++i) add({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
      break;
    default:
      for (std::size_t i = 0; i + 2 < n; ++i) add({corners[i + 1], corners[i + 2], corners[0]});
  }
  return list;
}

}  // namespace

std::expected<NodeRef, std::string> Primitives::attribute(const tinygltf::Primitive& primitive, const char* name,
                                                          std::uint64_t points) {
  const int accessor = attribute_of(primitive, name);
  if (accessor < 0) return NodeRef{};
  if (accessors_.count(accessor) != points) {
    return std::unexpected("accessors/" + std::to_string(accessor) + ": it must have a value for each of the " +
                           std::to_string(points) + " points");
  }
  const auto [it, is_new] = attributes_.try_emplace({accessor, name});
  if (!is_new) return it->second;
  const Use& use = *std::ranges::find(kUses, std::string_view(name), &Use::attribute);
  auto values = accessors_.floats(accessor, use.width);
  if (!values) return std::unexpected(values.error());
  if (use.width == 2) {
    for (std::size_t i = 1; i < values->size(); i += 2) (*values)[i] = 1.0F - (*values)[i];  // VRML97's t points up
  }
  if (use.width == 0) {
    const std::size_t width = accessors_.width(accessor);
    bool is_beyond = false;
    std::vector<float> colors;
    colors.reserve(3 * points);
    for (std::size_t i = 0; i < points; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double light{(*values)[i * width + k]};
        is_beyond = is_beyond || light < 0.0 || light > 1.0;
        colors.push_back(screen_share(light));
      }
    }
    if (is_beyond) {
      reading_.lose("colours of COLOR_0 outside of 0 to 1 are clamped", "accessors/" + std::to_string(accessor));
    }
    *values = std::move(colors);
  }
  it->second = NodeDraft(reading_.document, use.node, reading_.at(0)).floats(use.field, std::move(*values)).add();
  return it->second;
}

std::expected<std::vector<std::uint32_t>, std::string> Primitives::corners_of(const tinygltf::Primitive& primitive,
                                                                              std::uint64_t points) {
  if (primitive.indices >= 0) return accessors_.indices(primitive.indices, points);
  std::vector<std::uint32_t> corners(points);
  std::iota(corners.begin(), corners.end(), 0U);
  return corners;
}

bool Primitives::add_geometry(const tinygltf::Primitive& primitive, const std::string& path, std::uint64_t points,
                              NodeRef& geometry) {
  const int mode = primitive.mode;
  if (!reading_.take(Asked::kCorners, primitive.indices >= 0 ? accessors_.count(primitive.indices) : points)) {
    return fail(path +
                "with this primitive there are more corners than a file of this size may ask for; the option "
                "expansion allows more");
  }
  const auto color = attribute(primitive, "COLOR_0", points);
  if (!color) return fail(path + color.error());
  const char* const type = is_surface(mode)               ? "IndexedFaceSet"
                           : mode == TINYGLTF_MODE_POINTS ? "PointSet"
                                                          : "IndexedLineSet";
  NodeDraft draft(reading_.document, type, reading_.at(0));
  draft.node("color", *color);
  if (is_surface(mode)) {
    const auto normal = attribute(primitive, "NORMAL", points);
    if (!normal) return fail(path + normal.error());
    const auto texture = materials_.has_texture(primitive.material) ? attribute(primitive, "TEXCOORD_0", points)
                                                                    : std::expected<NodeRef, std::string>(NodeRef{});
    if (!texture) return fail(path + texture.error());
    draft.node("normal", *normal).node("texCoord", *texture);
    if (materials_.is_double_sided(primitive.material)) draft.flag("solid", false);
  }
  const auto position = attribute(primitive, "POSITION", points);
  if (!position) return fail(path + position.error());
  draft.node("coord", *position);
  if (mode == TINYGLTF_MODE_POINTS) {
    if (primitive.indices >= 0) return add_indexed_points(primitive, path, points, geometry);
    geometry = draft.add();
    return true;
  }
  const auto [known, is_new] = indices_.try_emplace({primitive.indices, mode, points});
  if (is_new) {
    const auto corners = corners_of(primitive, points);
    if (!corners) return fail(path + corners.error());
    const std::size_t whole = mode == TINYGLTF_MODE_TRIANGLES ? 3 : mode == TINYGLTF_MODE_LINE ? 2 : 1;
    if (corners->size() % whole != 0) {
      reading_.warn(
          0, path + "the last " + std::to_string(corners->size() % whole) + " of its indices make no whole element");
    }
    auto list = list_of(mode, *corners);
    draft.integers("coordIndex", std::move(list));
    known->second = draft.last_integers();
  } else {
    draft.shared_integers("coordIndex", known->second);
  }
  geometry = draft.add();
  return true;
}

// A PointSet has no indices: the points that they name are written out.
bool Primitives::add_indexed_points(const tinygltf::Primitive& primitive, const std::string& path, std::uint64_t points,
                                    NodeRef& geometry) {
  const auto corners = corners_of(primitive, points);
  if (!corners) return fail(path + corners.error());
  NodeDraft draft(reading_.document, "PointSet", reading_.at(0));
  for (const auto& [name, field] : {std::pair{"POSITION", "coord"}, {"COLOR_0", "color"}}) {
    const auto all = attribute(primitive, name, points);
    if (!all) return fail(path + all.error());
    if (!all->is_node()) continue;
    const vrml::Field& values = reading_.document.nodes[all->index].given().front();
    std::vector<float> named;
    named.reserve(3 * corners->size());
    for (const std::uint32_t corner : *corners) {
      const auto one = values.as<float>().subspan(3 * std::size_t{corner}, 3);
      named.insert(named.end(), one.begin(), one.end());
    }
    const Use& use = *std::ranges::find(kUses, std::string_view(name), &Use::attribute);
    draft.node(field, NodeDraft(reading_.document, use.node, reading_.at(0)).floats(use.field, std::move(named)).add());
  }
  geometry = draft.add();
  return true;
}

void Primitives::name_what_is_not_kept(const tinygltf::Primitive& primitive, const std::string& path) {
  std::string what;
  const auto name = [&](const std::string& part) { what += (what.empty() ? "" : ", ") + part; };
  const bool surface = is_surface(primitive.mode), textured = materials_.has_texture(primitive.material);
  const std::string place = path.substr(0, path.size() - 2);  // without ": "
  for (const auto& [attribute, accessor] : primitive.attributes) {
    const bool known = std::ranges::find(kUses, attribute, &Use::attribute) != kUses.end();
    // Only images would need tangents and texture coordinates, and only surfaces have any of the three.
    const bool unseen = attribute == "TANGENT" || attribute.starts_with("TEXCOORD_") || attribute == "NORMAL";
    if (attribute == "TEXCOORD_0" && surface && !textured) {
      reading_.lose("TEXCOORD_0 is not kept: its material has no image of base colours", place);
    } else if (unseen && !(known && surface)) {
      reading_.lose(vrml::quoted(attribute) + " is not kept", place);
    } else if (!known) {
      name(attribute);
    }
  }
  const int color = attribute_of(primitive, "COLOR_0");
  if (color >= 0 && accessors_.width(color) == 4) name("the opacity of COLOR_0");
  if (color >= 0 && materials_.is_tinted(primitive.material)) name("the base colour, which COLOR_0 stands for");
  if (color >= 0 && surface && textured) name("COLOR_0 beside the image of its material");
  if (!primitive.targets.empty()) name(std::to_string(primitive.targets.size()) + " morph targets");
  for (const auto& [extension, value] : primitive.extensions) name(extension);
  if (!what.empty()) reading_.warn(0, path + "these are not kept: " + what);
}

bool Primitives::add_primitive(const tinygltf::Primitive& primitive, const std::string& path,
                               std::vector<NodeRef>& shapes) {
  if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    return fail(path + "its mode is none of glTF's");
  }
  if (!materials_.is_there(primitive.material)) return fail(path + "there is no such material");
  name_what_is_not_kept(primitive, path);
  const int position = attribute_of(primitive, "POSITION");
  if (position < 0) {
    reading_.warn(0, path + "it has no POSITION, and so no shape");
    return true;
  }
  const std::uint64_t points = accessors_.count(position);
  if (points == 0 || points > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max())) {
    return fail(path + "accessors/" + std::to_string(position) + ": there is no such accessor of points");
  }
  const bool textured = materials_.has_texture(primitive.material);
  const std::vector<int> key{primitive.mode,
                             primitive.indices,
                             position,
                             attribute_of(primitive, "NORMAL"),
                             attribute_of(primitive, "COLOR_0"),
                             textured ? attribute_of(primitive, "TEXCOORD_0") : -1,
                             materials_.is_double_sided(primitive.material) ? 1 : 0};
  const auto known = geometries_.find(key);
  NodeRef geometry = known != geometries_.end() ? known->second : NodeRef{};
  if (!geometry.is_node() && !add_geometry(primitive, path, points, geometry)) return false;
  geometries_[key] = geometry;
  const NodeRef appearance = materials_.appearance(primitive.material);
  shapes.push_back(NodeDraft(reading_.document, "Shape", reading_.at(0))
                       .node("appearance", appearance)
                       .node("geometry", geometry)
                       .add());
  return reading_.has_room() || fail(path + std::string(kTooManyNodes));
}

bool Primitives::add_mesh(int mesh, std::vector<NodeRef>& shapes) {
  if (mesh < 0 || static_cast<std::size_t>(mesh) >= model_.meshes.size()) {
    return fail("meshes/" + std::to_string(mesh) + ": there is none");
  }
  const auto [made, is_new] = meshes_.try_emplace(mesh);
  const tinygltf::Mesh& found = model_.meshes[static_cast<std::size_t>(mesh)];
  for (std::size_t i = 0; is_new && i < found.primitives.size(); ++i) {
    const std::string path = "meshes/" + std::to_string(mesh) + "/primitives/" + std::to_string(i) + ": ";
    if (!add_primitive(found.primitives[i], path, made->second)) return false;
  }
  if (!reading_.take(Asked::kReferences, made->second.size())) {
    return fail(
        "meshes/" + std::to_string(mesh) +
        ": with this use of it the nodes use more primitives together than a file of this size may ask for; the option "
        "expansion allows more");
  }
  shapes.insert(shapes.end(), made->second.begin(), made->second.end());
  return true;
}

}  // namespace peerd::formats::gltf
