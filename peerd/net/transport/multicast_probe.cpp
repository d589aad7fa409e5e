#include "peerd/net/transport/multicast_probe.hpp"

#include <algorithm>
#include <array>

#include "peerd/net/os/udp_socket.hpp"

namespace peerd::net {
namespace {

constexpr int kTries = 6;
constexpr std::chrono::milliseconds kWait{50};  // for each try

// The probe's own group is next to that of discovery (peerd/net/discovery), and not among those of the regions.
constexpr const char *kProbeGroupV4 = "239.192.79.254", *kProbeGroupV6 = "ff15::7065:6572:65";
constexpr std::array<std::byte, 4> kProbe{std::byte{'p'}, std::byte{'e'}, std::byte{'e'}, std::byte{'r'}};

std::expected<ProbeResult, NetError> probe_port(const HostClock& clock, const MulticastOptions& options) {
  asio::io_context io(1);
  const auto opened = MulticastSocket::open(io, clock, options);
  if (!opened) return std::unexpected(opened.error());
  MulticastSocket& socket = **opened;
  constexpr RegionId kFirst{0};
  if (auto joined = socket.join(kFirst); !joined) return std::unexpected(joined.error());

  bool received = false;
  HostTime sent = clock.now();
  ProbeResult result{.over = socket.chosen_interface(),
                     .receive_buffer_bytes = socket.receive_buffer_bytes(),
                     .memberships_max = memberships_limit(options.groups.base.is_v4() ? IpFamily::kV4 : IpFamily::kV6)};
  socket.on_receive([&](const Arrival& a) { received = received || std::ranges::equal(a.datagram, kProbe); });
  for (int tries = 0; tries < kTries && !received; ++tries) {
    sent = clock.now();
    socket.send(kFirst, kProbe);
    socket.flush();
    for (const HostTime until = sent + kWait; !received && clock.now() < until;) io.run_one_for(until - clock.now());
  }
  if (!received) {
    const TrafficCounters& c = socket.counters();
    return failure(NetError::Kind::kNoMulticast,
                   "multicast sent over \"" + socket.chosen_interface().interface.name +
                       (c.packets_out == 0 ? "\" does not leave (a firewall, or no route)"
                                           : "\" does not come back to this computer (a firewall, or a network without "
                                             "multicast)"));
  }
  result.took = clock.now() - sent;
  result.stamped = socket.counters().in_unstamped == 0;
  return result;
}

}  // namespace

std::expected<ProbeResult, NetError> probe_multicast(const HostClock& clock, MulticastOptions options) {
  options.receives_own_datagrams = true;
  options.any_port = true;  // no peer receives the probe
  auto found = probe_port(clock, options);
  if (found || found.error().kind != NetError::Kind::kNoMulticast) return found;
  // A firewall may let through the peers' port alone. No peer is in the probe's own group.
  options.any_port = false;
  options.groups.base = asio::ip::make_address(options.groups.base.is_v4() ? kProbeGroupV4 : kProbeGroupV6);
  auto by_peers_port = probe_port(clock, options);
  return by_peers_port ? by_peers_port : found;
}

}  // namespace peerd::net
