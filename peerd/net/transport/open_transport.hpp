#pragma once
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <vector>

#include "peerd/net/transport/multicast_socket.hpp"
#include "peerd/net/transport/transport.hpp"
#include "peerd/net/transport/unicast_fan_out.hpp"

namespace peerd::net {

enum class MulticastUse : std::uint8_t {
  kAuto,    // multicast if a probe shows that it works, else unicast if peers are given
  kAlways,  // multicast or an error
  kNever,   // unicast
};

struct TransportOptions {
  MulticastOptions multicast;  // its port, interface, address family, DSCP and buffer size hold for unicast, too
  MulticastUse use = MulticastUse::kAuto;
  std::vector<std::string> peers = {};   // "host:port", "[2001:db8::1]:port": the addresses that unicast greets first
  std::vector<std::string> relays = {};  // likewise: through one of these alone; not empty: nothing else is tried
  SipKey key = {};                       // secret and of this process alone, for unicast (KnownPeers)
  std::shared_ptr<GreetingSeal> greetings = {};  // of unicast; null: they are open
};

struct OpenedTransport {
  std::unique_ptr<Transport> transport;
  std::string why_unicast;  // empty: it is multicast, or goes through a relay
  std::string
      why_only_here{};  // no interface was configured, and none was found that reaches other computers; or empty
  [[nodiscard]] bool unicast() const { return !why_unicast.empty(); }
};

// `io` and `clock` outlive the transport.
[[nodiscard]] std::expected<OpenedTransport, NetError> open_transport(asio::io_context& io, const HostClock& clock,
                                                                      const TransportOptions& options);

// Resolves the addresses of configured peers, host names by the system's resolver. kBadSetting: one is not HOST:PORT.
// `named_by` is the setting, for errors.
[[nodiscard]] std::expected<std::vector<asio::ip::udp::endpoint>, NetError> resolve_peers(
    const std::vector<std::string>& peers, IpFamily family, const std::string& named_by = "transport.peers");

}  // namespace peerd::net
