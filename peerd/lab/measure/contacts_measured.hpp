#pragma once
#include <algorithm>
#include <cstdint>
#include <string>

namespace peerd::measure {

// The pair of objects that is deepest in each other at any of the sampled instants.
struct WorstPair {
  double depth_m = 0.0;  // 0: there is none, and the rest is empty
  std::string a, b;      // paths
  double at_s = 0.0;
  double explained_m = 0.0;  // what latency explains of it
};

// An energy at the first and at the last sampled instant, and the greatest one [J].
struct EnergyMeasured {
  double start_j = 0.0, greatest_j = 0.0, end_j = 0.0;

  void add(double now_j, bool is_first) {
    if (is_first) start_j = greatest_j = now_j;
    greatest_j = std::max(greatest_j, now_j);
    end_j = now_j;
  }
};

// The meter looks at this many instants in a second at most, of those at which objects have been sampled.
inline constexpr int kContactSamples_hz = 20, kContactViews_hz = 10;

// The findings about what objects do to each other, by their states. The depth of a
// mesh that is neither of convex pieces nor a Sphere is a lower bound.
struct ContactsMeasured {
  std::uint64_t samples = 0, view_samples = 0, energy_samples = 0;
  std::uint64_t pairs_not_measured = 0;
  WorstPair truth, truth_meshes;  // what owners have
  WorstPair views, view_meshes;   // what observers have of others, and of others and themselves
  std::string observer;           // of `views`
  WorstPair unexplained;          // of the truth, the pair that is farthest beyond what latency explains
  std::uint64_t at_rest = 0;      // contacts in the last second of objects that do not move in it
  std::uint64_t bodies = 0;       // objects whose energy counts
  std::uint64_t owners = 0;       // peers that own some of them
  EnergyMeasured kinetic, potential, sum;
  bool is_driven = false;  // something else than these objects puts energy in, or may do so
};

}  // namespace peerd::measure
