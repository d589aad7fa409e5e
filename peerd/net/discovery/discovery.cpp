#include "peerd/net/discovery/discovery.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace peerd::discovery {
namespace {

// Beside the default group of sessions and its port (net::TransportSettings): of the organisation-local scope of
// RFC 2365, and for IPv6 of the site's, chosen by us (RFC 4291: flag T).
constexpr const char* kGroup4 = "239.192.79.255";
constexpr const char* kGroup6 = "ff15::7065:6572:64";
constexpr std::uint16_t kPort = 47473;
// The port is the same for all worlds and peers: another one would not do.
constexpr const char* kIfPortIsTaken = "join by the address that the log of a peer says (peerd join --from HOST:PORT)";
constexpr RegionId kAll{0};
// More peers than a network has, and than a computer runs, unless a forger invents them.
constexpr std::size_t kFoundMax = 4096, kFoundAtOneMax = 512;
// A question or an answer may get lost.
constexpr Duration kAskedAgainAfter = std::chrono::milliseconds(200);

}  // namespace

net::GroupPlan group_for(const boost::asio::ip::address& session_group) {
  return {.base = boost::asio::ip::make_address(session_group.is_v4() ? kGroup4 : kGroup6), .port = kPort};
}

std::expected<std::unique_ptr<Responder>, net::NetError> Responder::open(boost::asio::io_context& io,
                                                                         const net::HostClock& clock,
                                                                         net::MulticastOptions options,
                                                                         std::function<Beacon()> beacon) {
  options.groups = group_for(options.groups.base);
  options.if_port_is_taken = kIfPortIsTaken;
  options.receives_own_datagrams = false;
  auto socket = net::MulticastSocket::open(io, clock, options);
  if (!socket) return std::unexpected(socket.error());
  if (auto joined = (*socket)->join(kAll); !joined) return std::unexpected(joined.error());
  std::unique_ptr<Responder> responder(new Responder(std::move(beacon)));
  responder->socket_ = *std::move(socket);
  responder->socket_->on_receive([self = responder.get()](const net::Arrival& arrival) { self->on_datagram(arrival); });
  return responder;
}

void Responder::on_datagram(const net::Arrival& arrival) {
  if (!is_question(arrival.datagram)) return;
  if (answered_at_ && arrival.at - *answered_at_ < kAnswersApart) return;
  answered_at_ = arrival.at;
  socket_->send(kAll, encode(beacon_()));
  socket_->flush();
}

std::expected<Asked, net::NetError> ask_who_is_here(const net::HostClock& clock, net::MulticastOptions options,
                                                    Duration time) {
  boost::asio::io_context io(1);
  options.groups = group_for(options.groups.base);
  options.if_port_is_taken = kIfPortIsTaken;
  const auto socket = net::MulticastSocket::open(io, clock, options);
  if (!socket) return std::unexpected(socket.error());
  if (auto joined = (*socket)->join(kAll); !joined) return std::unexpected(joined.error());
  // A beacon proves nothing: one from elsewhere, or of another process, never takes another's place.
  using Key = std::tuple<std::string, std::uint64_t, bool, PeerId, boost::asio::ip::address, std::uint16_t>;
  std::map<Key, Found> found;
  std::map<boost::asio::ip::address, std::size_t> found_at;
  (*socket)->on_receive([&](const net::Arrival& arrival) {
    const auto beacon = decode(arrival.datagram);
    if (!beacon) return;
    const auto at = arrival.from.address();
    const Key key(beacon->world, beacon->session, !beacon->sealed, beacon->peer, at, beacon->snapshot_port);
    if (!found.contains(key)) {
      if (found.size() >= kFoundMax || found_at[at] >= kFoundAtOneMax) return;
      ++found_at[at];
    }
    Found& known = found[key];
    if (beacon->incarnation >= known.beacon.incarnation) known = {*beacon, at};
  });
  const HostTime end = clock.now() + time;
  for (HostTime at = clock.now(); at < end; at += kAskedAgainAfter) {
    (*socket)->send(kAll, question());
    (*socket)->flush();
    const HostTime until = std::min(end, at + kAskedAgainAfter);
    while (clock.now() < until) io.run_one_for(until - clock.now());
  }
  Asked asked{{}, (*socket)->describe()};
  for (auto& [key, each] : found) asked.found.push_back(std::move(each));
  return asked;
}

}  // namespace peerd::discovery
