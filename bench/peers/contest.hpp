#pragma once
#include <optional>
#include <string>
#include <vector>

#include "bench/peers/engine.hpp"
#include "bench/peers/motion.hpp"

namespace peerd::bench::peers {

struct Times {
  double mean = 0, median = 0;  // over queries [us]
};

struct Score {
  std::string engine;
  Pairs pairs = Pairs::kAll;
  Times first;
  std::optional<Times> all;
  double build_ms = 0;   // best of three
  double memory_mb = 0;  // on the heap, after building what all bodies share
  std::size_t queries = 0;
  std::size_t wrong_first = 0, wrong_all = 0, disagreements = 0;  // queries: of the first sort, the second, or either
};

struct Effort {
  int rounds = 5;        // over all frames; engines take turns
  int timings = 3;       // of each query in a round, of which the least counts
  double budget_s = 20;  // of the processor, for one engine; those that need more take fewer of the frames
};

// A query's time is the least of a round's timings, and its part of what the engine needs to move the bodies of its
// frame. Mean and median are over queries, and of each the median over rounds.
[[nodiscard]] std::vector<Score> contest(const TriangleMesh& mesh, const std::vector<Frame>& frames,
                                         const std::vector<EngineKind>& engines, const Effort& effort);

// The time from a mesh that nothing was built for to the answer of a frame's first query: the best of three.
[[nodiscard]] double first_answer_ms(const EngineKind& kind, const TriangleMesh& mesh, const Frame& frame);

}  // namespace peerd::bench::peers
