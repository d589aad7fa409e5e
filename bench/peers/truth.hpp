#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/peers/meshes.hpp"

namespace peerd::bench::peers {

// Bodies of one mesh, and which of their triangles touch: by CGAL's exact predicates, of the world's vertices as
// binary64 has them. Slow: all vertices and boxes are taken to the world with every move.
class Truth {
 public:
  Truth(const TriangleMesh& mesh, std::size_t bodies);  // `mesh` stays at its place

  void move(std::span<const Placement> placements);
  // Whether the bodies' boxes of the world, of binary32 and rounded outwards, overlap.
  [[nodiscard]] bool boxes_overlap(std::size_t a, std::size_t b) const;
  [[nodiscard]] bool touch(std::size_t a, std::size_t b) const { return count(a, b, 1) > 0; }
  // Pairs of triangles that touch, no further than `most`.
  [[nodiscard]] std::size_t count(std::size_t a, std::size_t b, std::size_t most) const;

 private:
  struct Box {
    std::array<float, 3> lo, hi;
  };
  struct Node {
    std::uint32_t begin, end;  // of order_; one of them is a leaf
    std::uint32_t left;        // the right child follows; both come behind their parent
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
  };
  struct Body {
    std::vector<Point> vertices;
    std::vector<Box> boxes;  // by node
  };
  [[nodiscard]] static bool overlap(const Box& a, const Box& b);
  [[nodiscard]] Box leaf_box(const Body& body, std::uint32_t triangle) const;
  [[nodiscard]] bool triangles_touch(const Body& a, std::uint32_t i, const Body& b, std::uint32_t j) const;

  const TriangleMesh* mesh_;
  std::vector<std::uint32_t> order_;  // of triangles
  std::vector<Node> nodes_;
  std::vector<Body> bodies_;
};

}  // namespace peerd::bench::peers
