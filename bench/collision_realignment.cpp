// Question: three ways to take a k-DOP to another frame (the thesis's 3.2.3): how tight are they, and what do they
// cost?
//   conic     Realignment<K>: combinations of three slabs
//   boundary  the corners of the k-DOP's boundary, transformed and bounded
//   hull      the corners of the convex hull of what is in it, transformed and bounded: the tight k-DOP
#include "collision/tree/kdop_tree.hpp"
#include "collision/tree/realignment.hpp"
#include "collision/volumes/convex_hull.hpp"
#include "collision_experiments.hpp"
#include "collision_kdops.hpp"
#include "generated_text.hpp"

namespace peerd::bench {
namespace {

using collision::KdopTree;
using collision::RelativeMotion;
using collision::WideKdop;

template <int K>
struct Bounded {
  collision::Kdop<K> dop;
  std::vector<Vec3> boundary, hull;
};

template <int K>
WideKdop<K> moved(const std::vector<Vec3>& points, const RelativeMotion& motion) {
  auto out = WideKdop<K>::empty();
  for (const Vec3& at : points) {
    const Vec3 p = motion.rotation * at + motion.translation;
    for (std::size_t i = 0; i < out.kSlabs; ++i) {
      const double along_it = collision::along(out.kDirections[i], p);
      out.lo[i] = std::min(out.lo[i], along_it);
      out.hi[i] = std::max(out.hi[i], along_it);
    }
  }
  return out;
}

// The nodes of a level that have a volume.
template <int K>
std::vector<Bounded<K>> bounded_at(const collision::TriangleSoup& soup, std::uint32_t level) {
  KdopTree<K> tree(soup, {collision::SplitRule::kSplatter, 1});
  std::vector<std::uint32_t> nodes = {0};
  for (std::uint32_t l = 0; l < level; ++l) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t i : nodes) {
      const std::uint32_t left = tree.children(i);
      if (left != KdopTree<K>::kLeaf) next.insert(next.end(), {left, left + 1});
    }
    nodes.swap(next);
  }
  std::vector<Bounded<K>> out;
  for (const std::uint32_t i : nodes) {
    std::vector<Vec3> corners;
    for (const std::uint32_t t : tree.triangles(tree.node(i))) {
      for (const Vec3& p : soup.triangle(t)) corners.push_back(p);
    }
    if (auto hull = collision::convex_hull(corners)) {
      out.push_back({tree.node(i).dop, corners_of(boundary(widened(tree.node(i).dop))), std::move(hull->corners)});
    }
  }
  return out;
}

template <int K>
void compare(const NamedSoup& object, std::uint32_t level, Table& table, Report& report) {
  const auto nodes = bounded_at<K>(object.soup, level);
  if (nodes.empty()) return;
  Random random(29);
  std::vector<RelativeMotion> motions;
  for (std::size_t i = 0; i < (report.quick() ? 10 : level == 0 ? 1'000 : 50); ++i) {
    const Vec3 turn(random.real(-3, 3), random.real(-3, 3), random.real(-3, 3));
    motions.emplace_back(Pose{}, Pose{Vec3(random.real(-2, 2), 0, 1), quat_exp(turn)});
  }
  double of_conic = 0, of_boundary = 0, boundary_corners = 0, hull_corners = 0;
  bool ordered = true;
  for (const RelativeMotion& motion : motions) {
    const collision::Realignment<K> realign(motion, 1.0);
    for (const Bounded<K>& node : nodes) {
      const auto conic = realign(node.dop), by_boundary = moved<K>(node.boundary, motion);
      const auto tight = moved<K>(node.hull, motion);
      for (std::size_t i = 0; i < K / 2; ++i) {
        ordered = ordered && conic.lo[i] <= by_boundary.lo[i] + 1e-9 && by_boundary.lo[i] <= tight.lo[i] + 1e-9 &&
                  conic.hi[i] >= by_boundary.hi[i] - 1e-9 && by_boundary.hi[i] >= tight.hi[i] - 1e-9;
      }
      const double of_tight = volume(tight);
      of_conic += volume(conic) / of_tight;
      of_boundary += volume(by_boundary) / of_tight;
      boundary_corners += static_cast<double>(node.boundary.size());
      hull_corners += static_cast<double>(node.hull.size());
    }
  }
  report.check(ordered, object.name + ": realigned k-DOPs that do not hold each other, k " + std::to_string(K));
  std::vector<collision::Realignment<K>> realignments;
  const auto each = [&](auto work) {
    return std::function<void()>([&, work] {
      for (std::size_t m = 0; m < motions.size(); ++m) {
        for (const Bounded<K>& node : nodes) use(work(motions[m], realignments[m], node));
      }
    });
  };
  const std::vector<std::function<void()>> runners = {
      [&] {
        realignments.clear();
        for (const RelativeMotion& motion : motions) realignments.emplace_back(motion, 1.0);
      },
      each([](const auto&, const auto& realign, const Bounded<K>& node) { return realign(node.dop); }),
      each([](const auto& motion, const auto&, const Bounded<K>& node) { return moved<K>(node.boundary, motion); }),
      each([](const auto& motion, const auto&, const Bounded<K>& node) { return moved<K>(node.hull, motion); })};
  const auto times = race(report.quick() ? 2 : 7, runners);
  const double count = static_cast<double>(motions.size() * nodes.size());
  const auto ns = [&](std::size_t i) { return 1e9 * times[i].median / count; };
  const double setup = 1e9 * times[0].median / static_cast<double>(motions.size());
  table.rows.push_back({object.name, std::to_string(level), std::to_string(K), text(100 * of_conic / count, 1),
                        text(100 * of_boundary / count, 1), text(ns(1), 0), text(ns(2), 0), text(ns(3), 0),
                        text(boundary_corners / count, 1), text(hull_corners / count, 1), text(setup, 0)});
  const std::string name = "realign." + object.name + ".level" + std::to_string(level) + ".k" + std::to_string(K);
  report.figure(name + ".conic", 100 * of_conic / count, "%", "hull", of_conic / count);
  report.figure(name + ".boundary", 100 * of_boundary / count, "%", "hull", of_boundary / count);
  report.figure(name + ".conic.time", ns(1), "ns");
  report.figure(name + ".boundary.time", ns(2), "ns", name + ".conic.time", ns(2) / ns(1));
  report.figure(name + ".hull.time", ns(3), "ns", name + ".conic.time", ns(3) / ns(1));
}

}  // namespace

void measure_realignment(const std::vector<NamedSoup>& soups, Report& report) {
  Table table{
      "realignment",
      "A node taken to a turned frame: volume as % of the tight k-DOP, ns a node; `frame ns`: Realignment's own",
      {"object", "level", "k", "conic %", "boundary %", "conic ns", "boundary ns", "hull ns", "boundary corners",
       "hull corners", "frame ns"}};
  for (const std::uint32_t level : {0u, 6u}) {
    for (const NamedSoup& object : soups) {
      compare<6>(object, level, table, report);
      compare<14>(object, level, table, report);
      compare<18>(object, level, table, report);
      compare<26>(object, level, table, report);
    }
  }
  report.print(table);
}

}  // namespace peerd::bench
