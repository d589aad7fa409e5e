#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.hpp"

namespace peerd::recorded {

// A Recording is what peers of a run, or the peer of a capture, had in view over its time, to be shown again at any
// instant. Its times are in seconds from its begin: of a run, the start of the motions.

// Two seconds of frames of poses (docs/reference/gateway.md), one after the other. The first frame has all rows, and
// the last one is the first of the next stretch, but for its rows that have not changed.
struct Stretch {
  double from_s = 0, until_s = 0;
  std::uint32_t revision = 0;  // of the scene, in all its frames
  std::string frames{};        // compressed
  std::size_t size_bytes = 0;  // of the frames
};

struct SceneRevision {
  struct Node {
    ObjectId id;
    std::string path;
  };

  std::uint32_t revision = 0;
  double from_s = 0;
  std::string glb;  // compressed; empty: it can't be written
  std::string why_not;
  std::size_t size_bytes = 0;
  std::vector<Node> nodes{};  // that can move, as rows count them
};

struct RecordedEvent {
  double t_s = 0;
  std::string line;  // of the control protocol; its times are those of the recording
};

// The distance of each ghost from the truth, sampled at the recording's rate from its begin [m]; NaN where either is
// not known.
struct GhostErrors {
  std::vector<float> mean_m, largest_m;  // over the objects of others, or of a capture over own ones
  std::map<ObjectId, std::vector<float>> of_object;
};

struct RecordedView {
  PeerId peer;
  std::string name;
  std::vector<SceneRevision> scenes;
  std::vector<Stretch> stretches;  // by time; none while the peer is not there
  std::vector<RecordedEvent> events;
  GhostErrors errors;
};

struct Recording {
  enum class Kind : std::uint8_t { kRun, kCapture };

  Kind kind = Kind::kRun;
  std::string name;   // of the scenario, or of the capture's file
  std::string title;  // for people: what it is
  std::string world;
  double end_s = 0;
  std::uint32_t hz = 30;
  std::vector<RecordedView> views{};
  std::vector<std::pair<PeerId, std::string>> peers{};       // all whose names are known
  std::vector<std::pair<double, std::string>> happenings{};  // the scenario's events: time and name
  std::vector<std::string> notes{};                          // what is not as one may expect, one sentence each
  std::size_t rows = 0;                                      // of poses, in all frames
};

// The memory that a recording, or a part of it, takes [bytes].
[[nodiscard]] std::size_t size_bytes(const SceneRevision& scene);
[[nodiscard]] std::size_t size_bytes(const RecordedView& view);
[[nodiscard]] std::size_t size_bytes(const Recording& recording);

}  // namespace peerd::recorded
