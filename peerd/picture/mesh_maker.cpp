#include "peerd/picture/mesh_maker.hpp"

#include <bit>
#include <string>
#include <variant>

#include "peerd/picture/drawn_geometry.hpp"
#include "peerd/picture/node_fields.hpp"

namespace peerd::picture {
namespace {

template <class Value>
std::uint32_t number_of(std::map<Value, std::uint32_t>& known, const Value& value) {
  return known.try_emplace(value, static_cast<std::uint32_t>(known.size())).first->second;
}

template <class Value>
void place(const std::map<Value, std::uint32_t>& known, std::vector<Value>& out) {
  out.resize(known.size());
  for (const auto& [value, number] : known) out[number] = value;
}

}  // namespace

void MeshMaker::add_content(const vrml::Node& node, Content& content) const {
  content.push_back(std::bit_cast<std::uint64_t>(node.type));
  for (const vrml::Field& field : node.given()) {
    content.push_back(std::bit_cast<std::uint64_t>(field.spec));
    if (!vrml::holds_nodes(field.spec->type)) {
      content.push_back(std::bit_cast<std::uint64_t>(field.data));
      continue;
    }
    for (const vrml::NodeRef ref : field.as<vrml::NodeRef>()) {
      if (ref.is_node()) add_content(document_.nodes[ref.index], content);
    }
  }
}

MeshMaker::GeometryKey MeshMaker::key_of(ObjectId shape, const vrml::Node& node) const {
  const std::uint32_t form = scene_.at(shape).geometry;
  const Geometry& geometry = scene_.geometries[form];
  GeometryKey key{{geometry.index()}, Instance::kNone};
  const auto add = [&](auto... numbers) {
    (key.content.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(numbers))), ...);
  };
  if (const auto* const box = std::get_if<BoxGeometry>(&geometry)) {
    add(box->size[0], box->size[1], box->size[2]);
  } else if (const auto* const sphere = std::get_if<SphereGeometry>(&geometry)) {
    add(sphere->radius);
  } else if (const auto* const cone = std::get_if<ConeGeometry>(&geometry)) {
    add(cone->bottom_radius, cone->height, cone->side, cone->bottom);
  } else if (const auto* const cylinder = std::get_if<CylinderGeometry>(&geometry)) {
    add(cylinder->radius, cylinder->height, cylinder->side, cylinder->top, cylinder->bottom);
  } else {
    key.form = form;
    add_content(node, key.content);
  }
  return key;
}

std::optional<std::uint32_t> MeshMaker::geometry_of(ObjectId shape, const vrml::Node& node,
                                                    const std::optional<TextureMap>& texture) {
  GeometryKey key = key_of(shape, node);
  if (texture) {
    key.texture = {texture->linear(0, 0), texture->linear(0, 1), texture->linear(1, 0),
                   texture->linear(1, 1), texture->offset[0],    texture->offset[1]};
  }
  const auto [known, is_new] = known_geometries_.try_emplace(std::move(key));
  if (!is_new) return known->second;
  GeometryAsDrawn drawn =
      draw({document_, node, scene_.geometries[scene_.at(shape).geometry], scene_.tessellation, texture});
  for (const std::string& why : drawn.left_out) {
    undrawn_.add([&] { return scene_.path_of(shape); }, std::string(node.type->name), why);
  }
  if (drawn.geometry.corners.empty()) return std::nullopt;
  known->second = static_cast<std::uint32_t>(geometries_.size());
  geometries_.push_back(std::move(drawn.geometry));
  return known->second;
}

std::optional<std::uint32_t> MeshMaker::make(ObjectId shape) {
  const Instance& instance = scene_.at(shape);
  const vrml::Node& shape_node = document_.nodes[instance.node];
  const vrml::Node* const geometry = node_in(document_, shape_node, "geometry");
  if (geometry == nullptr || instance.geometry == Instance::kNone) return std::nullopt;
  const bool is_surface = !std::holds_alternative<NoSurface>(scene_.geometries[instance.geometry]);
  const bool colored = node_in(document_, *geometry, "color", "Color") != nullptr;
  Paint paint = paint_of(document_, shape_node, is_surface, colored, images_);
  const bool has_solid = vrml::find_field(*geometry->type, "solid") != nullptr;
  paint.material.double_sided = has_solid && !value<bool>(*geometry, "solid");
  const auto drawn = geometry_of(shape, *geometry, paint.texture);
  if (!drawn) return std::nullopt;
  for (const std::string& why : paint.left_out) {
    undrawn_.add([&] { return scene_.path_of(shape); }, "texture", why);
  }
  return number_of(known_meshes_, {*drawn, number_of(known_materials_, paint.material)});
}

std::optional<std::uint32_t> MeshMaker::mesh_of(ObjectId shape) {
  const Instance& instance = scene_.at(shape);
  const auto [known, is_new] = of_node_.try_emplace({instance.node, instance.geometry});
  if (is_new) known->second = make(shape);
  return known->second;
}

void MeshMaker::finish(ScenePicture& picture) {
  place(known_meshes_, picture.meshes);
  place(known_materials_, picture.materials);
  picture.geometries = std::move(geometries_);
  picture.images = images_.take();
}

}  // namespace peerd::picture
