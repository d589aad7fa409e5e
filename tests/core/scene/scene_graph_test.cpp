#include "core/scene/scene_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <memory>
#include <random>
#include <set>

#include "tests/core/read_text.hpp"

namespace peerd::scene_graph_test {

using testing::ElementsAre;
using testing::IsEmpty;

static_assert(std::ranges::forward_range<SceneGraph::NodeRange>);

TransformFields at_x(double x) { return {.translation = {x, 0, 0}}; }

LocalBox cube(float half) { return {Eigen::Vector3f::Constant(-half), Eigen::Vector3f::Constant(half)}; }

std::vector<NodeHandle> listed(SceneGraph::NodeRange range) {
  std::vector<NodeHandle> out;
  for (const NodeHandle node : range) out.push_back(node);
  return out;
}

std::vector<std::uint64_t> bits(const Affine& m) {
  std::vector<std::uint64_t> out;
  for (int i = 0; i < 9; ++i) out.push_back(std::bit_cast<std::uint64_t>(m.linear.data()[i]));
  for (int i = 0; i < 3; ++i) out.push_back(std::bit_cast<std::uint64_t>(m.offset[i]));
  return out;
}

// Returns how much a call of `work` adds to a counter.
template <class Work>
SceneGraphCounters spent(SceneGraph& graph, Work work) {
  const SceneGraphCounters before = graph.counters();
  work();
  const SceneGraphCounters& now = graph.counters();
  return {now.transforms_set - before.transforms_set, now.poses_updated - before.poses_updated,
          now.nodes_changed - before.nodes_changed, now.boxes_updated - before.boxes_updated,
          now.boxes_merged - before.boxes_merged};
}

// ---- Structure

TEST(SceneGraph, AnEmptyOneHasARootInTheWorldFrame) {
  SceneGraph graph;
  EXPECT_TRUE(graph.alive(graph.root()));
  EXPECT_EQ(graph.size(), 0u);
  EXPECT_FALSE(graph.alive(graph.parent(graph.root())));
  EXPECT_THAT(listed(graph.children(graph.root())), IsEmpty());
  EXPECT_THAT(graph.update(), IsEmpty());
  EXPECT_EQ(bits(graph.world_from_local(graph.root())), bits(Affine{}));
  EXPECT_TRUE(graph.box(graph.root()).is_empty());
  EXPECT_FALSE(graph.alive(NodeHandle{}));
}

TEST(SceneGraph, ChildrenStandWhereTheyWerePut) {
  SceneGraph graph;
  const NodeHandle top = graph.add_group(graph.root());
  const NodeHandle b = graph.add_group(top);
  const NodeHandle d = graph.add_group(top);
  const NodeHandle a = graph.add_group(top, b);
  const NodeHandle c = graph.add_transform(top, at_x(1), d);
  EXPECT_THAT(listed(graph.children(top)), ElementsAre(a, b, c, d));
  ASSERT_TRUE(graph.move(d, top, a));
  EXPECT_THAT(listed(graph.children(top)), ElementsAre(d, a, b, c));
  ASSERT_TRUE(graph.move(a, top, a));  // in front of itself: stays
  EXPECT_THAT(listed(graph.children(top)), ElementsAre(d, a, b, c));
  ASSERT_TRUE(graph.move(a, top));
  EXPECT_THAT(listed(graph.children(top)), ElementsAre(d, b, c, a));
  graph.remove(b);
  EXPECT_THAT(listed(graph.children(top)), ElementsAre(d, c, a));
  graph.remove(a);
  EXPECT_THAT(listed(graph.children(top)), ElementsAre(d, c));
  graph.remove(d);
  EXPECT_THAT(listed(graph.children(top)), ElementsAre(c));
  graph.remove(c);
  EXPECT_THAT(listed(graph.children(top)), IsEmpty());
  EXPECT_EQ(graph.size(), 1u);
}

TEST(SceneGraph, ASubtreeRunsDepthFirst) {
  SceneGraph graph;
  const TransformFields t = at_x(1);
  //  0 ( 1 ( 2 3 ) 4 ) 5
  const std::vector<NodeSpec> specs = {{-1, &t}, {0, nullptr}, {1, &t}, {1, nullptr}, {0, &t}, {-1, nullptr}};
  const auto nodes = graph.add_subtree(graph.root(), specs);
  EXPECT_THAT(listed(graph.subtree(nodes[0])), ElementsAre(nodes[0], nodes[1], nodes[2], nodes[3], nodes[4]));
  EXPECT_THAT(listed(graph.subtree(nodes[1])), ElementsAre(nodes[1], nodes[2], nodes[3]));
  EXPECT_THAT(listed(graph.subtree(nodes[5])), ElementsAre(nodes[5]));
  EXPECT_THAT(listed(graph.children(graph.root())), ElementsAre(nodes[0], nodes[5]));
  // and so does memory
  for (std::size_t i = 1; i < nodes.size(); ++i) EXPECT_EQ(nodes[i].index, nodes[i - 1].index + 1);
}

TEST(SceneGraph, ARemovedSubtreesSlotsAreUsedAgainInTheSameOrder) {
  SceneGraph graph;
  const std::vector<NodeSpec> specs = {{}, {0, nullptr}, {1, nullptr}, {0, nullptr}};
  const auto old = graph.add_subtree(graph.root(), specs);
  graph.remove(old[0]);
  for (const NodeHandle node : old) EXPECT_FALSE(graph.alive(node));
  const auto again = graph.add_subtree(graph.root(), specs);
  for (std::size_t i = 0; i < old.size(); ++i) {
    EXPECT_EQ(again[i].index, old[i].index);
    EXPECT_NE(again[i].generation, old[i].generation);
    EXPECT_TRUE(graph.alive(again[i]));
    EXPECT_FALSE(graph.alive(old[i]));
  }
}

TEST(SceneGraph, ANodeIsNotMovedBelowItself) {
  SceneGraph graph;
  const NodeHandle a = graph.add_group(graph.root());
  const NodeHandle b = graph.add_group(a);
  const NodeHandle c = graph.add_group(b);
  graph.update();
  EXPECT_FALSE(graph.move(a, c));
  EXPECT_FALSE(graph.move(a, b));
  EXPECT_FALSE(graph.move(a, a));
  EXPECT_TRUE(graph.up_to_date());
  EXPECT_EQ(graph.parent(b), a);
  EXPECT_TRUE(graph.move(c, a));
  EXPECT_TRUE(graph.move(b, c));
  EXPECT_FALSE(graph.move(c, b));
  EXPECT_THAT(listed(graph.subtree(a)), ElementsAre(a, c, b));
}

TEST(SceneGraphDeathTest, AStaleHandleIsABug) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  SceneGraph graph;
  const NodeHandle node = graph.add_transform(graph.root(), {});
  const NodeHandle group = graph.add_group(graph.root());
  EXPECT_DEATH(graph.set_translation(group, Vec3::Zero()), "has_transform");
  graph.remove(node);
  const NodeHandle heir = graph.add_transform(graph.root(), {});
  ASSERT_EQ(heir.index, node.index);
  EXPECT_DEATH(graph.set_translation(node, Vec3::Zero()), "alive");
  EXPECT_DEATH((void)graph.box(heir), "up_to_date");
}

