// Question: what does an edit of the scene cost the peer that makes it, and every peer in the tick in which it takes
// effect, by how large the scene is and how much of it interests name?
#include <benchmark/benchmark.h>

#include <chrono>
#include <string>

#include "core/scene/reader.hpp"
#include "replication/peer/peer.hpp"

namespace peerd::replication {
namespace {

using namespace std::chrono_literals;

const std::string kHead = "#VRML V2.0 utf8\n";

// Boxes in a row; interests pair each two neighbours, or the first two alone.
std::string text_of(std::int64_t boxes, bool all_named) {
  std::string text = kHead;
  for (std::int64_t i = 0; i < boxes; ++i) {
    text += "DEF O" + std::to_string(i) + " Transform { translation " + std::to_string(3 * i) +
            " 0 0 children Shape { geometry Box { } } }\n";
  }
  for (std::int64_t i = 0; i + 1 < (all_named ? boxes : 2); i += 2) {
    text += "CollisionInterest { objectPath \"O" + std::to_string(i) + "\" interests [ \"O" + std::to_string(i + 1) +
            "\" ] collisionType 1 }\n";
  }
  return text;
}

// Measured is edit(), or the tick that applies it.
void measure(benchmark::State& state, bool the_tick) {
  const Scene scene = read_world(text_of(state.range(0), state.range(1) != 0)).scene.value();
  const auto model = make_world_model(scene);
  PeerConfig config;
  config.name = "a";
  Peer peer(config, *model);
  HostTime now{std::chrono::hours(1)};
  const auto tick = [&] {
    now += 17ms;
    peer.on_tick(now, {});
    while (peer.poll_output()) {
    }
  };
  for (int i = 0; i < 120; ++i) tick();
  std::uint64_t edits = 0;
  for (auto _ : state) {
    const AddNodes add{{}, {}, kHead + "DEF N" + std::to_string(edits) + " Transform { }", 0, 0, {}};
    const auto begin = std::chrono::steady_clock::now();
    const bool made = peer.edit(now, add).has_value();
    const auto edited = std::chrono::steady_clock::now();
    ++edits;
    std::chrono::duration<double> longest{0};
    while (made && peer.counters().scene_changes < edits) {
      const auto before = std::chrono::steady_clock::now();
      tick();
      longest = std::chrono::steady_clock::now() - before;
    }
    if (!made || peer.scene().instances.size() != scene.instances.size() + edits) state.SkipWithError("wrong answer");
    state.SetIterationTime(the_tick ? longest.count() : std::chrono::duration<double>(edited - begin).count());
  }
}

void BM_Edit(benchmark::State& state) { measure(state, false); }
void BM_TickThatAppliesIt(benchmark::State& state) { measure(state, true); }

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"boxes", "all_named"})->ArgsProduct({{1'000, 10'000, 100'000}, {0, 1}});
  bench->Unit(benchmark::kMillisecond)->UseManualTime();
}
BENCHMARK(BM_Edit)->Apply(sizes);
BENCHMARK(BM_TickThatAppliesIt)->Apply(sizes);

}  // namespace
}  // namespace peerd::replication
