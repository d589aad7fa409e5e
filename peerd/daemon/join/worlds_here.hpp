#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/net/discovery/discovery.hpp"
#include "peerd/peer/config/peer_settings.hpp"

namespace peerd {

// The exit code of a program that finds no such world.
inline constexpr int kNoSuchWorld = 3;

// The peers of one world that meet each other.
struct World {
  std::string name;
  std::uint64_t session = 0;
  std::vector<discovery::Found> peers;  // at least one

  bool on_lo = false;  // it was found on lo, which is not the interface that is chosen by itself

  [[nodiscard]] bool is_sealed() const { return peers.front().beacon.sealed; }
};

struct WorldsHere {
  std::vector<World> worlds;
  std::string where;  // they were asked, in words
};

// Asks for `time` which worlds there are in this network, by interface and group of the settings; by IPv6 where nothing
// else is to be had, and no group was chosen. Where they name no interface, also those of this computer that are on lo.
// Blocks meanwhile.
[[nodiscard]] Result<WorldsHere> worlds_here(net::TransportSettings settings, Duration time);

// Returns the sessions of the world of that name, with an empty name of the only world: those that are sealed, or with
// `open` those that are not. If there are only others, it returns these, and nothing where there is no such world. Of
// several sealed ones those with the right key give the world. Error: several worlds or open sessions fit.
[[nodiscard]] Result<std::vector<const World*>> choose_world(const std::vector<World>& worlds, const std::string& name,
                                                             bool open);

// One line for a person: its name, its session, its peers and where they are.
[[nodiscard]] std::string line_of(const World& world);

}  // namespace peerd