// ---- Poses

TEST(SceneGraphPoses, AreTheScenesBits) {
  const Scene scene = scene_of(R"(
    DEF A Transform { translation 1.1 2.2 -0.3 rotation 1 2 3 0.7 children [
      Shape { }
      Group { children [ DEF B Transform { scale 2 3 0.5 scaleOrientation 1 0 1 0.4 center 0.1 -0.2 5 rotation 0 1 0 2
        children [ Group { } DEF C Transform { translation -7 0 1e6 center 1 1 1 children Shape { } } ] } ] }
    ] }
    Transform { translation -0.0 0 -0.0 children Transform { rotation 0 0 1 -3 scale 1 1 -1 } }
    Group { children Shape { } })");
  std::vector<NodeSpec> specs;
  for (const Instance& instance : scene.instances) {
    const bool transform = instance.transform != Instance::kNone;
    specs.push_back({instance.parent, transform ? &scene.transforms[instance.transform] : nullptr});
  }
  SceneGraph graph;
  const auto nodes = graph.add_subtree(graph.root(), specs);
  EXPECT_EQ(graph.update().size(), nodes.size());
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const Eigen::Affine3d expected = scene.world_from_local(ObjectId{i});
    EXPECT_EQ(bits(graph.world_from_local(nodes[i])), bits({expected.linear(), expected.translation()})) << i;
  }
}

