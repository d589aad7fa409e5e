#include "peerd/daemon/join/worlds_here.hpp"

#include <algorithm>
#include <chrono>
#include <tuple>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/transport_options.hpp"
#include "replication/wire/codec.hpp"

namespace peerd {

using discovery::Found;

namespace {

constexpr const char* kLoopback = "lo";
// A peer on this computer answers at once.
constexpr Duration kLoopbackAnswers = std::chrono::milliseconds(300);

// The peers that answer on that interface.
Result<discovery::Asked> asked_over(net::TransportSettings settings, const std::string& interface, Duration time) {
  settings.interface = interface;
  auto reach = net::transport_options(settings, {});
  if (!reach) return std::unexpected(reach.error());
  const net::HostClock clock;
  auto asked = discovery::ask_who_is_here(clock, reach->multicast, time);
  if (!asked) return std::unexpected(input_error(asked.error()));
  return *std::move(asked);
}

std::vector<World> worlds_of(std::vector<Found> found) {
  std::vector<World> worlds;
  for (Found& each : found) {
    const auto is_of = [&](const World& world) {
      return world.name == each.beacon.world && world.session == each.beacon.session &&
             world.is_sealed() == each.beacon.sealed;
    };
    if (worlds.empty() || !is_of(worlds.back())) worlds.push_back({each.beacon.world, each.beacon.session, {}});
    worlds.back().peers.push_back(std::move(each));
  }
  return worlds;
}

// Adds the worlds of this computer that answer on lo alone.
void add_worlds_on_lo(std::vector<Found> found, std::vector<World>& worlds) {
  for (World& own : worlds_of(std::move(found))) {
    const auto is_the_same = [&](const World& world) {
      return world.session == own.session && world.is_sealed() == own.is_sealed();
    };
    if (std::ranges::any_of(worlds, is_the_same)) continue;
    own.on_lo = true;
    worlds.push_back(std::move(own));
  }
  std::ranges::sort(worlds, {}, [](const World& world) { return std::tie(world.name, world.session); });
}

}  // namespace

Result<WorldsHere> worlds_here(net::TransportSettings settings, Duration time) {
  (void)net::takes_ipv6(settings, Duration{0});  // the words of where it has asked say it
  auto asked = asked_over(settings, settings.interface, time);
  WorldsHere here;
  if (asked) here = {worlds_of(std::move(asked->found)), std::move(asked->where)};
  if (settings.interface.empty()) {
    auto own = asked_over(settings, kLoopback, std::min(time, kLoopbackAnswers));
    if (own && !asked) here.where = std::move(own->where);
    if (own) add_worlds_on_lo(std::move(own->found), here.worlds);
    if (own) return here;
  }
  if (!asked) return std::unexpected(asked.error());
  return here;
}

namespace {

// The address that --from takes.
std::string join_address_of(const Found& peer) {
  const std::string address = peer.address.to_string();
  if (peer.beacon.snapshot_port == 0) return address + ", which gives its world to nobody";
  return fmt::format("{}:{}", peer.address.is_v6() ? "[" + address + "]" : address, peer.beacon.snapshot_port);
}

}  // namespace

std::string line_of(const World& world) {
  std::string peers;
  for (const Found& peer : world.peers) {
    peers += (peers.empty() ? "" : ", ") +
             fmt::format("{} (id {}) at {}", peer.beacon.name, peer.beacon.peer.value, join_address_of(peer));
  }
  const std::uint32_t protocol = world.peers.front().beacon.protocol;
  const std::string other = protocol == replication::kProtocolVersion
                                ? ""
                                : fmt::format("; it speaks version {} of the protocol, this program {}", protocol,
                                              replication::kProtocolVersion);
  return fmt::format("{}  (session {:016x}{}): {}{}\n", world.name, world.session, world.is_sealed() ? "" : ", open",
                     peers, other);
}

Result<std::vector<const World*>> choose_world(const std::vector<World>& worlds, const std::string& name, bool open) {
  std::vector<const World*> named;
  for (const World& world : worlds) {
    if (name.empty() || world.name == name) named.push_back(&world);
  }
  const bool has_one_name =
      std::ranges::all_of(named, [&](const World* world) { return world->name == named.front()->name; });
  std::vector<const World*> chosen = named;
  std::erase_if(chosen, [&](const World* world) { return world->is_sealed() == open; });
  if (!has_one_name || (open && chosen.size() > 1)) {
    std::string all;
    for (const World* const world : named) all += "\n  " + line_of(*world);
    return std::unexpected(InputError{
        "error: which of these worlds? Say its name, or --from HOST:PORT of one of its peers:" + all, kNoSuchWorld});
  }
  return chosen.empty() ? named : chosen;
}

}  // namespace peerd
