#include "core/formats/mesh/ply_header.hpp"

#include <array>
#include <utility>

#include "core/formats/draft/words.hpp"
#include "core/vrml/diagnostics.hpp"

namespace peerd::formats {
namespace {

using vrml::quoted;

constexpr std::size_t kMostElements = 64, kMostProperties = 256;  // of a file, and of an element

struct TypeName {
  std::string_view name, other_name;
  std::size_t bytes;
};
// The rows are in the order of PlyType.
constexpr std::array<TypeName, 8> kTypes{{{"char", "int8", 1},
                                          {"uchar", "uint8", 1},
                                          {"short", "int16", 2},
                                          {"ushort", "uint16", 2},
                                          {"int", "int32", 4},
                                          {"uint", "uint32", 4},
                                          {"float", "float32", 4},
                                          {"double", "float64", 8}}};

std::optional<PlyType> type_of(std::string_view name) {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (name == kTypes[i].name || name == kTypes[i].other_name) return static_cast<PlyType>(i);
  }
  return std::nullopt;
}

std::optional<PlyEncoding> encoding_of(std::string_view name) {
  if (name == "ascii") return PlyEncoding::kText;
  if (name == "binary_little_endian") return PlyEncoding::kLittleEndian;
  if (name == "binary_big_endian") return PlyEncoding::kBigEndian;
  return std::nullopt;
}

// Reads what stands behind `property`; nothing where it is none.
std::optional<PlyProperty> property_of(Words words) {
  PlyProperty property;
  std::string_view type = words.next();
  if (type == "list") {
    property.count_type = type_of(words.next());
    if (!property.count_type || *property.count_type >= PlyType::kFloat32) return std::nullopt;
    type = words.next();
  }
  const auto known = type_of(type);
  if (!known) return std::nullopt;
  property.type = *known;
  property.name = words.next();
  return property.name.empty() ? std::nullopt : std::optional(property);
}

}  // namespace

std::size_t size_of(PlyType type) { return kTypes[static_cast<std::size_t>(type)].bytes; }

std::expected<PlyHeader, PlyHeaderError> read_ply_header(std::string_view bytes) {
  PlyHeader header;
  Lines lines(bytes);
  bool has_format = false;
  static_cast<void>(lines.next());  // ply
  while (const auto line = lines.next()) {
    const auto failed = [&](std::string why) { return std::unexpected(PlyHeaderError{lines.begin(), std::move(why)}); };
    Words words(*line);
    const std::string_view keyword = words.next();
    if (keyword == "end_header") {
      if (!has_format) return failed("the header names no format");
      header.end = lines.after();
      return header;
    }
    if (keyword == "format") {
      const std::string_view name = words.next();
      const auto encoding = encoding_of(name);
      if (!encoding) return failed("the format " + quoted(name) + " is none of PLY's");
      header.encoding = *encoding;
      has_format = true;
    } else if (keyword == "element") {
      const std::string_view name = words.next();
      const auto count = integer_of(words.next());
      if (name.empty() || !count || *count < 0) return failed("expected a name and a count behind 'element'");
      if (header.elements.size() == kMostElements)
        return failed("more kinds of elements than a PLY file may have here");
      header.elements.push_back({name, static_cast<std::uint64_t>(*count), {}, lines.begin()});
    } else if (keyword == "property") {
      const auto property = property_of(words);
      if (!property || header.elements.empty()) return failed("expected a type and a name behind 'property'");
      auto& properties = header.elements.back().properties;
      if (properties.size() == kMostProperties) return failed("more properties than an element may have here");
      properties.push_back(*property);
    } else if (keyword != "comment" && keyword != "obj_info") {
      return failed("expected a line of the header of a PLY file, found " + quoted(keyword));
    }
  }
  return std::unexpected(PlyHeaderError{bytes.size(), "the header has no end_header"});
}

}  // namespace peerd::formats
