#pragma once
#include <cstdint>
#include <string_view>

namespace peerd::formats {

// The formats of world files. docs/reference/formats.md says what each can and cannot say.
enum class WorldKind : std::uint8_t { kVrml, kObj, kStlText, kStlBinary, kPly, kOff, kGltf, kGlb, kX3d, kX3dClassic };

[[nodiscard]] std::string_view name_of(WorldKind kind);  // for people
// Returns whether the format is VRML97 or one of the encodings of X3D, whose nodes are those of VRML97.
[[nodiscard]] bool is_text_of_nodes(WorldKind kind);
// Returns whether files of the format say in which unit their lengths are, and which axis points up.
[[nodiscard]] bool says_its_unit(WorldKind kind);

// Returns the format of a file. The content of a file decides its format. Where it does not, the end of the file's name
// does. Where neither does, the format is VRML97, and its reader reports what is wrong.
[[nodiscard]] WorldKind kind_of(std::string_view bytes, std::string_view name);

}  // namespace peerd::formats
