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

bool is_same_peer(const Found& a, const Found& b) {
  return a.beacon.session == b.beacon.session && a.beacon.peer == b.beacon.peer;
}

}  // namespace

Result<WorldsHere> worlds_here(net::TransportSettings settings, Duration time) {
  (void)net::takes_ipv6(settings, Duration{0});  // the words of where it has asked say it
  auto asked = asked_over(settings, settings.interface, time);
  if (settings.interface.empty()) {
    // This computer's own peers may be on lo alone. Where both cannot be asked, the other one's error says more.
    auto own = asked_over(settings, kLoopback, std::min(time, kLoopbackAnswers));
    if (own && !asked) {
      asked = *std::move(own);
    } else if (own) {
      std::vector<Found>& found = asked->found;
      for (Found& each : own->found) {
        const auto is_this = [&](const Found& other) { return is_same_peer(each, other); };
        if (std::ranges::none_of(found, is_this)) found.push_back(std::move(each));
      }
      const auto by_world = [](const Found& each) { return std::tie(each.beacon.world, each.beacon.session); };
      std::ranges::stable_sort(found, {}, by_world);
    }
  }
  if (!asked) return std::unexpected(asked.error());
  WorldsHere here{{}, std::move(asked->where)};
  std::vector<World>& worlds = here.worlds;
  for (Found& each : asked->found) {
    const bool goes_on =
        !worlds.empty() && worlds.back().name == each.beacon.world && worlds.back().session == each.beacon.session;
    if (!goes_on) worlds.push_back({each.beacon.world, each.beacon.session, {}});
    worlds.back().peers.push_back(std::move(each));
  }
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

bool is_on_loopback(const World& world) {
  return std::ranges::all_of(world.peers, [](const Found& peer) { return peer.address.is_loopback(); });
}

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

Result<const World*> choose_world(const std::vector<World>& worlds, const std::string& name) {
  std::vector<const World*> named;
  for (const World& world : worlds) {
    if (name.empty() || world.name == name) named.push_back(&world);
  }
  if (named.size() > 1) {
    std::string all;
    for (const World* const world : named) all += "\n  " + line_of(*world);
    return std::unexpected(InputError{
        "error: which of these worlds? Say its name, or --from HOST:PORT of one of its peers:" + all, kNoSuchWorld});
  }
  return named.empty() ? nullptr : named.front();
}

}  // namespace peerd
