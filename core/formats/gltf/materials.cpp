#include "core/formats/gltf/materials.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/formats/draft/base64.hpp"

namespace peerd::formats::gltf {
namespace {

// Returns x to the power of 5/12, for x from 0.003 to 1, by operations that IEEE 754 defines to the last bit: peers
// must get the same colours, whatever their library.
double to_five_twelfths(double x) {
  const double fourth = std::sqrt(std::sqrt(x));
  double twelfth = 1.0;  // Newton's steps towards the cube root of `fourth`, which is above 0.2; six are enough
  for (int i = 0; i < 8; ++i) twelfth -= (twelfth * twelfth * twelfth - fourth) / (3.0 * twelfth * twelfth);
  const double square = twelfth * twelfth;
  return square * square * twelfth;
}

std::array<float, 3> screen_color(std::span<const double> light) {
  return {screen_share(light[0]), screen_share(light[1]), screen_share(light[2])};
}

}  // namespace

float screen_share(double light) {
  const double share = std::clamp(light, 0.0, 1.0);
  return static_cast<float>(share <= 0.0031308 ? 12.92 * share : 1.055 * to_five_twelfths(share) - 0.055);
}

std::size_t Materials::material_count() const { return model_.materials.size(); }

bool Materials::is_double_sided(int material) const {
  return material >= 0 && model_.materials[static_cast<std::size_t>(material)].doubleSided;
}

bool Materials::is_tinted(int material) const {
  if (material < 0) return false;
  const auto& factor = model_.materials[static_cast<std::size_t>(material)].pbrMetallicRoughness.baseColorFactor;
  return std::ranges::any_of(std::span(factor).first(3), [](double share) { return share != 1.0; });
}

bool Materials::has_texture(int material) const {
  return material >= 0 &&
         model_.materials[static_cast<std::size_t>(material)].pbrMetallicRoughness.baseColorTexture.index >= 0;
}

// Returns an image as a data: URL, so that it goes wherever the scene goes; the error says why it is not shown.
std::expected<std::string, std::string> Materials::url_of(const ImageSource& image) {
  if (image.buffer_view < 0 && !image.uri.starts_with("data:")) {
    auto loaded = reading_.load_image(image.uri);
    if (!loaded) return std::unexpected(vrml::quoted(image.uri) + ": " + loaded.error());
    return loaded;
  }
  const auto view = image.buffer_view < 0 ? std::nullopt : bytes_of_view(model_, buffers_, image.buffer_view);
  if (image.buffer_view >= 0 && !view) {
    return std::unexpected("the bufferView of its image is none, or reaches beyond its buffer");
  }
  if (!reading_.take(Asked::kValues, view ? view->size() / 3 : image.uri.size() / 4)) {
    return std::unexpected(std::string(kTooManyValues));
  }
  return view ? image_url(*view) : image.uri;
}

// Returns the node that shows the image of a texture; none where there is none, which is reported.
vrml::NodeRef Materials::image_of(int texture) {
  const std::string where = "textures/" + std::to_string(texture) + ": ";
  const auto none = [&](const std::string& why) {
    reading_.warn(0, where + why + "; it is not shown");
    return vrml::NodeRef{};
  };
  if (texture < 0 || static_cast<std::size_t>(texture) >= model_.textures.size()) return none("there is none");
  const tinygltf::Texture& found = model_.textures[static_cast<std::size_t>(texture)];
  if (found.source < 0 || static_cast<std::size_t>(found.source) >= images_.size()) return none("it has no image");
  bool repeat_s = true, repeat_t = true;
  if (found.sampler >= 0 && static_cast<std::size_t>(found.sampler) < model_.samplers.size()) {
    const tinygltf::Sampler& sampler = model_.samplers[static_cast<std::size_t>(found.sampler)];
    const auto is_usual = [](int filter) {
      return filter == -1 || filter == TINYGLTF_TEXTURE_FILTER_LINEAR ||
             filter == TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    };
    if (!is_usual(sampler.magFilter) || !is_usual(sampler.minFilter)) {
      reading_.lose("the filters of its sampler are not kept: images are shown as smooth",
                    "textures/" + std::to_string(texture));
    }
    repeat_s = sampler.wrapS != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    repeat_t = sampler.wrapT != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    if (sampler.wrapS == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ||
        sampler.wrapT == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) {
      reading_.warn(0, where + "its mirrored repeats are shown unmirrored");
    }
  }
  const ImageSource& image = images_[static_cast<std::size_t>(found.source)];
  const auto [it, is_new] = shown_.try_emplace({image.buffer_view, image.uri, repeat_s, repeat_t});
  if (!is_new) return it->second;
  const auto url = url_of(image);
  if (!url) return none(url.error());
  it->second = add_image(reading_.document, reading_.at(0), *url, repeat_s, repeat_t);
  return it->second;
}

void Materials::name_what_is_not_shown(int material) {
  const tinygltf::Material& m = model_.materials[static_cast<std::size_t>(material)];
  std::string what;
  const auto name = [&](bool there, const char* part) {
    if (there) what += (what.empty() ? "" : ", ") + std::string(part);
  };
  name(m.normalTexture.index >= 0, "normalTexture");
  name(m.occlusionTexture.index >= 0, "occlusionTexture");
  name(m.emissiveTexture.index >= 0, "emissiveTexture");
  name(m.pbrMetallicRoughness.metallicRoughnessTexture.index >= 0, "metallicRoughnessTexture");
  name(m.alphaMode == "MASK", "alphaMode MASK");
  const auto is_share = [](double value) { return value >= 0.0 && value <= 1.0; };
  name(!std::ranges::all_of(m.pbrMetallicRoughness.baseColorFactor, is_share), "baseColorFactor beyond 0 to 1");
  name(!std::ranges::all_of(m.emissiveFactor, is_share), "emissiveFactor beyond 0 to 1");
  name(!is_share(m.pbrMetallicRoughness.roughnessFactor), "roughnessFactor beyond 0 to 1");
  name(m.pbrMetallicRoughness.baseColorTexture.texCoord != 0, "texCoord of baseColorTexture other than 0");
  name(m.pbrMetallicRoughness.baseColorTexture.extensions.contains("KHR_texture_transform"), "KHR_texture_transform");
  // The colours of an image take the place of others in a world; in a glTF all are multiplied.
  name(has_texture(material) && is_tinted(material), "baseColorFactor beside baseColorTexture");
  for (const auto& [extension, value] : m.extensions) name(extension != "KHR_materials_unlit", extension.c_str());
  const std::string place = "materials/" + std::to_string(material);
  if (m.pbrMetallicRoughness.metallicFactor != 0.0 && !m.extensions.contains("KHR_materials_unlit")) {
    reading_.lose(
        "its metallicFactor is not 0 (it is 1 where none is given), and is not shown: a Material of a world is of no "
        "metal",
        place);
  }
  if (!what.empty()) reading_.warn(0, place + ": these are not shown: " + what);
}

vrml::NodeRef Materials::appearance(int material) {
  vrml::NodeRef& made = material < 0 ? usual_ : made_[static_cast<std::size_t>(material)];
  if (made.is_node()) return made;
  MaterialDraft draft;
  vrml::NodeRef image;
  draft.diffuse = {1, 1, 1};
  if (material >= 0) {
    const tinygltf::Material& m = model_.materials[static_cast<std::size_t>(material)];
    const auto& pbr = m.pbrMetallicRoughness;
    draft.diffuse = screen_color(pbr.baseColorFactor);
    if (m.emissiveFactor.size() == 3) draft.emissive = screen_color(m.emissiveFactor);
    if (m.alphaMode == "BLEND")
      draft.transparency = static_cast<float>(1.0 - std::clamp(pbr.baseColorFactor[3], 0.0, 1.0));
    draft.shininess = static_cast<float>(1.0 - std::clamp(pbr.roughnessFactor, 0.0, 1.0));
    if (m.extensions.contains("KHR_materials_unlit")) {
      draft.emissive = draft.diffuse;
      draft.diffuse = {0, 0, 0};
    }
    if (has_texture(material)) image = image_of(pbr.baseColorTexture.index);
    name_what_is_not_shown(material);
  }
  made = add_appearance(reading_.document, reading_.at(0), draft, image);
  return made;
}

}  // namespace peerd::formats::gltf