TEST(SceneGraphPoses, FieldsComeBackAsTheyWereSet) {
  SceneGraph graph;
  TransformFields t = at_x(-0.0);
  t.scale = {1, -2, 3};
  t.center = {-0.0, 0, 0};
  t.rotation = quat_exp({1, 2, 3});
  t.scale_orientation = quat_exp({0, 0.5, 0});
  const auto expect_same = [](const TransformFields& a, const TransformFields& b) {
    EXPECT_EQ(a.translation, b.translation);
    EXPECT_EQ(std::signbit(a.center[0]), std::signbit(b.center[0]));
    EXPECT_EQ(a.center, b.center);
    EXPECT_EQ(a.scale, b.scale);
    EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
    EXPECT_EQ(a.scale_orientation.coeffs(), b.scale_orientation.coeffs());
  };
  const NodeHandle node = graph.add_transform(graph.root(), t);
  expect_same(graph.local(node), t);
  t.translation = {4, 5, 6};
  graph.set_translation(node, t.translation);
  expect_same(graph.local(node), t);
  t.rotation = Quat::Identity();
  graph.set_rotation(node, t.rotation);
  expect_same(graph.local(node), t);
  for (const TransformFields& other : {TransformFields{}, t, at_x(2)}) {
    graph.set_local(node, other);
    expect_same(graph.local(node), other);
  }
}

TEST(SceneGraphPoses, AreThoseOfTheLastUpdate) {
  SceneGraph graph;
  const NodeHandle a = graph.add_transform(graph.root(), at_x(1));
  graph.update();
  graph.set_translation(a, {2, 0, 0});
  EXPECT_EQ(graph.world_from_local(a).offset, Vec3(1, 0, 0));
  graph.update();
  EXPECT_EQ(graph.world_from_local(a).offset, Vec3(2, 0, 0));
}

TEST(SceneGraphPoses, ANodeWithoutTransformFollowsWhateverItHangsFrom) {
  SceneGraph graph;
  const NodeHandle a = graph.add_transform(graph.root(), at_x(1));
  const NodeHandle b = graph.add_transform(graph.root(), at_x(10));
  const NodeHandle group = graph.add_group(a);
  const NodeHandle shape = graph.add_group(group);
  const NodeHandle part = graph.add_transform(group, at_x(100));
  graph.update();
  EXPECT_EQ(graph.world_from_local(shape).offset, Vec3(1, 0, 0));
  ASSERT_TRUE(graph.move(group, b));
  graph.remove(a);
  EXPECT_THAT(graph.update(), ElementsAre(group, shape, part));
  EXPECT_EQ(graph.world_from_local(shape).offset, Vec3(10, 0, 0));
  EXPECT_EQ(graph.world_from_local(part).offset, Vec3(110, 0, 0));
  ASSERT_TRUE(graph.move(group, graph.root()));
  graph.update();
  EXPECT_EQ(graph.world_from_local(shape).offset, Vec3(0, 0, 0));
}

TEST(SceneGraphPoses, ManyMovesAreAsOneAfterTheOther) {
  SceneGraph one_by_one;
  std::vector<RigidMove> moves;
  NodeHandle parent = one_by_one.root();
  for (int i = 0; i < 300; ++i) {
    const NodeHandle node = one_by_one.add_transform(parent, at_x(i));
    one_by_one.set_local_box(one_by_one.add_group(node), cube(1));
    if (i % 10 == 0) parent = node;
    moves.push_back({node, {1, double(i), 2}, quat_exp({0, 0.01 * i, 1})});
  }
  moves.push_back({moves[7].node, {5, 5, 5}, Quat::Identity()});  // the later one counts
  one_by_one.update();
  (void)one_by_one.box(one_by_one.root());
  SceneGraph at_once = one_by_one;
  for (const RigidMove& move : moves) one_by_one.set_rigid(move.node, move.translation_m, move.rotation);
  at_once.set_rigid(moves);
  one_by_one.update();
  at_once.update();
  EXPECT_EQ(at_once.counters().transforms_set, one_by_one.counters().transforms_set);
  for (const NodeHandle node : one_by_one.subtree(one_by_one.root())) {
    EXPECT_EQ(bits(at_once.world_from_local(node)), bits(one_by_one.world_from_local(node)));
    EXPECT_EQ(at_once.box(node), one_by_one.box(node));
  }
}

// ---- Work

