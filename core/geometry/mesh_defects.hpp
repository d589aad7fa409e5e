#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/mesh.hpp"

namespace peerd {

// The defects that a polygon can have. No defect stops a collision from being computed, as the triangulation takes all
// polygons. The place of a corner decides, not its index; -0 is 0. A polygon can have several defects.
enum class Defect : std::uint8_t {
  // The polygon has no front (has_front), exactly: it has no area, or crosses itself so that its parts make up for each
  // other. Polygons of one or two corners have this defect.
  kDegenerate,
  // An earlier polygon has the same corners in the same cyclic order, or in the reverse. A corner that is written twice
  // is two corners. A first one and its two copies are two duplicates.
  kDuplicate,
  // The corners do not lie in one plane, exactly. Most polygons with more than three corners have this defect by
  // rounding alone: the triangulation says what their surface is.
  kNonPlanar,
  // The polygon is non-planar so that it can be seen: along the area vector (Newell) the corners are farther apart than
  // 1e-4 of the longest edge, the closing one included. Where that vector is zero, every polygon of kNonPlanar has this
  // defect. It is computed in binary64.
  kWarped,
  // An edge of the polygon belongs to more than two polygons.
  kNonManifold,
};
inline constexpr std::size_t kDefects = 5;

struct MeshDefects {
  struct Count {
    std::uint64_t polygons = 0;
    std::uint32_t first = 0;  // the lowest polygon that has it, if any
  };
  std::array<Count, kDefects> counts;

  // Edges are unordered pairs of places. A polygon that runs along an edge twice, as to a hole and back, still is one.
  std::uint64_t boundary_edges = 0;        // run along once
  std::uint64_t non_manifold_edges = 0;    // edges of more than two polygons
  std::uint64_t same_direction_edges = 0;  // edges of one or two polygons that run along them twice or more in one
                                           // direction one polygon shows its back
  std::uint64_t edges_without_length = 0;  // from a corner to the next at the same place; among none of the above

  [[nodiscard]] const Count& operator[](Defect defect) const { return counts[static_cast<std::size_t>(defect)]; }
  [[nodiscard]] Count& operator[](Defect defect) { return counts[static_cast<std::size_t>(defect)]; }
};

// A MeshDefectFinder examines one mesh after the other. The time is n log n in the corners (the hashing of places:
// expected), however many vertices the mesh shares with others. Coordinates must be finite.
class MeshDefectFinder {
 public:
  [[nodiscard]] MeshDefects find(const Mesh& mesh);

 private:
  using Point = Eigen::Vector3f;

  void weld_vertices(const Mesh& mesh);
  [[nodiscard]] std::uint32_t position_index(const Point& point);
  [[nodiscard]] std::span<std::uint32_t> polygon(std::uint32_t i) {
    return std::span(corners_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }
  [[nodiscard]] std::uint32_t polygons() const { return static_cast<std::uint32_t>(begin_.size() - 1); }
  void find_shapes(const Mesh& mesh, MeshDefects& found);
  void find_edges(MeshDefects& found);
  void classify_edge(std::span<const std::uint64_t> uses, MeshDefects& found);
  void find_duplicates(MeshDefects& found);
  void start_lists();
  void lay_out_lists();
  [[nodiscard]] std::span<std::uint64_t> list(std::uint32_t place) {
    return std::span(entries_).subspan(place == 0 ? 0 : list_end_[place - 1],
                                       list_end_[place] - (place == 0 ? 0 : list_end_[place - 1]));
  }

  // The arrays are kept from call to call for their memory.
  std::vector<Point> positions_;  // distinct ones
  std::vector<std::uint32_t> position_of_vertex_;
  std::vector<std::uint32_t> slots_;    // hash table: place + 1, 0 where it's free
  std::vector<std::uint32_t> corners_;  // places of all polygons
  std::vector<std::uint32_t> begin_;    // polygons + 1 offsets into it
  std::vector<std::uint64_t> entries_;  // a list for each place, one behind the other
  std::vector<std::uint32_t> list_end_;
  std::vector<bool> non_manifold_;
  std::vector<Point> points_;
};

}  // namespace peerd
