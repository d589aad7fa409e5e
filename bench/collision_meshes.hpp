#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "collision/exact/triangle_soup.hpp"

namespace peerd::bench {

struct NamedSoup {
  std::string name;
  collision::TriangleSoup soup;
};

// Objects of about that many triangles, at the origin, of bounding radius 1 m, with binary32 vertices.
[[nodiscard]] collision::TriangleSoup bumpy_knot(std::uint32_t triangles, std::uint64_t seed);    // a long, closed tube
[[nodiscard]] collision::TriangleSoup bumpy_sphere(std::uint32_t triangles, std::uint64_t seed);  // compact
[[nodiscard]] collision::TriangleSoup branches(std::uint32_t triangles, std::uint64_t seed);  // a tree's: open, thin

// The faces of an OBJ or OFF file, by its extension, moved and scaled like those above; none where it cannot be read.
[[nodiscard]] std::optional<collision::TriangleSoup> read_soup(const std::string& path);

// The files of the arguments, or, where there are none, six of PEERD_CORPUS/meshes; those that cannot be read are named
// on stderr and left out. `most`: triangles.
[[nodiscard]] std::vector<NamedSoup> soups_of_files(const std::vector<std::string>& arguments, std::size_t most);

}  // namespace peerd::bench
