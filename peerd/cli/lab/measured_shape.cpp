#include "peerd/cli/lab/measured_shape.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <chrono>
#include <utility>

#include "collision/volumes/convex_hull.hpp"
#include "collision/volumes/enclosing_ball.hpp"
#include "collision/volumes/enclosing_box.hpp"
#include "collision/volumes/level_volumes.hpp"
#include "collision/volumes/turned_volume.hpp"

namespace peerd {
namespace {

using collision::TriangleSoup;
using collision::engines::KdopOptions;

std::optional<ShapeTightness> tightness_of(const TriangleSoup& soup, std::uint32_t steps) {
  std::vector<bool> used(soup.vertices.size());
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t corner : face.corners) used[corner] = true;
  }
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) points.push_back(soup.vertices[v]);
  }
  const auto hull = collision::convex_hull(points);
  if (!hull || !(hull->volume_m3 > 0.0)) return std::nullopt;
  const double percent = 100.0 / hull->volume_m3;
  ShapeTightness out{.hull_corners = hull->corners.size(), .hull_m3 = hull->volume_m3};
  out.box = percent * volume(collision::small_box(*hull));
  out.ball = percent * volume(collision::smallest_ball(hull->corners));
  for (std::uint32_t i = 0; i < collision::kTurnAxes.size() * steps; ++i) {
    const Mat3 rotation = collision::thesis_rotation(i, steps);
    const double kdop = percent * volume(collision::kdop_around<18>(hull->corners, rotation));
    const double aabb = percent * volume(collision::kdop_around<6>(hull->corners, rotation));
    out.kdop.add(kdop);
    out.aabb.add(aabb);
    out.turned.push_back({kdop, aabb});
  }
  return out;
}

template <int K>
MeasuredHierarchy measure(const TriangleSoup& soup, const KdopOptions& options, bool levels) {
  MeasuredHierarchy out{.options = options};
  const auto start = std::chrono::steady_clock::now();
  collision::KdopTree<K> tree(soup, options.tree);
  tree.build_all();
  out.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.height = tree.height();
  const std::size_t threshold = options.tree.split_threshold;
  const std::size_t leaves = (soup.faces.size() + threshold - 1) / threshold;
  out.least_height = static_cast<std::uint32_t>(std::bit_width(leaves - 1));  // ceil(log2(leaves))
  out.nodes = tree.nodes().size();
  out.bytes = out.nodes * sizeof(typename collision::KdopTree<K>::Node) + tree.order().size_bytes();
  if (levels) {
    out.level_percent = level_volumes(tree);
    const double root = out.level_percent.front();
    for (double& level : out.level_percent) level = root > 0.0 ? 100.0 * level / root : 0.0;
  }
  return out;
}

MeasuredHierarchy measured_hierarchy(const TriangleSoup& soup, const KdopOptions& options, bool levels) {
  switch (options.k) {
    case 6:
      return measure<6>(soup, options, levels);
    case 14:
      return measure<14>(soup, options, levels);
    case 26:
      return measure<26>(soup, options, levels);
    default:
      assert(options.k == 18);
      return measure<18>(soup, options, levels);
  }
}

}  // namespace

void OverTurns::add(double value) {
  least = std::min(least, value);
  greatest = std::max(greatest, value);
  sum += value;
}

MeasuredShape measure_shape(std::string path, const TriangleSoup& soup, std::uint32_t steps,
                            const std::vector<KdopOptions>& hierarchies, bool levels) {
  MeasuredShape out{.path = std::move(path), .triangles = soup.faces.size(), .vertices = soup.vertices.size()};
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    if (f == 0 || soup.faces[f].polygon != soup.faces[f - 1].polygon) ++out.polygons;
  }
  out.box = soup.box;
  out.tightness = tightness_of(soup, steps);
  for (const KdopOptions& hierarchy : hierarchies) {
    out.hierarchies.push_back(measured_hierarchy(soup, hierarchy, levels));
  }
  return out;
}

}  // namespace peerd
