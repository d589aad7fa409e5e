#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/engines/convex_pieces.hpp"

namespace peerd::collision::engines {

// The vertices of two convex pieces between which the nearest points are: a vertex, an edge or a face of each. They are
// where the next search of the same two begins.
struct ClosestFeatures {
  struct Corner {
    std::uint32_t a = 0, b = 0;  // places in SoupPiece::vertices
    friend bool operator==(const Corner&, const Corner&) = default;
  };
  std::array<Corner, 4> corners{};
  std::size_t count = 1;
};

// Finds out whether two convex pieces are certainly apart, by walks along their edges from the features that were the
// closest the last time: temporal coherence as in I-COLLIDE. Where I-COLLIDE walks from Voronoi region to Voronoi
// region (Lin and Canny 1991), this is the algorithm of Gilbert, Johnson and Keerthi (1988) begun with the last
// simplex, its support points found by hill climbing (Cameron, "Enhancing GJK", 1997): it finds the same features, and
// it also ends for pieces that overlap.
//
// An object keeps memory, never an answer.
class FeatureWalk {
 public:
  // A piece and where the vertices of its soup are, in the common frame.
  struct Placed {
    const SoupPiece& piece;
    std::span<const Vec3> vertices;

    [[nodiscard]] const Vec3& at(std::uint32_t place) const { return vertices[piece.vertices[place]]; }
  };

  // `room_m`: far above all rounding of coordinates in the common frame. False: the pieces may touch, or are nearer
  // than about the room.
  [[nodiscard]] bool apart(const Placed& a, const Placed& b, double room_m, ClosestFeatures& features);
  // Vertices visited since the beginning.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }

 private:
  [[nodiscard]] std::uint32_t support(const Placed& placed, const Vec3& direction, std::uint32_t from, double room);

  std::uint64_t steps_ = 0;
  std::vector<std::uint32_t> open_, visited_;
};

}  // namespace peerd::collision::engines
