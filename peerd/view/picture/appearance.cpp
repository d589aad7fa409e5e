#include "peerd/view/picture/appearance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "peerd/view/picture/image_kind.hpp"
#include "peerd/view/picture/node_fields.hpp"

namespace peerd::view {
namespace {

Color color_of(const vrml::Node& node, std::string_view field) {
  const auto c = values<float>(node, field);
  return {std::clamp(c[0], 0.0F, 1.0F), std::clamp(c[1], 0.0F, 1.0F), std::clamp(c[2], 0.0F, 1.0F)};
}

float part_of(const vrml::Node& node, std::string_view field) {
  return std::clamp(value<float>(node, field), 0.0F, 1.0F);
}

void drive(const vrml::Document& document, const vrml::Node& material, bool is_surface, const view::DrivenLooks& looks,
           DrawnMaterial& out) {
  const auto node = static_cast<std::uint32_t>(&material - document.nodes.data());
  out.driven.color = looks.find(node, is_surface ? "diffuseColor" : "emissiveColor");
  if (is_surface) out.driven.emissive = looks.find(node, "emissiveColor");
  out.driven.transparency = looks.find(node, "transparency");
}

// Tc' = -C S R C T Tc.
TextureMap map_of(const vrml::Node& transform) {
  const auto pair = [&](std::string_view field) {
    const auto v = values<float>(transform, field);
    return Eigen::Vector2f(v[0], v[1]);
  };
  const Eigen::Vector2f center = pair("center"), scale = pair("scale"), translation = pair("translation");
  TextureMap map;
  map.linear = scale.asDiagonal() * Eigen::Rotation2Df(value<float>(transform, "rotation")).toRotationMatrix();
  map.offset = map.linear * (center + translation) - center;
  return map;
}

// A texture's colours take the place of the diffuse colour, and its transparency that of the
// Material.
void add_texture(const vrml::Document& document, const vrml::Node& appearance, Images& images, Paint& paint) {
  const vrml::Node* const texture = node_in(document, appearance, "texture");
  if (texture == nullptr) return;
  const bool has_pixels = texture->type->name == "PixelTexture";
  if ((texture->type->name != "ImageTexture" && !has_pixels) || texture->damaged) {
    paint.left_out.emplace_back(texture->type->name);
    return;
  }
  const auto image = has_pixels ? images.find_pixels(values<std::int32_t>(*texture, "image"))
                                : images.find(values<std::string_view>(*texture, "url"));
  if (!image) {
    paint.left_out.push_back(std::string(texture->type->name) + ": " + image.error());
    return;
  }
  paint.material.texture = DrawnTexture{*image, value<bool>(*texture, "repeatS"), value<bool>(*texture, "repeatT")};
  const DrawnImage& drawn = images.at(*image);
  if (drawn.has_color || !paint.material.lit) paint.material.diffuse = {1, 1, 1};
  if (drawn.has_alpha) paint.material.transparency = 0;
  const vrml::Node* const transform = node_in(document, appearance, "textureTransform", "TextureTransform");
  paint.texture = transform == nullptr ? TextureMap{} : map_of(*transform);
}

}  // namespace

std::expected<std::uint32_t, std::string> Images::find(std::span<const std::string_view> urls) {
  std::string why = "it has no url";
  for (const std::string_view url : urls) {
    auto known = known_.find(url);
    if (known == known_.end()) known = known_.emplace(std::string(url), read(url)).first;
    if (known->second) return known->second;
    why = "\"" + std::string(url.substr(0, 100)) + "\": " + known->second.error();
  }
  return std::unexpected(why);
}

std::expected<std::uint32_t, std::string> Images::find_pixels(std::span<const std::int32_t> image) {
  auto known = known_pixels_.find(image.data());
  if (known == known_pixels_.end()) {
    auto png = png_of_pixels(image);
    known = known_pixels_.emplace(image.data(), png ? keep(*std::move(png)) : std::unexpected(std::move(png).error()))
                .first;
  }
  return known->second;
}

std::expected<std::uint32_t, std::string> Images::read(std::string_view url) {
  if (!load_) return std::unexpected("it is not looked for");
  auto bytes = load_(url);
  if (!bytes) return std::unexpected(bytes.error());
  return keep(*std::move(bytes));
}

std::expected<std::uint32_t, std::string> Images::keep(std::string bytes) {
  if (bytes.size() > kImage_bytes) return std::unexpected("it is larger than 16 MiB");
  if (bytes.size() > kAll_bytes - bytes_) return std::unexpected("with it all images are larger than 64 MiB");
  auto image = image_of(std::move(bytes));
  if (!image) return std::unexpected(image.error());
  bytes_ += image->bytes.size();
  all_.push_back(*std::move(image));
  return static_cast<std::uint32_t>(all_.size() - 1);
}

Paint paint_of(const vrml::Document& document, const vrml::Node& shape, bool is_surface, bool colored, Images& images,
               const view::DrivenLooks* looks) {
  Paint paint;
  DrawnMaterial& out = paint.material;
  const vrml::Node* const appearance = node_in(document, shape, "appearance", "Appearance");
  const vrml::Node* const material =
      appearance == nullptr ? nullptr : node_in(document, *appearance, "material", "Material");
  out.lit = is_surface && material != nullptr;
  if (material == nullptr) {
    out.diffuse = {1, 1, 1};
  } else {
    out.diffuse = color_of(*material, is_surface ? "diffuseColor" : "emissiveColor");
    out.transparency = part_of(*material, "transparency");
    if (is_surface) {
      out.emissive = color_of(*material, "emissiveColor");
      out.shininess = part_of(*material, "shininess");
    }
  }
  if (appearance != nullptr && is_surface) add_texture(document, *appearance, images, paint);
  if (material != nullptr && looks != nullptr) drive(document, *material, is_surface, *looks, out);
  if (colored || (out.texture && images.at(out.texture->image).has_color)) out.driven.color.reset();
  if (out.texture && images.at(out.texture->image).has_alpha) out.driven.transparency.reset();
  if (colored) out.diffuse = {1, 1, 1};
  return paint;
}

}  // namespace peerd::view
