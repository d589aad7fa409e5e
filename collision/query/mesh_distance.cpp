#include "collision/query/mesh_distance.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "collision/exact/infinity.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/triangle_distance.hpp"
#include "collision/query/wide_distance.hpp"

namespace peerd::collision {

using Ref = WideTree::Ref;

namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

// Up to eight boxes: those of the children of a node, or that of a leaf.
struct Boxes {
  const WideTree::Node* node = nullptr;
  std::uint32_t count = 0;
};

Boxes boxes(const WideTree& tree, WideTree::ChildSlot slot, Ref ref, WideTree::Node& own) {
  if (ref.kind() == Ref::kLeaf) {
    own = tree.lone(slot);
    return {&own, 1};
  }
  assert(ref.kind() == Ref::kNode && tree.node(ref.index()).children[0].kind() != Ref::kNone);
  const WideTree::Node& node = tree.node(ref.index());
  std::uint32_t count = WideTree::kWidth;
  while (node.children[count - 1].kind() == Ref::kNone) --count;
  return {&node, count};
}

// The range of a polygon's faces, which stand by polygon.
auto faces_of(const TriangleSoup& soup, std::uint32_t polygon) {
  const auto faces = std::ranges::equal_range(soup.faces, polygon, {}, &TriangleSoup::Face::polygon);
  assert(!faces.empty());
  const auto first = static_cast<std::uint32_t>(faces.begin() - soup.faces.begin());
  return std::pair{first, first + static_cast<std::uint32_t>(faces.size())};
}

}  // namespace

struct MeshDistanceQuery::Search {
  WideTree &a, &b;
  const RelativeMotion& a_from_b;
  const MeshDistanceOptions& options;
  std::vector<Open>& open;  // a heap, the nearest on top
  WideMotion motion;
  MeshDistance found;
  double skipped_m = kInfinity;  // no pair that was passed over is nearer [m]
  std::uint32_t opened = 0;
  std::array<float, 3> toward{};  // from A to B, along the points of `found`, on A's scale

  Search(WideTree& tree_a, WideTree& tree_b, const RelativeMotion& moves, const MeshDistanceOptions& asked,
         std::vector<Open>& memory)
      : a(tree_a), b(tree_b), a_from_b(moves), options(asked), open(memory), motion(a, b, moves) {
    open.clear();
  }

  [[nodiscard]] double meters(float on_scale_of_a) const { return static_cast<double>(on_scale_of_a) / a.scale(); }

  // Pairs that may be nearer than this must be searched [m].
  [[nodiscard]] double worth_m() const {
    const double accurate = found.upper_m - std::max(options.accuracy_m, options.relative_accuracy * found.upper_m);
    return std::min(std::isnan(accurate) ? kInfinity : accurate, options.stop_above_m);
  }
  [[nodiscard]] float worth() const {
    const double scaled = worth_m() * a.scale() * (1.0 + 0x1p-22);
    constexpr float kMost = std::numeric_limits<float>::max();
    return scaled < static_cast<double>(kMost) ? static_cast<float>(scaled) : kMost;
  }
  [[nodiscard]] double lower_m() const {
    const double open_m = open.empty() ? kInfinity : meters(open.front().lower);
    return std::min({found.upper_m, skipped_m, open_m});
  }
  void skip(double nearest_m) { skipped_m = std::min(skipped_m, nearest_m); }

  void push(const Open& pair) {
    if (meters(pair.lower) < worth_m()) {
      open.push_back(pair);
      open.back().number = opened++;
      std::ranges::push_heap(open, Nearer());
    } else {
      skip(meters(pair.lower));
    }
  }

  // Bounds the distance before anything is built: by the boxes of the soups, and by any two corners.
  void bound_by_soups() {
    const TriangleSoup::Face &face_a = a.soup().faces.front(), &face_b = b.soup().faces.front();
    found.pair = {face_a.polygon, face_b.polygon};
    found.on_a = a.soup().vertices[face_a.corners[0]];
    found.on_b = a_from_b(b.soup().vertices[face_b.corners[0]]);
    const double upper_m = length(found.on_b - found.on_a) * (1.0 + 0x1p-50) + 0x1p-530;
    found.upper_m = upper_m < kInfinity ? upper_m : kInfinity;  // places that overflow are no number
    Distances distances;
    distances_of_nodes(a.lone(WideTree::kRoot), 1, b.lone(WideTree::kRoot), 1, motion,
                       std::numeric_limits<float>::max(), distances);
    push({distances.lower[0][0], WideTree::kRoot, WideTree::kRoot, false});
  }

  // Valid before anything else is visited: boxes with a gap don't touch.
  [[nodiscard]] bool may_touch() const { return lower_m() == 0.0; }

  void set_touching(const PolygonPair& pair) {
    const auto [first_a, last_a] = faces_of(a.soup(), pair.a);
    const auto [first_b, last_b] = faces_of(b.soup(), pair.b);
    for (std::uint32_t i = first_a; i < last_a; ++i) {
      for (std::uint32_t j = first_b; j < last_b && found.upper_m > 0.0; ++j) test_triangles(i, j);
    }
    assert(found.upper_m == 0.0);
  }

