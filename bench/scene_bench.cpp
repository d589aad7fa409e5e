// Question: what does a change of a world cost, by how much of it there is? The whole scene is made anew
// (docs/decisions/ core-scene.md); reading the world's text is what it is compared with.
#include <benchmark/benchmark.h>

#include <string>

#include "core/edit/scene_editor.hpp"
#include "core/scene/reader.hpp"
#include "core/scene/scene.hpp"

namespace peerd {
namespace {

const std::string kHead = "#VRML V2.0 utf8\n";
const std::string kBox = "DEF NEW Transform { children Shape { geometry Box { } } }\n";

std::string text_of(std::int64_t transforms) {
  std::string text = kHead;
  for (std::int64_t i = 0; i < transforms; ++i) {
    text += "DEF T" + std::to_string(i) + " Transform { translation " + std::to_string(i) +
            " 0 0 children Shape { geometry Box { } } }\n";
  }
  return text;
}

void BM_Read(benchmark::State& state) {
  const std::string text = text_of(state.range(0));
  for (auto _ : state) {
    const ReadResult result = read_world(text);
    if (!result.scene) state.SkipWithError("wrong answer");
  }
}

enum Change : std::int64_t { kAdd, kRemove, kMove, kSet };

bool is_right(const Scene& scene, std::int64_t transforms, std::int64_t change) {
  const auto before = static_cast<std::size_t>(2 * transforms);
  const ObjectId first{0};
  switch (change) {
    case kAdd:
      return scene.instances.size() == before + 2 && scene.path_of(ObjectId{1, 1}) == "NEW";
    case kRemove:
      return scene.instances.size() == before - 2 && !scene.contains(first);
    case kMove:
      return scene.instances.size() == before && scene.index_of(first) == before - 2;
    default:
      return scene.instances.size() == before && scene.transform(first).translation == Vec3(1, 2, 3);
  }
}

// One change and the scene that comes of it; the scene before has been edited, too.
void BM_Edit(benchmark::State& state) {
  const std::int64_t transforms = state.range(1), change = state.range(0);
  const Scene read = read_world(text_of(transforms)).scene.value();
  SceneEditor nothing(read);
  const Scene world = nothing.finish().value();
  for (auto _ : state) {
    SceneEditor editor(world);
    bool good = true;
    if (change == kAdd) good = editor.add(kHead + kBox, {}, {ObjectId{1, 1}, NodeId{1, 1}}, {}).has_value();
    if (change == kRemove) good = editor.remove(ObjectId{0}).has_value();
    if (change == kMove) good = editor.move(ObjectId{0}, {}).has_value();
    if (change == kSet) {
      const NodeId node = world.document->ids.id_of(world.instances[0].node);
      good = editor.set(node, "translation", "1 2 3", {}).has_value();
    }
    const auto edited = editor.finish();
    if (!good || !edited || !is_right(*edited, transforms, change)) state.SkipWithError("wrong answer");
  }
}

BENCHMARK(BM_Read)->Arg(100)->Arg(10'000)->Arg(50'000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Edit)
    ->ArgNames({"change", "transforms"})
    ->ArgsProduct({{kAdd, kRemove, kMove, kSet}, {100, 10'000, 50'000}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace peerd