TEST(SceneGraphCounters, OnlyWhatIsBelowAChangeIsUpdatedAndOnlyOnce) {
  SceneGraph graph;
  const TransformFields t = at_x(1);
  //  0 ( 1 ( 2 ( 3 ) ) 4 )  5 ( 6 )
  const std::vector<NodeSpec> specs = {{-1, &t}, {0, &t}, {1, &t}, {2, nullptr}, {0, &t}, {-1, &t}, {5, &t}};
  const auto n = graph.add_subtree(graph.root(), specs);
  EXPECT_EQ(spent(graph, [&] { graph.update(); }).poses_updated, 6u);
  EXPECT_EQ(spent(graph, [&] { graph.update(); }).nodes_changed, 0u);

  graph.set_translation(n[2], {3, 0, 0});  // the deeper ones first
  graph.set_translation(n[1], {2, 0, 0});
  graph.set_translation(n[1], {2.5, 0, 0});
  graph.set_translation(n[6], {2, 0, 0});
  const SceneGraphCounters work = spent(graph, [&] { graph.update(); });
  EXPECT_EQ(graph.counters().transforms_set, 4u);
  EXPECT_EQ(work.poses_updated, 3u);
  EXPECT_EQ(work.nodes_changed, 4u);
  EXPECT_THAT(graph.changed(), ElementsAre(n[1], n[2], n[3], n[6]));
  EXPECT_EQ(graph.world_from_local(n[3]).offset, Vec3(6.5, 0, 0));
  graph.update();
  EXPECT_THAT(graph.changed(), IsEmpty());
}

TEST(SceneGraphCounters, NoBoxIsTouchedWhereNobodyAsks) {
  SceneGraph graph;
  std::vector<NodeHandle> nodes;
  for (int i = 0; i < 100; ++i) {
    nodes.push_back(graph.add_transform(graph.root(), at_x(i)));
    graph.set_local_box(graph.add_group(nodes.back()), cube(1));
  }
  for (int tick = 0; tick < 10; ++tick) {
    for (const NodeHandle node : nodes) graph.set_translation(node, {double(tick), 0, 0});
    graph.update();
  }
  graph.remove(nodes[3]);
  EXPECT_TRUE(graph.move(nodes[4], nodes[5]));
  graph.update();
  EXPECT_EQ(graph.counters().boxes_updated, 0u);
  EXPECT_EQ(graph.counters().boxes_merged, 0u);
}

// The box of one subtree is asked for; the others still cost nothing.
TEST(SceneGraphCounters, OnlyBoxesOfAskedSubtreesAreKept) {
  SceneGraph graph;
  std::vector<NodeHandle> nodes;
  for (int i = 0; i < 100; ++i) {
    nodes.push_back(graph.add_transform(graph.root(), at_x(i)));
    graph.set_local_box(nodes.back(), cube(1));
  }
  graph.update();
  EXPECT_EQ(spent(graph, [&] { (void)graph.box(nodes[7]); }).boxes_updated, 1u);
  for (const NodeHandle node : nodes) graph.set_translation(node, {0, 1, 0});
  EXPECT_EQ(spent(graph, [&] { graph.update(); }).boxes_updated, 0u);
  EXPECT_EQ(spent(graph, [&] { (void)graph.box(nodes[7]); }).boxes_updated, 1u);
  EXPECT_EQ(spent(graph, [&] { (void)graph.box(nodes[7]); }).boxes_updated, 0u);
}

TEST(SceneGraphCounters, MoversAmongManySiblingsCostNoSibling) {
  constexpr int kSiblings = 100'000, kMovers = 100;
  SceneGraph graph;
  std::vector<NodeHandle> nodes;
  for (int i = 0; i < kSiblings; ++i) {
    nodes.push_back(graph.add_transform(graph.root(), at_x(i)));
    graph.set_local_box(nodes.back(), cube(1));
  }
  graph.update();
  (void)graph.box(graph.root());
  std::vector<NodeHandle> movers;
  for (int i = 0; i < kMovers; ++i) movers.push_back(nodes[static_cast<std::size_t>(500 + i * 997)]);
  for (int tick = 1; tick < 10; ++tick) {
    for (const NodeHandle node : movers) graph.set_translation(node, graph.local(node).translation + Vec3(2, 0, 0));
    const SceneGraphCounters work = spent(graph, [&] {
      graph.update();
      for (const NodeHandle node : movers) (void)graph.box(node);
      (void)graph.box(graph.root());
    });
    EXPECT_EQ(work.poses_updated, 100u);
    EXPECT_EQ(work.boxes_updated, 100u);
    EXPECT_EQ(work.boxes_merged, 100u);
  }
  const auto cost_of_asking_all = [&] {
    graph.update();
    return spent(graph, [&] { (void)graph.box(graph.root()); }).boxes_merged;
  };
  // One node takes off from the floor that they all stand on: any other shows where that is.
  graph.set_translation(movers[0], {1000, 1000, 0});
  EXPECT_LE(cost_of_asking_all(), 2u);
  EXPECT_GT(graph.box(graph.root()).hi[1], 1000);
  graph.set_translation(movers[0], {1000, 2000, 0});
  EXPECT_LE(cost_of_asking_all(), 2u);
  // The node comes down: the scene must compare all of them to find the highest now.
  graph.set_translation(movers[0], {1000, 0, 0});
  graph.update();
  EXPECT_LE(spent(graph, [&] { (void)graph.box(movers[0]); }).boxes_merged, 1u);
  EXPECT_EQ(cost_of_asking_all(), 1u * kSiblings);
  EXPECT_LT(graph.box(graph.root()).hi[1], 1.1);
  EXPECT_EQ(cost_of_asking_all(), 0u);
}

