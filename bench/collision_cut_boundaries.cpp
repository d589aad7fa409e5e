// Question: shall the boundary of a node be cut from its parent's by one plane (the thesis's figure 3.9) or made from
// its own 18 slabs, if boundaries are what is transformed? And do queries gain from either, beside conic combinations
// of slabs?
#include <array>
#include <numeric>

#include "collision/exact/triangle_pair.hpp"
#include "collision/volumes/turned_volume.hpp"
#include "collision_descent.hpp"
#include "collision_experiments.hpp"
#include "collision_kdops.hpp"
#include "collision_motion.hpp"

namespace peerd::bench {
namespace {

using collision::KdopTree;
using Tree = KdopTree<18>;
using Polygon = std::vector<Vec3>;
using Polyhedron = std::vector<Polygon>;

// The part of a convex polyhedron where sign * p[axis] <= sign * at.
Polyhedron cut(const Polyhedron& whole, int axis, double at, double sign) {
  Polyhedron out;
  Polygon cap;
  for (const Polygon& polygon : whole) {
    Polygon part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const double p_out = sign * (p[axis] - at), q_out = sign * (q[axis] - at);
      if (p_out <= 0) part.push_back(p);
      if ((p_out < 0 && q_out > 0) || (p_out > 0 && q_out < 0)) {
        part.push_back(p + (q - p) * (p_out / (p_out - q_out)));
        part.back()[axis] = at;
        cap.push_back(part.back());
      }
    }
    if (part.size() >= 3) out.push_back(std::move(part));
  }
  if (cap.size() < 3) return out;
  const Vec3 center = std::accumulate(cap.begin(), cap.end(), Vec3(Vec3::Zero())) / static_cast<double>(cap.size());
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  std::ranges::sort(cap, {}, [&](const Vec3& p) { return std::atan2(p[j] - center[j], p[i] - center[i]); });
  out.push_back(std::move(cap));
  return out;
}

// The axis that a node was split across: there, no centroid of the left child is beyond one of the right child.
int split_axis(const Tree& tree, const Tree::Node& node) {
  const auto &left = tree.node(node.left), &right = tree.node(node.left + 1);
  const auto centroid = [&](std::uint32_t face, int axis) {
    const collision::Triangle t = tree.soup().triangle(face);
    return t[0][axis] + t[1][axis] + t[2][axis];
  };
  int best = 0;
  double least_overlap = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    double last = -std::numeric_limits<double>::infinity(), first = -last;
    for (const std::uint32_t f : tree.triangles(left)) last = std::max(last, centroid(f, axis));
    for (const std::uint32_t f : tree.triangles(right)) first = std::min(first, centroid(f, axis));
    if (last - first < least_overlap) least_overlap = last - first, best = axis;
  }
  return best;
}

struct Boundaries {
  std::vector<Polygon> corners;  // by node
  double volume_m3 = 0, seconds = 0, mean_corners = 0;
};

Boundaries finished(std::vector<Polyhedron> polyhedra, double seconds) {
  Boundaries out{.corners = {}, .seconds = seconds};
  for (const Polyhedron& p : polyhedra) {
    out.corners.push_back(corners_of(p));
    out.volume_m3 += volume_of(p);
    out.mean_corners += static_cast<double>(out.corners.back().size()) / static_cast<double>(polyhedra.size());
  }
  return out;
}

Boundaries from_slabs(const Tree& tree) {
  std::vector<Polyhedron> out(tree.nodes().size());
  const double seconds = seconds_of([&] {
    for (std::uint32_t i = 0; i < out.size(); ++i) out[i] = boundary(widened(tree.node(i).dop));
  });
  return finished(std::move(out), seconds);
}

Boundaries from_parents(const Tree& tree) {
  std::vector<Polyhedron> out(tree.nodes().size());
  std::vector<int> axes(out.size());
  for (std::uint32_t i = 0; i < out.size(); ++i) {
    if (tree.node(i).left < Tree::kUnsplit) axes[i] = split_axis(tree, tree.node(i));  // a build knows it
  }
  const double seconds = seconds_of([&] {
    out[0] = boundary(widened(tree.node(0).dop));
    for (std::uint32_t i = 0; i < out.size(); ++i) {  // parents stand before their children
      const std::uint32_t left = tree.node(i).left;
      if (left >= Tree::kUnsplit) continue;
      const auto k = static_cast<std::size_t>(axes[i]);
      out[left] = cut(out[i], axes[i], double{tree.node(left).dop.hi[k]}, 1);
      out[left + 1] = cut(out[i], axes[i], double{tree.node(left + 1).dop.lo[k]}, -1);
    }
  });
  return finished(std::move(out), seconds);
}

struct Way {
  const char* name;
  std::uint64_t bv_tests = 0, triangle_tests = 0, updates = 0;
  std::vector<std::size_t> touching = {};  // pairs, by query
};

