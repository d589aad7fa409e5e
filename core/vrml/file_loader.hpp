#pragma once
#include <algorithm>
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

// What a world may ask for. A short file can ask for much: what a file grows to is limited by its own size.
struct ReadLimits {
  std::uint64_t text_bytes = std::uint64_t{1} << 30;  // size of all texts, unpacked; below 4 GiB
  std::uint32_t nodes = 1u << 22;                     // after PROTOs are expanded
  std::uint32_t instances = 1u << 22;                 // a USE counts again
  std::uint64_t polygons = 1u << 24;                  // polygons of one geometry, tessellated
  // A text of any length may unpack to so many bytes, and ask for so many polygons of Extrusions and ElevationGrids.
  std::uint64_t unpacked_base_bytes = 1u << 24, swept_base = 1u << 18;
  // unpacked_bytes() and swept_polygons() are multiplied by this: for the rare file that is meant so.
  std::uint32_t expansion = 1;

  static constexpr std::string_view kRaised = "; the option expansion allows more";

  // Returns the size to which a packed text may unpack. Worlds pack to a fifth or a tenth, regular grids to a
  // thirtieth.
  [[nodiscard]] std::uint64_t unpacked_bytes(std::uint64_t packed) const {
    return expansion * (unpacked_base_bytes + 64 * packed);
  }
  // Returns the number of polygons that a world's Extrusions and ElevationGrids may have together. A grid has less than
  // one for two bytes of its heights; an Extrusion multiplies the corners of its cross-section by those of its spine.
  [[nodiscard]] std::uint64_t swept_polygons(std::uint64_t bytes) const { return expansion * (swept_base + bytes); }

  // Returns the limits of a text of so many bytes that somebody adds to a world which runs. All peers read it between
  // two ticks, so that it may expand to little more than its own length.
  [[nodiscard]] ReadLimits of_added(std::uint64_t bytes) const {
    ReadLimits added = *this;
    const std::uint64_t most = 4096 + bytes;
    added.nodes = static_cast<std::uint32_t>(std::min<std::uint64_t>(nodes, most));
    added.instances = static_cast<std::uint32_t>(std::min<std::uint64_t>(instances, most));
    added.unpacked_base_bytes = std::uint64_t{1} << 16;
    added.swept_base = std::uint64_t{1} << 14;
    return added;
  }
};

}  // namespace peerd
