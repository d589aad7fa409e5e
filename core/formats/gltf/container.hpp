#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

namespace peerd::formats::gltf {

// The two chunks of a GLB file; a .gltf file has only the first.
struct Container {
  std::string_view json, binary;
  std::size_t surplus_bytes = 0;  // behind the end that the header says
};
// Takes a GLB file apart. The error says in a sentence what is wrong with it.
[[nodiscard]] std::expected<Container, std::string> chunks_of(std::string_view glb);

// The JSON of a glTF, checked and changed, for the library. Buffers and images are taken out, because this reader reads
// them itself and the library would copy them. Extras and skins are taken out, because nothing reads them. A target of
// an animation that has no node gets node -1, because the library refuses it.
struct CheckedJson {
  std::string text;
  std::string_view buffers, images;  // the values that were taken out, in the file's text; empty where there is none
  std::size_t extras = 0;            // how many were taken out
};
// Checks and changes a JSON text. A value of another kind than its property has is an error (property_kinds.hpp).
// `most_bytes` is the memory that the library may need for the text: an object of two bytes may become three kilobytes.
[[nodiscard]] std::expected<CheckedJson, std::string> checked_json(std::string_view text, std::uint64_t most_bytes);

}  // namespace peerd::formats::gltf
