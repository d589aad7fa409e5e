#pragma once
#include <cstdint>

#include "bench/impact/moving_pairs.hpp"
#include "collision/query/mesh_distance.hpp"
#include "collision/query/time_of_impact.hpp"

namespace peerd::bench::impact {

// One answer, beside the exact test at many instants.
struct Judgement {
  collision::MeshImpact impact;
  std::uint64_t samples = 0;
  bool wrong_start = false;     // kOverlapped and the exact test at 0 don't agree
  bool false_negative = false;  // an instant that touches before the time, or anywhere where there was to be no contact
  double touches_s = 0.0;       // that instant
  // The following members describe a hit.
  bool not_near = false;    // farther apart than the tolerance at its time
  bool parts = false;       // the nearest points part, and no acceleration brings them back within the tolerance
  double distance_m = 0.0;  // of the meshes, then
  double reached_m = 0.0;   // what the tolerance and the rounding of places come to
  bool touched = false;     // they come to touch after it, without going farther apart than that before
  double early_m = 0.0;     // of one that touched: (the time when that is - its time) * the speed of approach
  double early_s = 0.0;
};

class Checker {
 public:
  explicit Checker(std::uint64_t most_samples) : most_samples_(most_samples) {}
  [[nodiscard]] Judgement judge(const MovingPair& pair);

 private:
  class Case;

  std::uint64_t most_samples_;
  collision::MeshImpactQuery impacts_;
  collision::WideQuery exact_;
  collision::MeshDistanceQuery distances_;
};

}  // namespace peerd::bench::impact