TEST(SceneGraphCopies, GoTheirOwnWays) {
  SceneGraph graph;
  const NodeHandle a = graph.add_transform(graph.root(), at_x(1));
  graph.set_local_box(a, cube(1));
  graph.update();
  SceneGraph copy = graph;
  (void)copy.box(a);
  copy.set_translation(a, {5, 0, 0});
  copy.update();
  EXPECT_EQ(graph.world_from_local(a).offset, Vec3(1, 0, 0));
  EXPECT_EQ(copy.world_from_local(a).offset, Vec3(5, 0, 0));
  graph.remove(a);
  EXPECT_TRUE(copy.alive(a));
  EXPECT_GT(copy.box(copy.root()).hi[0], 5);
}

// ---- Boxes

// The numbers are whole numbers and fractions of them, which need no rounding.
using Exact = boost::multiprecision::cpp_rational;

TEST(TransformedBox, HoldsEveryExactlyTransformedCornerAndIsTight) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto anything = [&] { return std::ldexp(unit(random), static_cast<int>(random() % 60) - 30); };
  for (int round = 0; round < 1'000; ++round) {
    Affine m;
    for (int i = 0; i < 9; ++i) m.linear.data()[i] = anything();
    for (int i = 0; i < 3; ++i) m.offset[i] = anything();
    LocalBox box;
    for (int i = 0; i < 3; ++i) {
      box.merge(Eigen::Vector3f(float(anything()), float(anything()), float(anything())));
    }
    const WorldBox world = transformed(m, box);
    std::array<Exact, 3> lo, hi;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) p[i] = ((corner >> i) & 1) != 0 ? box.hi[i] : box.lo[i];
      ASSERT_TRUE(world.contains(Vec3(multiply(m.linear, p) + m.offset)));
      for (int i = 0; i < 3; ++i) {
        Exact sum = m.offset[i];
        for (int j = 0; j < 3; ++j) sum += Exact(m.linear(i, j)) * Exact(p[j]);
        ASSERT_TRUE(Exact(world.lo[i]) <= sum && sum <= Exact(world.hi[i]));
        Exact& least = lo[static_cast<std::size_t>(i)];
        Exact& most = hi[static_cast<std::size_t>(i)];
        if (corner == 0 || sum < least) least = sum;
        if (corner == 0 || sum > most) most = sum;
      }
    }
    const Eigen::Vector3f farthest = box.lo.cwiseAbs().cwiseMax(box.hi.cwiseAbs());
    for (int i = 0; i < 3; ++i) {
      Exact size = std::abs(m.offset[i]);
      for (int j = 0; j < 3; ++j) size += Exact(std::abs(m.linear(i, j))) * Exact(farthest[j]);
      const Exact allowed = size * Exact(0x1p-49);
      ASSERT_TRUE(lo[static_cast<std::size_t>(i)] - Exact(world.lo[i]) <= allowed);
      ASSERT_TRUE(Exact(world.hi[i]) - hi[static_cast<std::size_t>(i)] <= allowed);
    }
  }
}

