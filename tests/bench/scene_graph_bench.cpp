// Question: does a tick cost what moves, whatever the scene holds? 100 of 1,000 transforms against 100 of 100,000.
//
// Movers are drawn at random, so they lie scattered in memory. `fresh` movers are others each tick until all had their
// turn: the small scene then stays in the nearest cache and the large one never is, the worst that can happen. `same`
// movers are the same each tick, as objects in motion mostly are. `cold` flushes the caches by reading 64 MB between
// ticks, as the rest of a busy program does, and is not timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <numeric>
#include <random>
#include <string>

#include "core/scene/scene_graph.hpp"

namespace peerd {
namespace {

constexpr std::size_t kMovers = 100;
constexpr std::int32_t kChain = 256;  // nodes deep
constexpr std::int32_t kFanOut = 10;  // of the balanced layout

enum Layout : std::int64_t {
  kFlat,      // transforms under the root
  kShapes,    // the same with a shape under each
  kBalanced,  // kFanOut under each; those without children move
  kDeep,      // 1,000 each: a chain of kChain - 1, and all others under its end; those move
  kChains,    // chains of kChain; the last 64 of each move, so ticks differ in poses: see ratio_pose
};
enum Movers : std::int64_t { kFresh, kSame, kCold };

struct World {
  SceneGraph graph;
  std::vector<NodeHandle> nodes;               // all
  std::vector<std::vector<NodeHandle>> ticks;  // who moves
  std::vector<RigidMove> moves;                // of this tick
  std::size_t tick = 0;
};

World make_world(std::int64_t layout, std::int64_t transforms, bool same_movers) {
  std::mt19937_64 random(42);
  std::uniform_real_distribution<double> place(-1000, 1000);
  std::vector<TransformFields> fields(static_cast<std::size_t>(transforms));
  std::vector<NodeSpec> specs;
  std::vector<std::size_t> may_move;
  const auto add = [&](std::int32_t parent, std::int32_t t, bool moves) {
    fields[std::size_t(t)].translation = {place(random), place(random), place(random)};
    fields[std::size_t(t)].rotation = quat_exp({0.1, 0.001 * t, 0});
    if (moves) may_move.push_back(specs.size());
    specs.push_back({parent, &fields[std::size_t(t)]});
  };
  const auto n = static_cast<std::int32_t>(transforms);
  if (layout == kBalanced) {
    // Depth first: a node and then its subtrees, each of a tenth of what remains.
    const auto grow = [&](auto& self, std::int32_t parent, std::int32_t begin, std::int32_t end) -> void {
      if (begin == end) return;
      const auto me = static_cast<std::int32_t>(specs.size());
      add(parent, begin, end - begin == 1);
      const std::int32_t below = end - begin - 1;
      for (std::int32_t i = 0; i < kFanOut; ++i) {
        self(self, me, begin + 1 + below * i / kFanOut, begin + 1 + below * (i + 1) / kFanOut);
      }
    };
    grow(grow, -1, 0, n);
  } else {
    std::int32_t end_of_chain = -1;
    for (std::int32_t t = 0; t < n; ++t) {
      const auto me = static_cast<std::int32_t>(specs.size());
      const std::int32_t in_chain = layout == kChains ? t % kChain : layout == kDeep ? t % 1'000 : 0;
      const bool in_crowd = layout == kDeep && in_chain >= kChain - 1;
      add(in_chain == 0 ? -1 : end_of_chain, t,
          layout == kChains ? in_chain >= kChain - 64 : layout != kDeep || in_crowd);
      if (!in_crowd) end_of_chain = me;
      if (layout == kShapes) specs.push_back({me, nullptr});
    }
  }
  World world;
  world.nodes = world.graph.add_subtree(world.graph.root(), specs);
  world.graph.update();
  const auto leaf = [&](NodeHandle node) { return !world.graph.alive(world.graph.first_child(node)); };
  for (const NodeHandle node : world.nodes) {
    if (leaf(node)) {
      world.graph.set_local_box(node, {Eigen::Vector3f::Constant(-1), Eigen::Vector3f::Constant(1)});
    }
  }
  // All that may move, shuffled, again and again until the last tick is full.
  std::size_t next = may_move.size();
  const std::size_t ticks = same_movers ? 1 : std::max<std::size_t>(1, may_move.size() / kMovers);
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    auto& movers = world.ticks.emplace_back();
    for (std::size_t i = 0; i < kMovers; ++i) {
      if (next == may_move.size()) {
        std::ranges::shuffle(may_move, random);
        next = 0;
      }
      movers.push_back(world.nodes[may_move[next++]]);
    }
  }
  return world;
}

// Moves, updates, and checks the changes as a caller would.
double one_tick(World& world, bool boxes) {
  SceneGraph& graph = world.graph;
  const double step = 1e-3 * static_cast<double>(++world.tick);
  world.moves.clear();
  for (const NodeHandle node : world.ticks[world.tick % world.ticks.size()]) {
    world.moves.push_back({node, Vec3(step, 1, 2), Quat(0.6, 0.8, 0, 0)});
  }
  graph.set_rigid(world.moves);
  double sum = 0;
  for (const NodeHandle node : graph.update()) {
    sum += boxes ? graph.box(node).lo[0] : graph.world_from_local(node).offset[0];
  }
  return sum;
}

// The poses of the last movers and of everything in small scenes, by their paths; nothing of the graph's own
// arithmetic.
bool is_right(const World& world) {
  const auto right = [&](NodeHandle node) {
    std::vector<NodeHandle> path;
    for (NodeHandle n = node; world.graph.alive(n); n = world.graph.parent(n)) path.push_back(n);
    Affine expected;
    for (auto n = path.rbegin(); n != path.rend(); ++n) {
      if (world.graph.has_transform(*n)) expected = multiply(expected, parent_from_local(world.graph.local(*n)));
    }
    const Affine& actual = world.graph.world_from_local(node);
    return std::memcmp(&expected, &actual, sizeof(Affine)) == 0;
  };
  return std::ranges::all_of(world.ticks[world.tick % world.ticks.size()], right) &&
         (world.nodes.size() > 10'000 || std::ranges::all_of(world.nodes, right));
}

// Evicts the present data from the caches.
void flush_caches() {
  static std::vector<std::uint64_t> junk(8 << 20, 1);
  benchmark::DoNotOptimize(std::accumulate(junk.begin(), junk.end(), std::uint64_t{0}));
}

double seconds_of_tick(World& world, bool boxes) {
  const auto begin = std::chrono::steady_clock::now();
  benchmark::DoNotOptimize(one_tick(world, boxes));
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double>& values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

double poses_per_tick(const World& world, const SceneGraphCounters& before, std::size_t ticks) {
  return static_cast<double>(world.graph.counters().poses_updated - before.poses_updated) / static_cast<double>(ticks);
}

// Both scenes side by side, in turns of 16 ticks; `ratio` is of the medians, per tick, and `ratio_pose` per pose made.
void BM_LargeAgainstSmall(benchmark::State& state) {
  const bool boxes = state.range(2) != 0, cold = state.range(1) == kCold;
  World small = make_world(state.range(0), 1'000, state.range(1) != kFresh);
  World large = make_world(state.range(0), 100'000, state.range(1) != kFresh);
  std::vector<double> small_s, large_s;
  if (boxes) {  // ask once for all: everything has a box from now on
    benchmark::DoNotOptimize(small.graph.box(small.graph.root()));
    benchmark::DoNotOptimize(large.graph.box(large.graph.root()));
  }
  const SceneGraphCounters small_before = small.graph.counters(), large_before = large.graph.counters();
  for (auto _ : state) {
    for (auto [world, times] : {std::pair(&small, &small_s), std::pair(&large, &large_s)}) {
      for (int i = 0; i < 16; ++i) {
        if (cold) flush_caches();
        times->push_back(seconds_of_tick(*world, boxes));
      }
    }
  }
  if (!is_right(small) || !is_right(large)) state.SkipWithError("wrong answer");
  const double small_poses = poses_per_tick(small, small_before, small_s.size());
  const double large_poses = poses_per_tick(large, large_before, large_s.size());
  const double small_us = median(small_s) * 1e6, large_us = median(large_s) * 1e6;
  state.counters["small_us"] = small_us;
  state.counters["large_us"] = large_us;
  state.counters["ratio"] = large_us / small_us;
  state.counters["ratio_pose"] = (large_us / large_poses) / (small_us / small_poses);
  state.counters["small_poses"] = small_poses;
  state.counters["large_poses"] = large_poses;
}
BENCHMARK(BM_LargeAgainstSmall)
    ->ArgNames({"layout", "movers", "boxes"})
    ->ArgsProduct({{kFlat, kShapes, kBalanced, kDeep, kChains}, {kFresh, kSame, kCold}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);

// One size alone. Run by themselves under a profiler, the two numbers of ticks differ by 1,000 ticks' instructions.
void BM_Tick(benchmark::State& state) {
  World world = make_world(state.range(0), state.range(1), false);
  for (auto _ : state) benchmark::DoNotOptimize(one_tick(world, false));
  if (!is_right(world)) state.SkipWithError("wrong answer");
  state.counters["bytes_per_node"] =
      static_cast<double>(world.graph.memory_bytes()) / static_cast<double>(world.nodes.size());
}
void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"layout", "transforms"})->ArgsProduct({{kFlat, kBalanced, kDeep}, {1'000, 100'000}});
}
BENCHMARK(BM_Tick)->Apply(sizes)->Iterations(100);
BENCHMARK(BM_Tick)->Apply(sizes)->Iterations(1'100);

// Question: what does it take to build, first update and take down a whole world?
void BM_Build(benchmark::State& state) {
  const TransformFields t{.translation = {1, 2, 3}};
  std::vector<NodeSpec> specs;
  for (std::int32_t i = 0; i < state.range(0); ++i) specs.push_back({i % 10 == 0 ? -1 : i - i % 10, &t});
  for (auto _ : state) {
    SceneGraph graph;
    const auto nodes = graph.add_subtree(graph.root(), specs);
    if (graph.update().size() != specs.size()) state.SkipWithError("wrong answer");
    for (std::size_t i = 0; i < nodes.size(); i += 10) graph.remove(nodes[i]);
    if (graph.size() != 0) state.SkipWithError("wrong answer");
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_Build)->Arg(1'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace peerd
