#include "collision/engines/convex_pieces.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "collision/exact/orientation.hpp"

namespace peerd::collision::engines {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

class Partition {
 public:
  explicit Partition(const TriangleSoup& soup) : soup_(soup) { weld(); }

  std::vector<SoupPiece> pieces() {
    std::vector<SoupPiece> out;
    for (const std::vector<std::uint32_t>& set : connected_sets()) {
      if (is_convex(set)) {
        out.push_back(piece_of(set));
      } else {
        for (const std::uint32_t face : set) out.push_back(piece_of({&face, 1}));
      }
    }
    return out;
  }

 private:
  // Each corner becomes the first vertex at its place.
  void weld() {
    std::map<std::array<double, 3>, std::uint32_t> first;
    for (const TriangleSoup::Face& face : soup_.faces) {
      Corners& corners = corners_.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& p = soup_.vertices[face.corners[i]];
        corners[i] = first.try_emplace({p[0], p[1], p[2]}, face.corners[i]).first->second;  // -0 == 0
      }
    }
  }

  std::vector<std::vector<std::uint32_t>> connected_sets() {
    std::vector<std::uint32_t> set_of(corners_.size());
    std::iota(set_of.begin(), set_of.end(), 0u);
    const auto root = [&](std::uint32_t i) {
      while (set_of[i] != i) i = set_of[i] = set_of[set_of[i]];
      return i;
    };
    std::map<Edge, std::uint32_t> first_with;
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      for (std::size_t side = 0; side < 3; ++side) {
        const Edge edge = std::minmax(corners_[i][side], corners_[i][(side + 1) % 3]);
        const std::uint32_t other = first_with.try_emplace(edge, i).first->second;
        set_of[std::max(root(i), root(other))] = std::min(root(i), root(other));
      }
    }
    std::vector<std::vector<std::uint32_t>> sets;
    std::vector<std::uint32_t> number(corners_.size());
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      const std::uint32_t first = root(i);
      assert(first <= i);
      if (first == i) {
        number[i] = static_cast<std::uint32_t>(sets.size());
        sets.emplace_back();
      }
      sets[number[first]].push_back(i);
    }
    return sets;
  }

  bool is_convex(const std::vector<std::uint32_t>& set) {
    if (set.size() < 4 || set.size() > kLargestConvexFaces) return false;
    return is_closed(set) && (all_behind(set, 1) || all_behind(set, -1));
  }
  // Whether each directed edge occurs once, and so does its opposite.
  [[nodiscard]] bool is_closed(const std::vector<std::uint32_t>& set) const {
    std::vector<Edge> edges;
    for (const std::uint32_t face : set) {
      for (std::size_t side = 0; side < 3; ++side) {
        edges.emplace_back(corners_[face][side], corners_[face][(side + 1) % 3]);
      }
    }
    std::ranges::sort(edges);
    if (std::ranges::adjacent_find(edges) != edges.end()) return false;
    return std::ranges::all_of(edges, [&](const Edge& edge) {
      return edge.first != edge.second && std::ranges::binary_search(edges, Edge{edge.second, edge.first});
    });
  }
  // Whether no vertex of the set is in front of a face, and some vertex is behind each; side -1: faces are seen from
  // their backs.
  bool all_behind(const std::vector<std::uint32_t>& set, int side) {
    const std::vector<std::uint32_t> vertices = vertices_of(set);
    return std::ranges::all_of(set, [&](std::uint32_t face) {
      const auto& [a, b, c] = corners_[face];
      const PlaneFilter filter(soup_.vertices[a], soup_.vertices[b], soup_.vertices[c]);
      bool some_behind = false;
      for (const std::uint32_t v : vertices) {
        int sign = filter.sign(soup_.vertices[v]);
        if (sign == 0) {
          sign =
              volume_sign_exact(soup_.vertices[a], soup_.vertices[b], soup_.vertices[c], soup_.vertices[v], counters_);
        }
        if (sign * side > 0) return false;
        some_behind = some_behind || sign != 0;
      }
      return some_behind;
    });
  }

  [[nodiscard]] std::vector<std::uint32_t> vertices_of(std::span<const std::uint32_t> set) const {
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t face : set) vertices.insert(vertices.end(), corners_[face].begin(), corners_[face].end());
    std::ranges::sort(vertices);
    const auto rest = std::ranges::unique(vertices);
    vertices.erase(rest.begin(), rest.end());
    return vertices;
  }

  [[nodiscard]] SoupPiece piece_of(std::span<const std::uint32_t> set) const {
    SoupPiece piece;
    piece.faces.assign(set.begin(), set.end());
    piece.vertices = vertices_of(set);
    piece.neighbors.resize(piece.vertices.size());
    const auto place = [&](std::uint32_t vertex) {
      return static_cast<std::uint32_t>(std::ranges::lower_bound(piece.vertices, vertex) - piece.vertices.begin());
    };
    for (const std::uint32_t face : set) {
      for (std::size_t side = 0; side < 3; ++side) {
        const std::uint32_t from = place(corners_[face][side]), to = place(corners_[face][(side + 1) % 3]);
        if (from == to) continue;
        piece.neighbors[from].push_back(to);
        piece.neighbors[to].push_back(from);
      }
    }
    for (std::vector<std::uint32_t>& list : piece.neighbors) {
      std::ranges::sort(list);
      const auto rest = std::ranges::unique(list);
      list.erase(rest.begin(), rest.end());
    }
    return piece;
  }

  const TriangleSoup& soup_;
  std::vector<Corners> corners_;  // by face, welded
  OrientationCounters counters_;
};

}  // namespace

std::vector<SoupPiece> convex_pieces(const TriangleSoup& soup) { return Partition(soup).pieces(); }

}  // namespace peerd::collision::engines
