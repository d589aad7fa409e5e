#pragma once
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <vector>

#include "peerd/transport/multicast_socket.hpp"
#include "peerd/transport/transport.hpp"
#include "peerd/transport/unicast_fan_out.hpp"

namespace peerd::net {

enum class MulticastUse : std::uint8_t {
  kAuto,    // where a probe says that it works; else unicast, if peers are given
  kAlways,  // or not at all
  kNever,   // unicast
};

struct TransportOptions {
  MulticastOptions multicast;  // the port, the interface, the family of the group and what follows hold for unicast too
  MulticastUse use = MulticastUse::kAuto;
  std::vector<std::string> peers = {};  // "host:port", "[2001:db8::1]:port": seeds of unicast
  SipKey key = {};                      // of this process alone, and secret; for unicast (KnownPeers)
};

struct OpenedTransport {
  std::unique_ptr<Transport> transport;
  std::string why_unicast;  // empty: it is multicast
  [[nodiscard]] bool unicast() const { return !why_unicast.empty(); }
};

// `io` and `clock` outlive the transport.
[[nodiscard]] std::expected<OpenedTransport, NetError> open_transport(asio::io_context& io, const HostClock& clock,
                                                                      const TransportOptions& options);

// The addresses of seeds, names looked up now. kBadSetting: one that is no HOST:PORT.
[[nodiscard]] std::expected<std::vector<asio::ip::udp::endpoint>, NetError> resolve_peers(
    const std::vector<std::string>& peers, IpFamily family);

}  // namespace peerd::net
