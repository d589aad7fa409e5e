#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "bench/collision_meshes.hpp"

namespace peerd::bench::exact {

// The soups are those of all OBJ and OFF files of a folder that have at least one and no more than `most` triangles,
// in the order of their names.
[[nodiscard]] std::vector<NamedSoup> read_soups(const std::string& folder, std::size_t most);

// A result holds what came of a mesh against itself, and against another one.
struct MeshResult {
  std::string name;
  std::size_t triangles = 0, polygons = 0;
  std::uint64_t poses = 0, touching = 0;
  std::uint64_t pairs = 0;         // of polygons, by brute force, over all poses
  std::uint64_t wide_queries = 0;  // of each of the two sorts
  std::uint64_t kdop_queries = 0;  // "
  std::uint64_t wrong = 0;         // queries that found other pairs, or one that isn't there
};

// `a` on itself: as it is, with vertices of it exactly on each other, a quarter turn, and overlapping somehow; and on
// `b` somehow. What all_pairs() and find_pair() of wide trees and of k-DOP trees find is compared with every polygon
// against every polygon. Each pose has other options of the k-DOP trees; `number` is that of the first.
[[nodiscard]] MeshResult check_mesh(const NamedSoup& a, const NamedSoup& b, std::uint64_t seed, std::uint32_t& number);

}  // namespace peerd::bench::exact
