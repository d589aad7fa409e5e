#pragma once
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/ip/udp.hpp>

#include "core/time.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/os/net_error.hpp"

namespace peerd::doctor {

// One interface of this network namespace, as rtnetlink describes it. Not read from /sys, which shows the namespace
// that it was mounted in.
struct Link {
  std::string name;
  unsigned index = 0;
  std::string kind = {};  // "bridge", "veth", "macvlan", "wireguard"; empty: a device
  unsigned mtu_bytes = 0;
  unsigned bridge_index = 0;  // of the bridge that it is a port of; 0: none
  bool up = false, has_carrier = false, loopback = false, multicast = false;
  bool other_end_elsewhere = false;  // its other end is in another network namespace: a container's
  bool wireless = false;
  bool strict_sources = false;  // drops what comes from where this computer would not answer over it (rp_filter)
  // Of a bridge: whether it forwards a group only to ports that have asked for it, and whether it asks them itself.
  bool snooping = false, querier = false;
  bool querier_elsewhere = false;  // it hears another one ask
};

// How this computer would send to the address of a configured peer.
struct Route {
  std::string peer;  // as configured
  enum class Way : std::uint8_t { kNone, kThisComputer, kOutwards } way = Way::kNone;
  std::string interface = {};  // of kOutwards; empty: unknown
};

// The rules of the firewall that can be read without guessing: the policies of the chains that see arriving datagrams.
struct Firewall {
  bool readable = false;                   // it takes the privilege CAP_NET_ADMIN
  std::vector<std::string> dropping = {};  // "inet filter input": what no rule of it accepts is dropped
  bool older_tables = false;               // tables of iptables-legacy, whose rules are not read
};

// The ports beside that of the session, which is tried by a peer's own socket.
struct OtherPorts {
  std::uint16_t discovery = 0;  // UDP, shared by all peers; 0: not used
  std::uint16_t snapshot = 0;   // TCP, of one peer; 0: the system chooses one
};

struct HostFacts {
  std::vector<Link> links;
  std::vector<Route> routes;                   // to the configured peers
  std::optional<std::size_t> memberships_max;  // groups of one IPv4 socket; none: unknown
  std::optional<std::size_t> optmem_bytes;     // net.core.optmem_max, which limits IPv6 groups; none: unknown
  std::optional<Duration> clock_error;         // the bound that the kernel knows; none: nothing steers the clock
  std::size_t dropped_by_source = 0;           // datagrams and others that rp_filter has dropped, of all interfaces
  std::string container;                       // "docker", "podman", "systemd-nspawn"; empty: none
  Firewall firewall;
  OtherPorts taken;  // the ports that another program keeps from a peer; 0: none
};

// A configured peer with its address.
struct NamedPeer {
  std::string text;
  boost::asio::ip::udp::endpoint address;
};
// Reads what the kernel says, also of the routes to `peers`.
[[nodiscard]] std::expected<HostFacts, net::NetError> read_host_facts(const net::HostClock& clock,
                                                                      const std::vector<NamedPeer>& peers,
                                                                      const OtherPorts& ports);

// The parts of read_host_facts() that have files of their own.
[[nodiscard]] std::expected<std::vector<Link>, net::NetError> read_links();
[[nodiscard]] Firewall read_firewall();
[[nodiscard]] Route route_to(const NamedPeer& peer);
[[nodiscard]] OtherPorts taken_of(const OtherPorts& ports);

}  // namespace peerd::doctor
