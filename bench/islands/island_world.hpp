#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace peerd::bench {

// A session that grows at constant density. Each peer owns the objects of a square of its own; the squares lie in a
// grid, and each is a region. A peer sees what is near its objects: its own square and the eight around it. In the
// network the peers are on islands, so that neighbours in the world are mostly far away in the network.
struct IslandWorld {
  std::uint32_t peers = 100;
  std::uint32_t objects = 20;   // of each peer, >= 1
  std::uint32_t islands = 20;   // as many at most as there are peers
  std::uint32_t together = 25;  // peers that are there from the start; the others join one after another
  double joins_per_s = 20.0;
  double settle_s = 20.0, measure_s = 10.0;  // after the last has joined
  std::vector<std::string> sets = {};        // KEY=VALUE over the scenario

  [[nodiscard]] std::uint32_t side() const;  // squares along each axis
  [[nodiscard]] double joined_s() const;     // when the last peer has been started
  [[nodiscard]] double duration_s() const { return joined_s() + settle_s + measure_s; }
};

inline constexpr double kSquare_m = 50.0;

// The world's text (VRML97), and that of the scenario, which has `world` as its world.
[[nodiscard]] std::string world_text(const IslandWorld& world);
[[nodiscard]] std::string scenario_text(const IslandWorld& world, const std::string& world_file);

}  // namespace peerd::bench