TEST(TransformedBox, AtItsLimits) {
  EXPECT_TRUE(transformed({}, {}).is_empty());
  Affine huge;
  huge.linear(0, 0) = 1e300;
  huge.linear(1, 1) = std::numeric_limits<double>::infinity();
  const WorldBox world = transformed(huge, cube(1e10f));
  EXPECT_EQ(world.lo[0], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(world.hi[1], std::numeric_limits<double>::infinity());
  EXPECT_GT(world.lo[2], -1.1e10);
  Affine tiny;
  tiny.linear *= 1e-320;
  tiny.offset = {0, 1, 0};
  EXPECT_TRUE(transformed(tiny, cube(1e-30f)).contains(Vec3(0, 1, 0)));
}

// ---- The graph is compared with a twin that keeps nothing but parents, fields and boxes, and makes all anew for each
// question.

struct Twin {
  struct Node {
    Node* parent = nullptr;
    std::vector<std::unique_ptr<Node>> children;
    std::optional<TransformFields> fields;
    LocalBox box;
    NodeHandle handle;
  };
  Node root;

  static std::size_t place_of(const Node& node) {
    const auto& all = node.parent->children;
    return static_cast<std::size_t>(std::ranges::find_if(all, [&](const auto& child) { return child.get() == &node; }) -
                                    all.begin());
  }
  static std::unique_ptr<Node> cut(Node& node) {
    const std::size_t i = place_of(node);
    auto out = std::move(node.parent->children[i]);
    node.parent->children.erase(node.parent->children.begin() + static_cast<std::ptrdiff_t>(i));
    return out;
  }
  static Node& put(std::unique_ptr<Node> node, Node& parent, std::size_t place) {
    node->parent = &parent;
    return **parent.children.insert(parent.children.begin() + static_cast<std::ptrdiff_t>(place), std::move(node));
  }
  static bool is_below(const Node* node, const Node& above) {
    for (; node != nullptr; node = node->parent) {
      if (node == &above) return true;
    }
    return false;
  }
  static Affine world_from_local(const Node& node) {
    std::vector<const Node*> path;
    for (const Node* n = &node; n != nullptr; n = n->parent) path.insert(path.begin(), n);
    Affine out;
    for (const Node* n : path) {
      if (n->fields) out = multiply(out, parent_from_local(*n->fields));
    }
    return out;
  }
  static void all_below(Node& node, std::vector<Node*>& out) {
    out.push_back(&node);
    for (const auto& child : node.children) all_below(*child, out);
  }
  static std::vector<Node*> all_below(Node& node) {
    std::vector<Node*> out;
    all_below(node, out);
    return out;
  }
  static WorldBox box(Node& node) {
    WorldBox out;
    for (const Node* n : all_below(node)) {
      const WorldBox own = transformed(world_from_local(*n), n->box);
      out.lo = out.lo.cwiseMin(own.lo);
      out.hi = out.hi.cwiseMax(own.hi);
    }
    return out;
  }
};

class SceneGraphEdits : public testing::TestWithParam<std::uint64_t> {
 protected:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  double some() { return std::uniform_real_distribution<double>(-10, 10)(random_); }
  Vec3 some_vec() { return {some(), some(), some()}; }
  Quat some_turn() { return quat_exp(some_vec() / 5); }
  TransformFields some_fields() {
    TransformFields t;
    // There are few different places, so that many boxes share their sides.
    t.translation = below(2) ? some_vec() : Vec3(double(below(3)), double(below(3)), double(below(3)));
    if (below(2)) t.rotation = some_turn();
    if (below(4) == 0) t.scale = some_vec() / 8;
    if (below(4) == 0) t.scale_orientation = some_turn();
    if (below(4) == 0) t.center = some_vec();
    return t;
  }
  LocalBox some_box() {
    if (below(4) == 0) return {};
    if (below(2)) return cube(float(1 + below(2)));
    LocalBox box;
    for (int i = 0; i < 2; ++i) box.merge(Eigen::Vector3f(some_vec().cast<float>()));
    return box;
  }
  Twin::Node& pick() {
    const auto all = Twin::all_below(twin_.root);
    return *all[below(all.size())];
  }
  NodeHandle handle_before(const Twin::Node& parent, std::size_t place) {
    return place < parent.children.size() ? parent.children[place]->handle : NodeHandle{};
  }

  void add() {
    std::vector<NodeSpec> specs(1 + below(6));
    std::vector<std::unique_ptr<TransformFields>> fields;
    Twin::Node& parent = pick();
    std::size_t place = below(parent.children.size() + 1);
    const NodeHandle before = handle_before(parent, place);
    std::vector<Twin::Node*> made;
    for (std::size_t i = 0; i < specs.size(); ++i) {
      specs[i].parent = static_cast<std::int32_t>(below(i + 1)) - 1;
      auto node = std::make_unique<Twin::Node>();
      if (below(3) != 0) {
        node->fields = some_fields();
        fields.push_back(std::make_unique<TransformFields>(*node->fields));
        specs[i].transform = fields.back().get();
      }
      if (specs[i].parent < 0) {
        made.push_back(&Twin::put(std::move(node), parent, place++));
      } else {
        Twin::Node& above = *made[static_cast<std::size_t>(specs[i].parent)];
        made.push_back(&Twin::put(std::move(node), above, above.children.size()));
      }
    }
    const auto handles = graph_.add_subtree(parent.handle, specs, before);
    for (std::size_t i = 0; i < made.size(); ++i) {
      made[i]->handle = handles[i];
      if (below(2)) set_box(*made[i]);
      expected_changes_.insert(handles[i]);
    }
  }
  void set_box(Twin::Node& node) { graph_.set_local_box(node.handle, node.box = some_box()); }
  void remove(Twin::Node& node) {
    for (const Twin::Node* n : Twin::all_below(node)) {
      gone_.push_back(n->handle);
      expected_changes_.erase(n->handle);
    }
    graph_.remove(node.handle);
    Twin::cut(node);
  }
  void move(Twin::Node& node) {
    Twin::Node& parent = pick();
    if (Twin::is_below(&parent, node)) {
      EXPECT_FALSE(graph_.move(node.handle, parent.handle));
      return;
    }
    std::unique_ptr<Twin::Node> loose = Twin::cut(node);
    const std::size_t place = below(parent.children.size() + 1);
    EXPECT_TRUE(graph_.move(loose->handle, parent.handle, handle_before(parent, place)));
    expect_changed(Twin::put(std::move(loose), parent, place));
  }
  void set(Twin::Node& node) {
    if (!node.fields) return;
    const TransformFields t = some_fields();
    switch (below(4)) {
      case 0:
        graph_.set_local(node.handle, *(node.fields = t));
        break;
      case 1:
        graph_.set_translation(node.handle, node.fields->translation = t.translation);
        break;
      case 2:
        graph_.set_rotation(node.handle, node.fields->rotation = t.rotation);
        break;
      case 3: {
        node.fields->translation = t.translation;
        node.fields->rotation = t.rotation;
        if (below(2)) {
          graph_.set_rigid(node.handle, t.translation, t.rotation);
        } else {
          const RigidMove one{node.handle, t.translation, t.rotation};
          graph_.set_rigid({&one, 1});
        }
        break;
      }
    }
    expect_changed(node);
  }
  void expect_changed(Twin::Node& node) {
    for (const Twin::Node* n : Twin::all_below(node)) expected_changes_.insert(n->handle);
  }

  void edit() {
    Twin::Node& node = pick();
    const bool root = &node == &twin_.root;
    switch (below(12)) {
      case 0:
        return add();
      case 1:
        if (!root && (below(3) == 0 || graph_.size() > 60)) remove(node);
        return;
      case 2:
      case 3:
        if (!root) move(node);
        return;
      case 4:
        return set_box(node);
      default:
        return set(node);
    }
  }

  void update() {
    const auto changed = graph_.update();
    std::set<NodeHandle> reported;
    for (const NodeHandle node : changed) {
      EXPECT_TRUE(reported.insert(node).second) << "twice";
    }
    EXPECT_EQ(reported, expected_changes_);
    expected_changes_.clear();
  }

  void check_all() {
    const auto all = Twin::all_below(twin_.root);
    ASSERT_EQ(graph_.size() + 1, all.size());
    std::vector<NodeHandle> handles;
    for (const Twin::Node* n : all) handles.push_back(n->handle);
    ASSERT_EQ(listed(graph_.subtree(graph_.root())), handles);
    for (const Twin::Node* n : all) {
      ASSERT_TRUE(graph_.alive(n->handle));
      ASSERT_EQ(graph_.has_transform(n->handle), n->fields.has_value());
      ASSERT_EQ(graph_.parent(n->handle), n->parent == nullptr ? NodeHandle{} : n->parent->handle);
      std::vector<NodeHandle> children;
      for (const auto& child : n->children) children.push_back(child->handle);
      ASSERT_EQ(listed(graph_.children(n->handle)), children);
      ASSERT_EQ(bits(graph_.world_from_local(n->handle)), bits(Twin::world_from_local(*n)));
    }
    for (const NodeHandle node : gone_) ASSERT_FALSE(graph_.alive(node));
  }

  std::mt19937_64 random_{GetParam()};
  SceneGraph graph_;
  Twin twin_;
  std::set<NodeHandle> expected_changes_;
  std::vector<NodeHandle> gone_;
};

TEST_P(SceneGraphEdits, AgreeWithATwinThatMakesAllAnew) {
  SCOPED_TRACE(testing::Message() << "seed " << GetParam());
  twin_.root.handle = graph_.root();
  const std::size_t boxes_asked = below(4);  // how often
  for (int round = 0; round < 400 && !HasFatalFailure() && !HasFailure(); ++round) {
    for (std::size_t edits = below(8); edits > 0; --edits) edit();
    update();
    if (round % 8 == 0) check_all();
    for (std::size_t n = below(4) * boxes_asked; n > 0; --n) {
      Twin::Node& node = pick();
      ASSERT_EQ(graph_.box(node.handle), Twin::box(node)) << "round " << round;
    }
    if (below(16) == 0) {  // a copy takes over; the original is forgotten
      SceneGraph copy = graph_;
      graph_ = SceneGraph();
      graph_ = std::move(copy);
    }
  }
  check_all();
  for (Twin::Node* node : Twin::all_below(twin_.root)) ASSERT_EQ(graph_.box(node->handle), Twin::box(*node));
}
INSTANTIATE_TEST_SUITE_P(Seeds, SceneGraphEdits, testing::Range<std::uint64_t>(1, 61));

// ---- Size

TEST(SceneGraphSize, AMillionNodesFit) {
  constexpr std::size_t kNodes = 1'000'000;
  const TransformFields t = at_x(1);
  std::vector<NodeSpec> specs;  // 250,000 of Transform ( Group ( Transform Shape ) )
  for (std::int32_t i = 0; i < std::int32_t{kNodes}; i += 4) {
    specs.insert(specs.end(), {{-1, &t}, {i, nullptr}, {i + 1, &t}, {i + 1, nullptr}});
  }
  SceneGraph graph;
  const auto nodes = graph.add_subtree(graph.root(), specs);
  EXPECT_EQ(graph.update().size(), kNodes);
  EXPECT_EQ(graph.world_from_local(nodes.back()).offset, Vec3(1, 0, 0));
  EXPECT_LT(graph.memory_bytes(), 160 * kNodes);
  RecordProperty("bytes_per_node", static_cast<int>(graph.memory_bytes() / kNodes));
  const auto capacity = graph.memory_bytes();
  for (std::size_t i = 0; i < kNodes; i += 4) graph.remove(nodes[i]);
  EXPECT_EQ(graph.size(), 0u);
  EXPECT_FALSE(graph.alive(nodes[123'456]));
  const auto again = graph.add_subtree(graph.root(), specs);
  EXPECT_EQ(graph.update().size(), kNodes);
  EXPECT_LT(graph.memory_bytes(), capacity + 16 * kNodes);  // slots were used again
  EXPECT_FALSE(graph.alive(nodes[123'456]));
}

TEST(SceneGraphSize, AChainOfAMillionNodesNeedsNoStack) {
  constexpr std::int32_t kNodes = 1'000'000;
  const TransformFields t = at_x(1);
  std::vector<NodeSpec> specs;
  for (std::int32_t i = 0; i < kNodes; ++i) specs.push_back({i - 1, &t});
  SceneGraph graph;
  const auto nodes = graph.add_subtree(graph.root(), specs);
  graph.set_local_box(nodes.back(), cube(1));
  graph.update();
  EXPECT_EQ(graph.world_from_local(nodes.back()).offset, Vec3(kNodes, 0, 0));
  EXPECT_GT(graph.box(nodes.front()).hi[0], kNodes);
  EXPECT_FALSE(graph.move(nodes.front(), nodes.back()));
  graph.set_translation(nodes[kNodes - 2], {2, 0, 0});
  EXPECT_EQ(graph.update().size(), 2u);
  EXPECT_GT(graph.box(nodes.front()).hi[0], kNodes + 1);
  graph.remove(nodes.front());
  EXPECT_EQ(graph.size(), 0u);
}

// Edits whose results nobody collects do not pile up.
TEST(SceneGraphSize, ListsOfWorkToDoAreBounded) {
  SceneGraph graph;
  const NodeHandle top = graph.add_group(graph.root());
  graph.update();
  (void)graph.box(graph.root());
  const auto come_and_go = [&](int times) {
    for (int i = 0; i < times; ++i) {
      const NodeHandle node = graph.add_transform(top, at_x(i));
      graph.set_local_box(node, cube(1));
      if (i % 3 == 0) graph.update();
      graph.remove(node);
    }
  };
  come_and_go(10);
  const std::size_t bytes = graph.memory_bytes();
  come_and_go(10'000);
  EXPECT_EQ(graph.memory_bytes(), bytes);
}

}  // namespace peerd::scene_graph_test
