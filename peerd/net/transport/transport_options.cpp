#include "peerd/net/transport/transport_options.hpp"

#include <chrono>
#include <thread>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/os/interfaces.hpp"

namespace peerd::net {
namespace {

MulticastUse use_of(std::size_t word) {
  switch (word) {
    case kMulticastAlways:
      return MulticastUse::kAlways;
    case kMulticastNever:
      return MulticastUse::kNever;
    default:
      return MulticastUse::kAuto;
  }
}

}  // namespace

Result<TransportOptions> transport_options(const TransportSettings& settings, const SipKey& key) {
  const auto port = static_cast<std::uint16_t>(settings.port.value_or(kDefaultPort));
  const auto plan = parse_group_plan(settings.group, port, settings.group_pool);
  if (!plan) return std::unexpected(input_error(plan.error()));
  TransportOptions options;
  options.multicast.interface = settings.interface;
  options.multicast.groups = *plan;
  options.multicast.ttl = static_cast<int>(settings.ttl);
  options.multicast.dscp = static_cast<int>(settings.dscp);
  options.multicast.receives_own_datagrams = false;  // a peer does not use its own datagrams
  options.multicast.receive_buffer_bytes = static_cast<int>(settings.receive_buffer_bytes);
  options.use = use_of(settings.multicast);
  options.peers = settings.peers;
  options.relays = settings.relays;
  options.key = key;
  return options;
}

bool takes_ipv6(TransportSettings& settings, Duration patience) {
  const bool reaches_by_group = settings.multicast != kMulticastNever && settings.relays.empty() &&
                                settings.peers.empty() && settings.nats.servers.empty();
  if (settings.group != TransportSettings{}.group || !reaches_by_group) return false;
  constexpr std::chrono::milliseconds kStep{100};
  for (Duration waited{0};; waited += kStep) {
    const auto interfaces = list_interfaces();
    if (!interfaces || !has_ipv6_alone(*interfaces, settings.interface)) return false;
    if (waited >= patience) break;
    std::this_thread::sleep_for(kStep);
  }
  settings.group = kIpv6Group;
  return true;
}

std::string buffer_warning(const TransportSettings& settings, int granted_bytes) {
  if (granted_bytes >= static_cast<int>(settings.receive_buffer_bytes)) return "";
  return fmt::format(
      "the kernel grants a receive buffer of {} bytes, not {}: raise it (sysctl -w net.core.rmem_max={}) or lower "
      "transport.receive_buffer_bytes",
      granted_bytes, settings.receive_buffer_bytes, settings.receive_buffer_bytes);
}

}  // namespace peerd::net
