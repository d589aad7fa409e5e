#include "core/formats/gltf/property_kinds.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

namespace peerd::formats::gltf {
namespace {

using enum ValueKind;

struct Property {
  std::string_view key;
  PropertyKind kind;
};

constexpr PropertyKind kIndices{kList, kIndex}, kNumbers{kList, kNumber}, kTexts{kList, kText},
    kObjects{kList, kObject};
constexpr PropertyKind numbers(std::size_t length) { return {kList, kNumber, length}; }

// The properties of glTF 2.0 (5.1 to 5.30) and of KHR_lights_punctual whose kind is the same in all objects, by name.
constexpr auto kProperties = [] {
  std::array properties{Property{"accessors", kObjects},
                        Property{"alphaCutoff", {kNumber}},
                        Property{"alphaMode", {kText}},
                        Property{"animations", kObjects},
                        Property{"aspectRatio", {kNumber}},
                        Property{"asset", {kObject}},
                        Property{"attributes", {kObject}},
                        Property{"baseColorFactor", numbers(4)},
                        Property{"baseColorTexture", {kObject}},
                        Property{"buffer", {kIndex}},
                        Property{"bufferView", {kIndex}},
                        Property{"bufferViews", kObjects},
                        Property{"buffers", kObjects},
                        Property{"byteLength", {kSize}},
                        Property{"byteOffset", {kSize}},
                        Property{"byteStride", {kIndex}},
                        Property{"camera", {kIndex}},
                        Property{"cameras", kObjects},
                        Property{"channels", kObjects},
                        Property{"children", kIndices},
                        Property{"color", numbers(3)},
                        Property{"componentType", {kIndex}},
                        Property{"copyright", {kText}},
                        Property{"count", {kSize}},
                        Property{"doubleSided", {kFlag}},
                        Property{"emissiveFactor", numbers(3)},
                        Property{"emissiveTexture", {kObject}},
                        Property{"extensions", {kObject}},
                        Property{"extensionsRequired", kTexts},
                        Property{"extensionsUsed", kTexts},
                        Property{"generator", {kText}},
                        Property{"images", kObjects},
                        Property{"index", {kIndex}},
                        Property{"innerConeAngle", {kNumber}},
                        Property{"input", {kIndex}},
                        Property{"intensity", {kNumber}},
                        Property{"interpolation", {kText}},
                        Property{"inverseBindMatrices", {kIndex}},
                        Property{"joints", kIndices},
                        Property{"light", {kIndex}},
                        Property{"lights", kObjects},
                        Property{"magFilter", {kIndex}},
                        Property{"material", {kIndex}},
                        Property{"materials", kObjects},
                        Property{"matrix", numbers(16)},
                        Property{"max", kNumbers},
                        Property{"mesh", {kIndex}},
                        Property{"meshes", kObjects},
                        Property{"metallicFactor", {kNumber}},
                        Property{"metallicRoughnessTexture", {kObject}},
                        Property{"mimeType", {kText}},
                        Property{"min", kNumbers},
                        Property{"minFilter", {kIndex}},
                        Property{"minVersion", {kText}},
                        Property{"mode", {kIndex}},
                        Property{"name", {kText}},
                        Property{"node", {kIndex}},
                        Property{"normalTexture", {kObject}},
                        Property{"normalized", {kFlag}},
                        Property{"occlusionTexture", {kObject}},
                        Property{"orthographic", {kObject}},
                        Property{"outerConeAngle", {kNumber}},
                        Property{"output", {kIndex}},
                        Property{"path", {kText}},
                        Property{"pbrMetallicRoughness", {kObject}},
                        Property{"perspective", {kObject}},
                        Property{"primitives", kObjects},
                        Property{"range", {kNumber}},
                        Property{"rotation", numbers(4)},
                        Property{"roughnessFactor", {kNumber}},
                        Property{"sampler", {kIndex}},
                        Property{"samplers", kObjects},
                        Property{"scene", {kIndex}},
                        Property{"scenes", kObjects},
                        Property{"skeleton", {kIndex}},
                        Property{"skin", {kIndex}},
                        Property{"skins", kObjects},
                        Property{"source", {kIndex}},
                        Property{"sparse", {kObject}},
                        Property{"spot", {kObject}},
                        Property{"strength", {kNumber}},
                        Property{"targets", kObjects},
                        Property{"texCoord", {kIndex}},
                        Property{"textures", kObjects},
                        Property{"translation", numbers(3)},
                        Property{"type", {kText}},
                        Property{"uri", {kText}},
                        Property{"values", {kObject}},
                        Property{"version", {kText}},
                        Property{"weights", kNumbers},
                        Property{"wrapS", {kIndex}},
                        Property{"wrapT", {kIndex}},
                        Property{"xmag", {kNumber}},
                        Property{"yfov", {kNumber}},
                        Property{"ymag", {kNumber}},
                        Property{"zfar", {kNumber}},
                        Property{"znear", {kNumber}}};
  std::ranges::sort(properties, {}, &Property::key);
  return properties;
}();

}  // namespace

PropertyKind kind_of_property(std::string_view parent, std::string_view key) {
  if (parent == "attributes" || parent == "targets") return {kIndex};  // names that the file may choose
  if (parent == "extensions") return {kObject};
  // The library keeps these as int.
  if ((parent == "sparse" && key == "count") || ((parent == "indices" || parent == "values") && key == "byteOffset")) {
    return {kIndex};
  }
  if (key == "nodes") return parent == "scenes" ? kIndices : kObjects;
  if (key == "scale") return parent == "normalTexture" ? PropertyKind{kNumber} : numbers(3);
  if (key == "indices") return {parent == "sparse" ? kObject : kIndex};
  if (key == "target") return {parent == "channels" ? kObject : kIndex};
  const auto found = std::ranges::lower_bound(kProperties, key, {}, &Property::key);
  return found != kProperties.end() && found->key == key ? found->kind : PropertyKind{};
}

bool is_of_kind(std::string_view text, ValueKind kind) {
  const char first = text.empty() ? '\0' : text.front();
  switch (kind) {
    case kAny:
      return true;
    case kIndex:
    case kSize: {
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc{} || value >> (kind == kIndex ? 31 : 53) != 0) return false;
      return end == text.data() + text.size() || (*end != '.' && *end != 'e' && *end != 'E');
    }
    case kNumber:
      return first == '-' || (first >= '0' && first <= '9');
    case kText:
      return first == '"';
    case kFlag:
      return first == 't' || first == 'f';
    case kObject:
      return first == '{';
    case kList:
      return first == '[';
  }
  return true;
}

std::string_view words_of(ValueKind kind) {
  switch (kind) {
    case kAny:
      break;
    case kIndex:
      return "a whole number from 0 to 2147483647";
    case kSize:
      return "a whole number from 0 to 2^53 - 1";
    case kNumber:
      return "a number";
    case kText:
      return "a string";
    case kFlag:
      return "true or false";
    case kObject:
      return "an object";
    case kList:
      return "a list";
  }
  return "a value";
}

}  // namespace peerd::formats::gltf
