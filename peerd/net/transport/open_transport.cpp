#include "peerd/net/transport/open_transport.hpp"

#include <charconv>

#include "peerd/net/os/udp_socket.hpp"
#include "peerd/net/transport/island_member.hpp"
#include "peerd/net/transport/multicast_probe.hpp"
#include "peerd/net/transport/relay_transport.hpp"

namespace peerd::net {
namespace {

using asio::ip::udp;

struct HostAndPort {
  std::string host, port;
};

// Splits "host:port", or "[address]:port" where the address itself has colons.
std::expected<HostAndPort, NetError> split(const std::string& text, const std::string& named_by) {
  const auto colon = text.rfind(':');
  HostAndPort parts{text.substr(0, colon), colon == std::string::npos ? "" : text.substr(colon + 1)};
  if (parts.host.size() > 2 && parts.host.front() == '[' && parts.host.back() == ']') {
    parts.host = parts.host.substr(1, parts.host.size() - 2);
  } else if (parts.host.find_first_of(":[]") != std::string::npos) {
    parts.host.clear();  // ambiguous: the last part may be the port, or a part of the address
  }
  std::uint16_t number = 0;
  const char* const end = parts.port.data() + parts.port.size();
  const auto read = std::from_chars(parts.port.data(), end, number);
  if (parts.host.empty() || read.ec != std::errc{} || read.ptr != end || number == 0) {
    return failure(NetError::Kind::kBadSetting,
                   named_by + ": \"" + text + "\" is no HOST:PORT, such as 192.0.2.7:47474 or [2001:db8::7]:47474");
  }
  return parts;
}

std::expected<std::unique_ptr<Transport>, NetError> open_unicast(asio::io_context& io, const HostClock& clock,
                                                                 const TransportOptions& options) {
  const MulticastOptions& m = options.multicast;
  const IpFamily family = m.groups.base.is_v4() ? IpFamily::kV4 : IpFamily::kV6;
  auto seeds = resolve_peers(options.peers, family);
  if (!seeds) return std::unexpected(seeds.error());
  return UnicastFanOut::open(io, clock,
                             {.family = family,
                              .interface = m.interface,
                              .port = m.groups.port,
                              .seeds = *std::move(seeds),
                              .key = options.key,
                              .seal = options.greetings,
                              .dscp = m.dscp,
                              .receive_buffer_bytes = m.receive_buffer_bytes});
}

std::expected<OpenedTransport, NetError> open_relay(asio::io_context& io, const HostClock& clock,
                                                    const TransportOptions& options) {
  const MulticastOptions& m = options.multicast;
  const IpFamily family = m.groups.base.is_v4() ? IpFamily::kV4 : IpFamily::kV6;
  auto relays = resolve_peers(options.relays, family, "transport.relays");
  if (!relays) return std::unexpected(relays.error());
  auto opened = RelayTransport::open(io, clock,
                                     {.family = family,
                                      .relays = *std::move(relays),
                                      .key = options.key,
                                      .seal = options.greetings,
                                      .dscp = m.dscp,
                                      .receive_buffer_bytes = m.receive_buffer_bytes});
  if (!opened) return std::unexpected(opened.error());
  return OpenedTransport{*std::move(opened), {}};
}

}  // namespace

std::expected<std::vector<udp::endpoint>, NetError> resolve_peers(const std::vector<std::string>& peers,
                                                                  IpFamily family, const std::string& named_by) {
  asio::io_context io(1);
  udp::resolver resolver(io);
  std::vector<udp::endpoint> found;
  for (const std::string& peer : peers) {
    const auto parts = split(peer, named_by);
    if (!parts) return std::unexpected(parts.error());
    boost::system::error_code ec;
    const auto addresses = resolver.resolve(family == IpFamily::kV4 ? udp::v4() : udp::v6(), parts->host, parts->port,
                                            udp::resolver::numeric_service, ec);
    if (ec || addresses.empty()) {
      return failure(NetError::Kind::kOther,
                     named_by + ": \"" + peer + "\" has no " + (family == IpFamily::kV4 ? "IPv4" : "IPv6") +
                         " address: " + ec.message() + "; unicast takes the family of transport.group");
    }
    found.push_back(addresses.begin()->endpoint());
  }
  return found;
}

namespace {

// Whether unicast may work where multicast failed for that reason. It does not mend a wrong setting.
bool unicast_may_do(NetError::Kind kind) {
  return kind == NetError::Kind::kNoMulticast || kind == NetError::Kind::kLimit || kind == NetError::Kind::kOther;
}

// Returns the reason for unicast; empty where multicast is to be used.
std::expected<std::string, NetError> why_unicast(const HostClock& clock, const TransportOptions& options) {
  if (options.use == MulticastUse::kAlways) return "";
  if (options.use == MulticastUse::kNever) return "transport.multicast says so";
  const auto probe = probe_multicast(clock, options.multicast);
  if (probe) {
    // lo is the last resort where no interface is configured; a configuration that lists peers means to reach them.
    const bool only_loopback = options.multicast.interface.empty() && probe->over.interface.loopback;
    return only_loopback && !options.peers.empty() ? probe->over.why : "";
  }
  if (!unicast_may_do(probe.error().kind)) return std::unexpected(probe.error());
  if (options.peers.empty()) {
    return failure(probe.error().kind,
                   probe.error().sentence + ", or list other peers' addresses in transport.peers for unicast");
  }
  return probe.error().sentence;
}

}  // namespace

std::expected<OpenedTransport, NetError> open_transport(asio::io_context& io, const HostClock& clock,
                                                        const TransportOptions& options) {
  if (!options.relays.empty()) return open_relay(io, clock, options);
  auto why = why_unicast(clock, options);
  if (!why) return std::unexpected(why.error());
  if (why->empty()) {
    auto opened = MulticastSocket::open(io, clock, options.multicast);
    if (!opened) return std::unexpected(opened.error());
    const ChosenInterface& over = (*opened)->chosen_interface();
    const bool only_here = options.multicast.interface.empty() && over.interface.loopback;
    std::string why_only_here = only_here ? over.why : "";
    auto member =
        std::make_unique<IslandMember>(clock, *std::move(opened),
                                       IslandMember::Options{.key = options.key,
                                                             .seal = options.greetings,
                                                             .v4 = options.multicast.groups.base.is_v4(),
                                                             .group_offset = options.multicast.groups.offset});
    return OpenedTransport{std::move(member), {}, std::move(why_only_here)};
  }
  auto opened = open_unicast(io, clock, options);
  if (!opened) return std::unexpected(opened.error());
  return OpenedTransport{*std::move(opened), *std::move(why)};
}

}  // namespace peerd::net
