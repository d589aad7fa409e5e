#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace peerd::measure {

// The error and the cost of a run.
struct RunCost {
  std::size_t run = 0;       // index
  double error_m = 0.0;      // mean ghost error, mean over observers and over the objects that err in any run
  double bytes_per_s = 0.0;  // datagrams of all peers
  bool on_front = false;     // no other run of its situation has less of one and no more of the other
};

// Runs that can be compared: they share the swept keys under `network.` and the seed, which are given; all other keys
// are chosen.
struct Situation {
  std::string label;  // "latency 100 ms"; "" where nothing that is given is swept
  std::vector<RunCost> runs;
};

// Groups the runs by situation and finds the front of each. Runs without a sample of any error are left out.
[[nodiscard]] std::vector<Situation> pareto_fronts(const nlohmann::ordered_json& summary);

}  // namespace peerd::measure