  void test_triangles(std::uint32_t face_a, std::uint32_t face_b) {
    const Triangle in_b = b.soup().triangle(face_b);
    const TriangleDistance d =
        triangle_distance(a.soup().triangle(face_a), {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])});
    ++found.iterations;
    skip(d.lower);
    if (!(d.upper < found.upper_m)) return;
    found.upper_m = d.upper;
    found.pair = {a.soup().faces[face_a].polygon, b.soup().faces[face_b].polygon};
    found.on_a = d.on_a;
    found.on_b = d.on_b;
    for (int k = 0; k < 3; ++k) {
      toward[static_cast<std::size_t>(k)] = static_cast<float>((d.on_b[k] - d.on_a[k]) * a.scale());
    }
  }

  template <class Then>
  static void for_each_below(const Distances& distances, std::size_t rows, Then then) {
    for (std::size_t j = 0; j < rows; ++j) {
      for (std::uint32_t bits = distances.below[j]; bits != 0; bits &= bits - 1) {
        then(static_cast<std::size_t>(std::countr_zero(bits)), j);
      }
    }
  }
  struct Best {
    std::size_t i = WideTree::kWidth, j = 0;
    float value = kNone;
    [[nodiscard]] bool is(std::size_t of_a, std::size_t of_b) const { return of_a == i && of_b == j; }
  };
  static Best least_below(const Distances& distances, std::size_t rows, const DistanceRows& values) {
    Best best;
    for_each_below(distances, rows, [&](std::size_t i, std::size_t j) {
      if (values[j][i] < best.value) best = {i, j, values[j][i]};
    });
    return best;
  }

  void visit_leaves(const Open& pair, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b) {
    Distances distances;
    DistanceRows estimates;
    distances_of_leaves(leaf_a, leaf_b, motion, toward, worth(), distances, estimates);
    skip(meters(std::max(distances.skipped, pair.lower)));
    Best best = least_below(distances, leaf_b.count, estimates);
    if (meters(best.value) < found.upper_m && found.iterations < options.max_iterations) {
      test_triangles(a.face(leaf_a, best.i), b.face(leaf_b, best.j));
    } else {
      best = {};
    }
    for_each_below(distances, leaf_b.count, [&](std::size_t i, std::size_t j) {
      if (best.is(i, j)) return;
      push({std::max(distances.lower[j][i], pair.lower), a.face(leaf_a, i), b.face(leaf_b, j), true});
    });
  }

  // Goes on with the nearest pair of children, down to triangles: their distance bounds which other pairs are worth
  // opening.
  void visit_nodes(const Open& pair, Ref of_a, Ref of_b) {
    WideTree::Node own_a, own_b;
    const Boxes boxes_a = boxes(a, pair.a, of_a, own_a), boxes_b = boxes(b, pair.b, of_b, own_b);
    Distances distances;
    distances_of_nodes(*boxes_a.node, boxes_a.count, *boxes_b.node, boxes_b.count, motion, worth(), distances);
    skip(meters(std::max(distances.skipped, pair.lower)));
    const Best best = least_below(distances, boxes_b.count, distances.lower);
    if (best.value == kNone) return;
    const bool leaf_a = of_a.kind() == Ref::kLeaf, leaf_b = of_b.kind() == Ref::kLeaf;
    const auto child = [&](std::size_t i, std::size_t j) {
      return Open{std::max(distances.lower[j][i], pair.lower), leaf_a ? pair.a : WideTree::child_slot(of_a, i),
                  leaf_b ? pair.b : WideTree::child_slot(of_b, j), false};
    };
    for_each_below(distances, boxes_b.count, [&](std::size_t i, std::size_t j) {
      if (!best.is(i, j)) push(child(i, j));
    });
    visit(child(best.i, best.j));
  }

  void visit(const Open& pair) {
    if (pair.triangles) return test_triangles(pair.a, pair.b);
    if (found.iterations == options.max_iterations) return push(pair);
    ++found.iterations;
    const Ref of_a = a.at(pair.a), of_b = b.at(pair.b);
    if (of_a.kind() == Ref::kLeaf && of_b.kind() == Ref::kLeaf) {
      visit_leaves(pair, a.leaf(of_a.index()), b.leaf(of_b.index()));
    } else {
      visit_nodes(pair, of_a, of_b);
    }
  }

  [[nodiscard]] bool goes_on() const {
    return !open.empty() && meters(open.front().lower) < worth_m() && found.upper_m > options.stop_below_m &&
           found.iterations < options.max_iterations;
  }
  void run() {
    while (goes_on()) {
      std::ranges::pop_heap(open, Nearer());
      const Open pair = open.back();
      open.pop_back();
      visit(pair);
    }
    found.lower_m = lower_m();
  }
};

MeshDistance MeshDistanceQuery::distance(WideTree& a, WideTree& b, const RelativeMotion& a_from_b,
                                         const MeshDistanceOptions& options) {
  assert(options.accuracy_m >= 0.0 && options.relative_accuracy >= 0.0);
  assert(!a.soup().faces.empty() && !b.soup().faces.empty());
  Search search(a, b, a_from_b, options, open_);
  search.bound_by_soups();
  PolygonPair pair{};
  if (search.may_touch() && overlap_.find_pair(a, b, a_from_b, pair)) search.set_touching(pair);
  search.run();
  assert(search.found.lower_m >= 0.0 && search.found.lower_m <= search.found.upper_m);
  return search.found;
}

}  // namespace peerd::collision
