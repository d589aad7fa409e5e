#include "core/geometry/mesh_defects.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "core/geometry/planarity.hpp"
#include "core/geometry/triangulation.hpp"

namespace peerd {
namespace {

constexpr double kVisible = 1e-4;  // share of the longest edge
constexpr std::uint32_t kUnknown = ~0U;

void count(MeshDefects& found, Defect defect, std::uint32_t polygon) {
  MeshDefects::Count& count = found[defect];
  count.first = count.polygons == 0 ? polygon : std::min(count.first, polygon);
  ++count.polygons;
}

// The sums are of differences from the first corner, so that the distance from the origin costs no places.
bool is_warped(std::span<const Eigen::Vector3f> points) {
  using Vector = Eigen::Vector3d;
  const auto from_first = [&](std::size_t i) -> Vector { return points[i].cast<double>() - points[0].cast<double>(); };
  Vector area = Vector::Zero(), p = Vector::Zero();
  double longest = from_first(points.size() - 1).squaredNorm();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector q = from_first(i);
    area += p.cross(q);
    longest = std::max(longest, (q - p).squaredNorm());
    p = q;
  }
  double low = 0.0, high = 0.0;  // the first corner is at 0
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double height = area.dot(from_first(i));
    low = std::min(low, height);
    high = std::max(high, height);
  }
  const double size = area.norm();
  return size == 0.0 || high - low > kVisible * std::sqrt(longest) * size;
}

// Returns the beginning of the least of all rotations. The search keeps two candidates; each comparison rules out as
// many beginnings as it has read. Linear.
std::size_t least_rotation(std::span<const std::uint32_t> cycle) {
  const std::size_t n = cycle.size();
  const auto at = [&](std::size_t i) { return cycle[i < n ? i : i - n]; };
  std::size_t i = 0, j = 1, same = 0;
  while (i < n && j < n && same < n) {
    const std::uint32_t a = at(i + same), b = at(j + same);
    if (a == b) {
      ++same;
      continue;
    }
    (a > b ? i : j) += same + 1;
    if (i == j) ++j;
    same = 0;
  }
  return std::min(i, j);
}

// The result is equal for cycles that are equal up to rotation and reversal, and begins with the lowest place.
void make_canonical(std::span<std::uint32_t> cycle, std::vector<std::uint32_t>& reversed) {
  if (cycle.size() <= 3) {  // all orders are one
    std::ranges::sort(cycle);
    return;
  }
  reversed.assign(cycle.rbegin(), cycle.rend());
  std::ranges::rotate(cycle, cycle.begin() + static_cast<std::ptrdiff_t>(least_rotation(cycle)));
  std::ranges::rotate(reversed, reversed.begin() + static_cast<std::ptrdiff_t>(least_rotation(reversed)));
  if (std::ranges::lexicographical_compare(reversed, cycle)) std::ranges::copy(reversed, cycle.begin());
}

}  // namespace

MeshDefects MeshDefectFinder::find(const Mesh& mesh) {
  MeshDefects found;
  weld_vertices(mesh);
  find_shapes(mesh, found);
  find_edges(found);
  find_duplicates(found);  // last, as it reorders the corners
  return found;
}

void MeshDefectFinder::weld_vertices(const Mesh& mesh) {
  positions_.clear();
  corners_.clear();
  corners_.reserve(mesh.corners.size());
  begin_.assign(1, 0);
  begin_.reserve(mesh.polygon_count() + 1);
  slots_.assign(std::bit_ceil(2 * std::min(mesh.vertices.size(), mesh.corners.size()) + 2), 0);
  // Places are remembered by vertex, unless most vertices belong to other meshes.
  const bool remember = mesh.vertices.size() <= mesh.corners.size();
  position_of_vertex_.assign(remember ? mesh.vertices.size() : 0, kUnknown);
  for (std::size_t i = 0; i < mesh.polygon_count(); ++i) {
    for (const std::int32_t corner : mesh.polygon(i)) {
      const auto vertex = static_cast<std::size_t>(corner);
      std::uint32_t place = remember ? position_of_vertex_[vertex] : kUnknown;
      if (place == kUnknown) place = position_index(mesh.vertices[vertex]);
      if (remember) position_of_vertex_[vertex] = place;
      corners_.push_back(place);
    }
    begin_.push_back(static_cast<std::uint32_t>(corners_.size()));
  }
}

std::uint32_t MeshDefectFinder::position_index(const Point& point) {
  const Point place = point + Point::Zero();  // -0 + 0 = 0
  const auto bits = [&](Eigen::Index k) { return std::uint64_t{std::bit_cast<std::uint32_t>(place[k])}; };
  std::uint64_t hash = (bits(0) | bits(1) << 32) * 0x9e37'79b9'7f4a'7c15;
  hash = (hash ^ (hash >> 32) ^ bits(2) << 16) * 0xd6e8'feb8'6659'fd93;  // an odd constant of mixed bits, as above
  std::size_t slot = (hash ^ (hash >> 32)) & (slots_.size() - 1);
  while (slots_[slot] != 0) {
    if (positions_[slots_[slot] - 1] == place) return slots_[slot] - 1;
    slot = (slot + 1) & (slots_.size() - 1);
  }
  positions_.push_back(place);
  slots_[slot] = static_cast<std::uint32_t>(positions_.size());
  return slots_[slot] - 1;
}

