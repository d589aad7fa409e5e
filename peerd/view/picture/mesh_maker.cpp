#include "peerd/view/picture/mesh_maker.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <string>
#include <variant>

#include "peerd/view/picture/drawn_geometry.hpp"
#include "peerd/view/picture/node_fields.hpp"

namespace peerd::view {
namespace {

constexpr std::size_t kLines = 1000, kLine_bytes = 1000;  // of one Text; a viewer draws no more

template <class Value>
std::uint32_t number_of(std::map<Value, std::uint32_t>& known, const Value& value) {
  return known.try_emplace(value, static_cast<std::uint32_t>(known.size())).first->second;
}

template <class Value>
void place(const std::map<Value, std::uint32_t>& known, std::vector<Value>& out) {
  out.resize(known.size());
  for (const auto& [value, number] : known) out[number] = value;
}

DrawnText text_in(const vrml::Document& document, const vrml::Node& node) {
  const auto strings = [](const vrml::Node& from, std::string_view field) {
    const auto all = values<std::string_view>(from, field);
    return std::vector<std::string>(all.begin(), all.end());
  };
  DrawnText text;
  text.lines = strings(node, "string");
  if (text.lines.size() > kLines) text.lines.resize(kLines);
  for (std::string& line : text.lines) line.resize(std::min(line.size(), kLine_bytes));
  const auto lengths = values<float>(node, "length");
  text.lengths_m.assign(lengths.begin(),
                        lengths.begin() + static_cast<std::ptrdiff_t>(std::min(lengths.size(), kLines)));
  text.max_extent_m = value<float>(node, "maxExtent");
  const vrml::Node* const font = node_in(document, node, "fontStyle", "FontStyle");
  if (font == nullptr) {
    text.families = {"SERIF"};
    text.justify = {"BEGIN"};
    text.style = "PLAIN";
    return text;
  }
  text.families = strings(*font, "family");
  text.justify = strings(*font, "justify");
  text.style = value<std::string_view>(*font, "style");
  text.size_m = value<float>(*font, "size");
  text.spacing = value<float>(*font, "spacing");
  text.horizontal = value<bool>(*font, "horizontal");
  text.left_to_right = value<bool>(*font, "leftToRight");
  text.top_to_bottom = value<bool>(*font, "topToBottom");
  return text;
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
  GeometryAsDrawn drawn = draw({document_, node, scene_.geometries[scene_.at(shape).geometry], scene_.tessellation,
                                texture, forms_.of_geometry(scene_.at(shape).geometry)});
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
  Paint paint = paint_of(document_, shape_node, is_surface, colored, images_, &looks_);
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

std::optional<std::uint32_t> MeshMaker::text_of(ObjectId shape) {
  const Instance& instance = scene_.at(shape);
  const auto* const form =
      instance.geometry == Instance::kNone ? nullptr : std::get_if<NoSurface>(&scene_.geometries[instance.geometry]);
  if (form == nullptr || form->type != "Text") return std::nullopt;
  const auto [known, is_new] = text_of_node_.try_emplace(instance.node);
  if (!is_new) return known->second;
  const vrml::Node& shape_node = document_.nodes[instance.node];
  const vrml::Node* const node = node_in(document_, shape_node, "geometry", "Text");
  if (node == nullptr) return std::nullopt;
  Paint paint = paint_of(document_, shape_node, true, false, images_, &looks_);
  for (const std::string& why : paint.left_out) {
    undrawn_.add([&] { return scene_.path_of(shape); }, "texture", why);
  }
  if (paint.material.texture) {
    undrawn_.add([&] { return scene_.path_of(shape); }, "Text", "its texture");
    paint.material.texture.reset();
  }
  DrawnText text = text_in(document_, *node);
  if (std::ranges::all_of(text.lines, &std::string::empty)) return std::nullopt;
  text.material = paint.material;
  known->second = static_cast<std::uint32_t>(texts_.size());
  texts_.push_back(std::move(text));
  return known->second;
}

void MeshMaker::finish(ScenePicture& picture) {
  place(known_meshes_, picture.meshes);
  place(known_materials_, picture.materials);
  picture.geometries = std::move(geometries_);
  picture.images = images_.take();
  picture.texts = std::move(texts_);
}

}  // namespace peerd::view
