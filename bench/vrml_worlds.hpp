#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace peerd::bench {

struct TextWorld {
  std::string name;
  std::string text;
  // A reader must find these numbers of the Shapes; a USE counts again.
  std::uint64_t polygons = 0, triangles = 0;
};

// Worlds of the kinds that are large in practice, always the same ones; each over 1 MB unless `quick`.
[[nodiscard]] std::vector<TextWorld> make_worlds(bool quick);

}  // namespace peerd::bench