void MeshDefectFinder::find_shapes(const Mesh& mesh, MeshDefects& found) {
  for (std::uint32_t i = 0; i < polygons(); ++i) {
    if (!has_front(mesh.vertices.span(), mesh.polygon(i))) count(found, Defect::kDegenerate, i);
    if (polygon(i).size() <= 3) continue;
    points_.clear();
    for (const std::uint32_t place : polygon(i)) points_.push_back(positions_[place]);
    if (coplanar(points_)) continue;
    count(found, Defect::kNonPlanar, i);
    if (is_warped(points_)) count(found, Defect::kWarped, i);
  }
}

// Lists are filled in two rounds, as by counting sort: ++list_end_[place] for each entry to come, lay_out_lists(), then
// entries_[list_end_[place]++] = entry.
void MeshDefectFinder::start_lists() { list_end_.assign(positions_.size(), 0); }

void MeshDefectFinder::lay_out_lists() {
  std::uint32_t begin = 0;
  for (std::uint32_t& size : list_end_) {
    const std::uint32_t end = begin + size;
    size = begin;
    begin = end;
  }
  entries_.resize(begin);
}

// A place has a list of the edges to higher places: the other place, the polygon, and whether the edge runs downward.
// Files have neighbours close together, so that the lists stay in the cache where a hash table of edges would not.
void MeshDefectFinder::find_edges(MeshDefects& found) {
  const auto for_each_edge = [&](const auto& visit) {
    for (std::uint32_t i = 0; i < polygons(); ++i) {
      const std::span<const std::uint32_t> corners = polygon(i);
      std::uint32_t from = corners.back();
      for (const std::uint32_t to : corners) {
        visit(from, to, i);
        from = to;
      }
    }
  };
  start_lists();
  for_each_edge([&](std::uint32_t from, std::uint32_t to, std::uint32_t) {
    if (from != to) {
      ++list_end_[std::min(from, to)];
    } else {
      ++found.edges_without_length;
    }
  });
  lay_out_lists();
  assert(polygons() < 1U << 31);
  for_each_edge([&](std::uint32_t from, std::uint32_t to, std::uint32_t i) {
    if (from == to) return;
    const std::uint32_t use = i << 1 | (from > to ? 1U : 0U);
    entries_[list_end_[std::min(from, to)]++] = std::uint64_t{std::max(from, to)} << 32 | use;
  });

  non_manifold_.assign(polygons(), false);
  for (std::uint32_t place = 0; place < positions_.size(); ++place) {
    const std::span<std::uint64_t> edges = list(place);
    std::ranges::sort(edges);
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end] >> 32 == edges[begin] >> 32) ++end;
      classify_edge(edges.subspan(begin, end - begin), found);
    }
  }
  if (found.non_manifold_edges == 0) return;
  for (std::uint32_t i = 0; i < polygons(); ++i) {
    if (non_manifold_[i]) count(found, Defect::kNonManifold, i);
  }
}

// The uses are sorted by polygon.
void MeshDefectFinder::classify_edge(std::span<const std::uint64_t> uses, MeshDefects& found) {
  const auto polygon_of = [](std::uint64_t use) { return static_cast<std::uint32_t>(use) >> 1; };
  std::size_t polygons = 1, downward = uses[0] & 1;
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (polygon_of(uses[i]) != polygon_of(uses[i - 1])) ++polygons;
    downward += uses[i] & 1;
  }
  if (uses.size() == 1) ++found.boundary_edges;
  if (polygons <= 2) {
    if (std::max(downward, uses.size() - downward) >= 2) ++found.same_direction_edges;
    return;
  }
  ++found.non_manifold_edges;
  for (const std::uint64_t use : uses) non_manifold_[polygon_of(use)] = true;
}

// A place has a list of the polygons of which it is the lowest: the corner behind it, to compare less, and the number.
void MeshDefectFinder::find_duplicates(MeshDefects& found) {
  std::vector<std::uint32_t> reversed;
  start_lists();
  for (std::uint32_t i = 0; i < polygons(); ++i) {
    make_canonical(polygon(i), reversed);
    ++list_end_[polygon(i)[0]];
  }
  lay_out_lists();
  for (std::uint32_t i = 0; i < polygons(); ++i) {
    const std::span<const std::uint32_t> corners = polygon(i);
    entries_[list_end_[corners[0]]++] = std::uint64_t{corners[corners.size() > 1 ? 1 : 0]} << 32 | i;
  }
  const auto corners_of = [&](std::uint64_t entry) { return polygon(static_cast<std::uint32_t>(entry)); };
  const auto less = [&](std::uint64_t a, std::uint64_t b) {
    if (a >> 32 != b >> 32) return a < b;
    const auto order = std::lexicographical_compare_three_way(corners_of(a).begin(), corners_of(a).end(),
                                                              corners_of(b).begin(), corners_of(b).end());
    return order != 0 ? order < 0 : a < b;
  };
  for (std::uint32_t place = 0; place < positions_.size(); ++place) {
    const std::span<std::uint64_t> same_lowest = list(place);
    std::ranges::sort(same_lowest, less);
    for (std::size_t i = 1; i < same_lowest.size(); ++i) {
      if (std::ranges::equal(corners_of(same_lowest[i - 1]), corners_of(same_lowest[i]))) {
        count(found, Defect::kDuplicate, static_cast<std::uint32_t>(same_lowest[i]));
      }
    }
  }
}

}  // namespace peerd
