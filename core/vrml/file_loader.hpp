#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <string_view>

namespace peerd {

struct LoadedFile {
  std::string name;  // one for each file, however URLs spell it; for people, and its own URLs start from it
  std::string bytes;
};

// A FileLoader reads the file behind the URL of an Inline or an EXTERNPROTO, or says in a few words why it cannot.
// `base` is the name of the file that has the URL. The core opens no file itself.
using FileLoader = std::function<std::expected<LoadedFile, std::string>(std::string_view url, std::string_view base)>;

struct ReadLimits {
  std::uint64_t text_bytes = std::uint64_t{1} << 30;  // size of all texts, unpacked; below 4 GiB
  std::uint32_t nodes = 1u << 22;                     // after PROTOs are expanded
  std::uint32_t instances = 1u << 22;                 // a USE counts again
  std::uint64_t polygons = 1u << 24;                  // polygons of one geometry, tessellated
};

}  // namespace peerd
