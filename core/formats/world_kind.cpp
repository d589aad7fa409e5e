#include "core/formats/world_kind.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/formats/draft/bytes.hpp"
#include "core/vrml/gzip.hpp"

namespace peerd::formats {
namespace {

// Comments in front of the first statement are looked through up to here [bytes].
constexpr std::size_t kSearched = std::size_t{1} << 16;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// Returns the first word behind white space and lines that begin with '#'.
std::string_view first_word(std::string_view text) {
  text = text.substr(0, kSearched);
  while (true) {
    std::size_t begin = 0;
    while (begin < text.size() && is_space(text[begin])) ++begin;
    text.remove_prefix(begin);
    if (!text.starts_with('#')) break;
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  }
  std::size_t end = 0;
  while (end < text.size() && !is_space(text[end])) ++end;
  return text.substr(0, end);
}

// The headers of OFF are [ST][C][N][4][n]OFF.
bool is_off_header(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N", "4", "n"}) {
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  }
  return word == "OFF";
}

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < kStlHeader_bytes) return false;
  const std::uint64_t facets = little_endian<std::uint32_t>(bytes.substr(kStlHeader_bytes - 4));
  return bytes.size() == kStlHeader_bytes + facets * kStlFacet_bytes;
}

std::optional<WorldKind> kind_by_content(std::string_view bytes) {
  constexpr std::array<std::string_view, 20> kObjWords{"v",     "vn",  "vt",   "vp",  "f",      "g",      "o",
                                                       "s",     "l",   "p",    "deg", "bmat",   "cstype", "mg",
                                                       "bevel", "lod", "call", "csh", "mtllib", "usemtl"};
  if (bytes.starts_with("#VRML")) return WorldKind::kVrml;
  if (bytes.starts_with("#X3D")) return WorldKind::kX3dClassic;
  if (bytes.starts_with("glTF")) return WorldKind::kGlb;
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return WorldKind::kPly;
  if (is_binary_stl(bytes)) return WorldKind::kStlBinary;
  const std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (bytes.starts_with(byte_order_mark)) bytes.remove_prefix(byte_order_mark.size());
  const std::string_view word = first_word(bytes);
  if (word.starts_with('{')) return WorldKind::kGltf;
  if (word.starts_with('<')) return WorldKind::kX3d;
  if (word == "solid") return WorldKind::kStlText;
  if (is_off_header(word)) return WorldKind::kOff;
  if (std::ranges::find(kObjWords, word) != kObjWords.end()) return WorldKind::kObj;
  return std::nullopt;
}

std::optional<WorldKind> kind_by_name(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, WorldKind>, 12> kEndings{{{".x3d", WorldKind::kX3d},
                                                                             {".x3dz", WorldKind::kX3d},
                                                                             {".x3d.gz", WorldKind::kX3d},
                                                                             {".x3dv", WorldKind::kX3dClassic},
                                                                             {".x3dvz", WorldKind::kX3dClassic},
                                                                             {".x3dv.gz", WorldKind::kX3dClassic},
                                                                             {".obj", WorldKind::kObj},
                                                                             {".stl", WorldKind::kStlBinary},
                                                                             {".ply", WorldKind::kPly},
                                                                             {".off", WorldKind::kOff},
                                                                             {".gltf", WorldKind::kGltf},
                                                                             {".glb", WorldKind::kGlb}}};
  const auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
  for (const auto& [ending, kind] : kEndings) {
    if (name.size() < ending.size()) continue;
    if (std::ranges::equal(name.substr(name.size() - ending.size()), ending, {}, lower)) return kind;
  }
  return std::nullopt;
}

}  // namespace

std::string_view name_of(WorldKind kind) {
  constexpr std::array<std::string_view, 10> kNames{
      "VRML97", "OBJ", "STL (text)", "STL (binary)", "PLY", "OFF", "glTF", "glTF (GLB)", "X3D", "X3D (Classic VRML)"};
  return kNames[static_cast<std::size_t>(kind)];
}

bool is_text_of_nodes(WorldKind kind) {
  return kind == WorldKind::kVrml || kind == WorldKind::kX3d || kind == WorldKind::kX3dClassic;
}

bool says_its_unit(WorldKind kind) {
  return is_text_of_nodes(kind) || kind == WorldKind::kGltf || kind == WorldKind::kGlb;
}

WorldKind kind_of(std::string_view bytes, std::string_view name) {
  if (is_gzip(bytes)) {
    // Only texts of nodes may be packed, and they look into the file themselves.
    const auto kind = kind_by_name(name);
    return kind && is_text_of_nodes(*kind) ? *kind : WorldKind::kVrml;
  }
  if (const auto kind = kind_by_content(bytes)) return *kind;
  return kind_by_name(name).value_or(WorldKind::kVrml);
}

}  // namespace peerd::formats