void run(Tree& tree, const std::vector<CloseQuery>& queries, const Boundaries* boundaries, Way& way) {
  way = {way.name};
  for (const CloseQuery& q : queries) {
    std::size_t touching = 0;
    collision::OrientationCounters counters;
    const auto at_leaves = each_pair(tree, tree, q.a_from_b, [&](const auto& a, const auto& b) {
      ++way.triangle_tests;
      touching += touch(a, b, counters) ? 1 : 0;
      return false;
    });
    const collision::Realignment<18> realign(q.a_from_b, kExtent_m);
    const auto bound_a = [&](std::uint32_t i) -> const collision::Kdop<18>& { return tree.node(i).dop; };
    std::vector<Vec3> scratch;
    const auto bound_b = [&](std::uint32_t i) {
      ++way.updates;
      if (boundaries == nullptr) return realign(tree.node(i).dop);
      scratch.clear();
      for (const Vec3& p : boundaries->corners[i]) scratch.push_back(q.a_from_b.rotation * p + q.a_from_b.translation);
      return collision::kdop_around<18>(scratch);
    };
    Descent descent(tree, tree, bound_a, bound_b, at_leaves);
    (void)descent.run();
    way.bv_tests += descent.bv_tests;
    way.touching.push_back(touching);
  }
}

}  // namespace

void measure_cut_boundaries(const std::vector<NamedSoup>& soups, Report& report) {
  Table made{"boundaries",
             "Boundaries of all nodes (18-DOPs, splatter, threshold 4): from 18 slabs against cut from the parent's",
             {"object", "nodes", "slabs ms", "cut ms", "slabs corners", "cut corners", "cut/slabs volume"}};
  Table asked{
      "boundary_queries",
      "ALLPAIRS by how nodes are realigned: us a query; BV tests and triangle tests a query",
      {"object", "conic us", "slabs us", "cut us", "conic Nv", "slabs Nv", "cut Nv", "conic Np", "slabs Np", "cut Np"}};
  for (const NamedSoup& object : soups) {
    Tree tree(object.soup, {});
    tree.build_all();
    const Boundaries slabs = from_slabs(tree), cuts = from_parents(tree);
    report.check(cuts.volume_m3 >= slabs.volume_m3 * (1 - 1e-6),
                 object.name + ": what is cut by fewer planes is smaller");
    made.rows.push_back({object.name, text(std::uint64_t{tree.nodes().size()}), text(1e3 * slabs.seconds, 1),
                         text(1e3 * cuts.seconds, 1), text(slabs.mean_corners, 1), text(cuts.mean_corners, 1),
                         text(cuts.volume_m3 / slabs.volume_m3, 2)});
    const std::string name = "boundary." + object.name;
    report.figure(name + ".slabs.build", 1e3 * slabs.seconds, "ms");
    report.figure(name + ".cut.build", 1e3 * cuts.seconds, "ms", name + ".slabs.build", cuts.seconds / slabs.seconds);
    report.figure(name + ".cut.volume", cuts.volume_m3 / slabs.volume_m3, "", "slabs",
                  cuts.volume_m3 / slabs.volume_m3);

    auto queries = close_queries(move_copies(object.soup, report.quick() ? 4 : 60, 1));
    if (queries.size() > 150) queries.erase(queries.begin() + 150, queries.end());
    if (queries.empty()) continue;
    std::array<Way, 3> ways = {Way{"conic"}, Way{"slabs"}, Way{"cut"}};
    const std::array<const Boundaries*, 3> boundaries = {nullptr, &slabs, &cuts};
    std::vector<std::function<void()>> runners;
    for (std::size_t w = 0; w < ways.size(); ++w) {
      runners.emplace_back([&, w] { run(tree, queries, boundaries[w], ways[w]); });
    }
    const auto times = race(report.quick() ? 1 : 5, runners);
    const auto count = static_cast<double>(queries.size());
    auto& row = asked.rows.emplace_back(std::vector{object.name});
    for (std::size_t w = 0; w < ways.size(); ++w) {
      row.push_back(text(1e6 * times[w].median / count, 2));
      report.figure(name + '.' + ways[w].name + ".all_pairs", 1e6 * times[w].median / count, "us",
                    name + ".conic.all_pairs", times[w].median / times[0].median);
      report.check(ways[w].touching == ways[0].touching, object.name + ": ALLPAIRS by other boundaries");
    }
    for (const Way& way : ways) row.push_back(text(static_cast<double>(way.bv_tests) / count, 0));
    for (const Way& way : ways) row.push_back(text(static_cast<double>(way.triangle_tests) / count, 1));
  }
  report.print(made);
  report.print(asked);
}

}  // namespace peerd::bench
