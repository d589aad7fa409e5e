#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace peerd::formats::gltf {

// The kinds of values that glTF's properties have. The library passes over an optional property whose value is of
// another kind, and says nothing: here such a file is wrong.
enum class ValueKind : std::uint8_t {
  kAny,
  kIndex,  // a whole number from 0 to 2^31 - 1
  kSize,   // a whole number from 0 to 2^53 - 1
  kNumber,
  kText,
  kFlag,
  kObject,
  kList
};

struct PropertyKind {
  ValueKind value = ValueKind::kAny;
  ValueKind elements = ValueKind::kAny;  // of a list
  std::size_t length = 0;                // of a list; 0: any length
};

// Returns what the property `key` must have in an object that is the value of `parent`, or an element of the list that
// is; `parent` is empty for the object that is the whole file. A property that glTF 2.0 does not have may have any
// value.
[[nodiscard]] PropertyKind kind_of_property(std::string_view parent, std::string_view key);

// Returns whether the JSON value at the begin of `text` is of that kind, by its first characters; of a number all
// characters count.
[[nodiscard]] bool is_of_kind(std::string_view text, ValueKind kind);

// Returns words for "it must be ..".
[[nodiscard]] std::string_view words_of(ValueKind kind);

}  // namespace peerd::formats::gltf
