#include "peerd/lab/recorded/recording.hpp"

#include <numeric>

namespace peerd::recorded {

std::size_t size_bytes(const SceneRevision& scene) {
  std::size_t bytes = sizeof scene + scene.glb.size() + scene.why_not.size();
  for (const SceneRevision::Node& node : scene.nodes) bytes += sizeof node + node.path.size();
  return bytes;
}

std::size_t size_bytes(const RecordedView& view) {
  std::size_t bytes = 0;
  for (const SceneRevision& scene : view.scenes) bytes += size_bytes(scene);
  for (const Stretch& stretch : view.stretches) bytes += sizeof stretch + stretch.frames.size();
  for (const RecordedEvent& event : view.events) bytes += sizeof event + event.line.size();
  bytes += (view.errors.mean_m.size() + view.errors.largest_m.size()) * sizeof(float);
  for (const auto& [object, errors] : view.errors.of_object) bytes += sizeof object + errors.size() * sizeof(float);
  return bytes;
}

std::size_t size_bytes(const Recording& recording) {
  return std::accumulate(recording.views.begin(), recording.views.end(), std::size_t{0},
                         [](std::size_t sum, const RecordedView& view) { return sum + size_bytes(view); });
}

}  // namespace peerd::recorded
