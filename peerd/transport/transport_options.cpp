#include "peerd/transport/transport_options.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace peerd {
namespace {

net::MulticastUse use_of(std::size_t word) {
  switch (word) {
    case config::kMulticastAlways:
      return net::MulticastUse::kAlways;
    case config::kMulticastNever:
      return net::MulticastUse::kNever;
    default:
      return net::MulticastUse::kAuto;
  }
}

}  // namespace

InputError input_error(const net::NetError& error) {
  return {"error: " + error.sentence, error.kind == net::NetError::Kind::kBadSetting ? 2 : 3};
}

Result<net::TransportOptions> transport_options(const config::TransportSettings& settings, const net::SipKey& key) {
  const auto port = static_cast<std::uint16_t>(settings.port.value_or(config::kDefaultPort));
  const auto plan = net::parse_group_plan(settings.group, port, settings.group_pool);
  if (!plan) return std::unexpected(input_error(plan.error()));
  net::TransportOptions options;
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

net::SipKey random_key() {
  net::SipKey key;
  static_assert(sizeof key == 16);
  if (getentropy(&key, sizeof key) != 0) throw std::system_error(errno, std::generic_category(), "getentropy");
  return key;
}

std::string buffer_warning(const config::TransportSettings& settings, int granted_bytes) {
  if (granted_bytes >= static_cast<int>(settings.receive_buffer_bytes)) return "";
  return fmt::format(
      "the kernel grants a receive buffer of {} bytes, not {}: raise it (sysctl -w net.core.rmem_max={}) or lower "
      "transport.receive_buffer_bytes",
      granted_bytes, settings.receive_buffer_bytes, settings.receive_buffer_bytes);
}

}  // namespace peerd
