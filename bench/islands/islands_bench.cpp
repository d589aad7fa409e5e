#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../figures.hpp"
#include "../fitted_exponent.hpp"
#include "island_run.hpp"

// Question: what does a peer of a large session cost, in traffic, memory and time, and how does that grow with the
// number of peers, where the world grows with them?
//
// islands_bench [--quick] [--out DIR] [PEERS..] [KEY=VALUE..]: simulates sessions of so many peers (30, 100, 300,
// 1000), with 20 objects each, on 20 islands. Writes the world and the scenario of the largest to DIR, too, for `peerd
// sim`. Exit code 1: the traffic of a peer grows faster than the number of peers to the power of 0.3, beyond 100 peers,
// or a run is wrong.
namespace peerd::bench {
namespace {

constexpr std::uint32_t kBeyond = 100;
constexpr double kExponentMax = 0.3;

using Points = std::vector<std::pair<double, double>>;

void print(const IslandCosts& costs) {
  std::printf(
      "%u peers, %u objects: a peer receives %.0f bytes/s in %.1f datagrams (at most %.0f), sends %.0f bytes/s in "
      "%.1f; %.0f KiB (%.0f allocated) and %.2f ms of a core for each second\n",
      costs.peers, costs.objects, costs.in_all.bytes, costs.in_all.datagrams, costs.in_worst.bytes, costs.out_all.bytes,
      costs.out_all.datagrams, costs.memory_bytes / 1024, costs.allocated_bytes / 1024, costs.cpu_s * 1e3);
  std::printf(
      "  knows %.1f others, %.1f of them near, listens to %.1f regions, receives %.1f objects of others, "
      "decides %.3f contacts/s; clocks within %.2f ms\n",
      costs.members, costs.near_members, costs.regions, costs.received_objects, costs.decisions, costs.clock_error_ms);
  for (const auto& [kind, rate] : costs.in) {
    if (rate.datagrams > 0.0)
      std::printf("  in: %-14s %9.1f bytes/s %8.2f/s\n", kind.c_str(), rate.bytes, rate.datagrams);
  }
  std::fflush(stdout);
}

void add(const IslandCosts& costs, std::vector<Figure>& figures) {
  const auto figure = [&](const std::string& name, double value, const std::string& unit) {
    figures.push_back({std::to_string(costs.peers) + "." + name, value, unit, "", {}});
  };
  figure("in", costs.in_all.bytes, "bytes/s");
  figure("in_worst", costs.in_worst.bytes, "bytes/s");
  figure("in_datagrams", costs.in_all.datagrams, "1/s");
  figure("out", costs.out_all.bytes, "bytes/s");
  figure("memory", costs.memory_bytes, "bytes");
  figure("allocated", costs.allocated_bytes, "bytes");
  figure("cpu", costs.cpu_s, "s/s");
  figure("members_near", costs.near_members, "peers");
  figure("objects_received", costs.received_objects, "objects");
  figure("clock_error", costs.clock_error_ms, "ms");
  for (const auto& [kind, rate] : costs.in) {
    figure("in." + kind, rate.bytes, "bytes/s");
    figure("in." + kind + ".datagrams", rate.datagrams, "1/s");
  }
}

// Prints the exponent, where there are two sizes beyond which it counts. Returns whether it is small enough.
bool fit(const std::string& what, const Points& points, std::vector<Figure>& figures) {
  if (points.size() < 2) return true;
  const double exponent = fitted_exponent(points);
  std::printf("%s grows as the number of peers to the power of %.3f, from %.0f to %.0f peers\n", what.c_str(), exponent,
              points.front().first, points.back().first);
  figures.push_back({"exponent." + what, exponent, "", "0.3", exponent / kExponentMax});
  return exponent <= kExponentMax;
}

int run(const Options& options) {
  std::vector<std::uint32_t> sizes;
  IslandWorld world;
  for (const std::string& argument : options.arguments) {
    if (argument.find('=') != std::string::npos) {
      world.sets.push_back(argument);
    } else {
      sizes.push_back(static_cast<std::uint32_t>(std::stoul(argument)));
    }
  }
  if (options.quick) {
    world.settle_s = 4.0, world.measure_s = 2.0, world.objects = 2;
    world.sets.push_back("replication.large_session_above=6");
  }
  if (sizes.empty())
    sizes = options.quick ? std::vector<std::uint32_t>{9, 16} : std::vector<std::uint32_t>{30, 100, 300, 1000};
  std::vector<Figure> figures;
  Points traffic, memory, allocated, cpu;
  int status = 0;
  for (const std::uint32_t peers : sizes) {
    world.peers = peers;
    // Each peer has heard of each other one by then: far hellos are at most that far apart, by their default rate.
    if (!options.quick) world.settle_s = std::max(20.0, 1.5 * peers / 24.0 + 2.0);
    const IslandCosts costs = run_islands(world);
    print(costs);
    add(costs, figures);
    if (!costs.wrong.empty()) {
      std::printf("WRONG: %s\n", costs.wrong.c_str());
      status = 1;
    }
    if (peers < kBeyond) continue;
    traffic.emplace_back(peers, costs.in_all.bytes);
    memory.emplace_back(peers, costs.memory_bytes);
    allocated.emplace_back(peers, costs.allocated_bytes);
    cpu.emplace_back(peers, costs.cpu_s);
  }
  if (!fit("traffic", traffic, figures)) status = 1;
  (void)fit("memory", memory, figures);
  (void)fit("allocated", allocated, figures);
  (void)fit("cpu", cpu, figures);
  const bool written = write_beside(options, "islands.wrl", world_text(world)) &&
                       write_beside(options, "islands.toml", scenario_text(world, "islands.wrl"));
  return write_figures(options, figures) && written ? status : 1;
}

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
