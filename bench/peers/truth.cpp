#include "bench/peers/truth.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace peerd::bench::peers {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::array<double, 3> coordinates(const Point& p) { return {p.x, p.y, p.z}; }

}  // namespace

Truth::Truth(const TriangleMesh& mesh, std::size_t bodies) : mesh_(&mesh), bodies_(bodies) {
  std::vector<std::array<double, 3>> centers;
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) -> const Point& { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    centers.push_back(coordinates(at(0) + at(1) + at(2)));
  }
  order_.resize(centers.size());
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.push_back({0, static_cast<std::uint32_t>(order_.size()), 0});
  for (std::size_t i = 0; i < nodes_.size(); ++i) {  // split at the median of the widest axis
    const Node node = nodes_[i];
    if (node.size() == 1) continue;
    const auto begin = order_.begin() + node.begin, end = order_.begin() + node.end;
    std::size_t widest = 0;
    double width = -1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [lo, hi] =
          std::ranges::minmax(std::ranges::subrange(begin, end), {}, [&](auto t) { return centers[t][axis]; });
      const double extent = centers[hi][axis] - centers[lo][axis];
      if (extent > width) width = extent, widest = axis;
    }
    const std::uint32_t middle = node.begin + node.size() / 2;
    std::ranges::nth_element(begin, order_.begin() + middle, end, {}, [&](auto t) { return centers[t][widest]; });
    nodes_[i].left = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({node.begin, middle, 0});
    nodes_.push_back({middle, node.end, 0});
  }
  for (Body& body : bodies_) {
    body.vertices.resize(mesh.vertices.size());
    body.boxes.resize(nodes_.size());
  }
}

Truth::Box Truth::leaf_box(const Body& body, std::uint32_t triangle) const {
  constexpr float kFar = 1e30f;
  Box box;
  box.lo.fill(kFar);
  box.hi.fill(-kFar);
  for (const int v : mesh_->triangles[triangle]) {
    const auto p = coordinates(body.vertices[static_cast<std::size_t>(v)]);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto x = static_cast<float>(p[k]);  // monotonic, so outwards of the nearest is outwards of the number
      box.lo[k] = std::min(box.lo[k], std::nextafterf(x, -kFar));
      box.hi[k] = std::max(box.hi[k], std::nextafterf(x, kFar));
    }
  }
  return box;
}

void Truth::move(std::span<const Placement> placements) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    for (std::size_t i = 0; i < body.vertices.size(); ++i) body.vertices[i] = placements[b] * mesh_->vertices[i];
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      const Node& node = nodes_[i];
      if (node.size() == 1) {
        body.boxes[i] = leaf_box(body, order_[node.begin]);
        continue;
      }
      const Box &left = body.boxes[node.left], &right = body.boxes[node.left + 1];
      for (std::size_t k = 0; k < 3; ++k) {
        body.boxes[i].lo[k] = std::min(left.lo[k], right.lo[k]);
        body.boxes[i].hi[k] = std::max(left.hi[k], right.hi[k]);
      }
    }
  }
}

bool Truth::overlap(const Box& a, const Box& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (a.lo[k] > b.hi[k] || b.lo[k] > a.hi[k]) return false;
  }
  return true;
}

bool Truth::boxes_overlap(std::size_t a, std::size_t b) const {
  return overlap(bodies_[a].boxes[0], bodies_[b].boxes[0]);
}

bool Truth::triangles_touch(const Body& a, std::uint32_t i, const Body& b, std::uint32_t j) const {
  const auto triangle = [&](const Body& body, std::uint32_t t) {
    const auto corner = [&](std::size_t k) {
      const Point& p = body.vertices[static_cast<std::size_t>(mesh_->triangles[t][k])];
      return Kernel::Point_3(p.x, p.y, p.z);
    };
    return Kernel::Triangle_3(corner(0), corner(1), corner(2));
  };
  return CGAL::do_intersect(triangle(a, i), triangle(b, j));
}

std::size_t Truth::count(std::size_t a, std::size_t b, std::size_t most) const {
  const Body &first = bodies_[a], &second = bodies_[b];
  std::size_t found = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack = {{0, 0}};
  while (!stack.empty() && found < most) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    if (!overlap(first.boxes[i], second.boxes[j])) continue;
    const Node &x = nodes_[i], &y = nodes_[j];
    if (x.size() == 1 && y.size() == 1) {
      found += triangles_touch(first, order_[x.begin], second, order_[y.begin]);
    } else if (x.size() >= y.size()) {
      stack.push_back({x.left, j});
      stack.push_back({x.left + 1, j});
    } else {
      stack.push_back({i, y.left});
      stack.push_back({i, y.left + 1});
    }
  }
  return found;
}

}  // namespace peerd::bench::peers
