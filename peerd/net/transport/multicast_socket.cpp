#include "peerd/net/transport/multicast_socket.hpp"

#include <linux/filter.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>

#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/os/close_on_exec.hpp"
#include "peerd/net/os/udp_socket.hpp"

// linux/in6.h defines it since Linux 4.20, but cannot be included beside netinet/in.h.
#ifndef IPV6_MULTICAST_ALL
#define IPV6_MULTICAST_ALL 29
#endif

namespace peerd::net {
namespace {

using asio::ip::udp;
using boost::system::error_code;

IpFamily family_of(const GroupPlan& groups) { return groups.base.is_v4() ? IpFamily::kV4 : IpFamily::kV6; }

// A datagram begins with its region where regions share groups.
std::size_t most_bytes(const GroupPlan& groups) {
  return kMaxDatagramBytes + (groups.pool > 0 ? kRegionHeaderBytes : 0);
}

// Lets other sockets bind the socket's port from now on. Where the system chooses the port, this must follow the bind:
// the system may give the same port to two sockets that share it.
std::expected<void, NetError> share_port(int fd) {
  return set_options(fd, std::array<SocketOption, 1>{{{SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR"}}});
}

}  // namespace

std::optional<std::size_t> memberships_limit(IpFamily family) {
  if (family == IpFamily::kV6) return std::nullopt;  // limited by memory, net.core.optmem_max
  std::size_t limit = 0;
  if (!(std::ifstream("/proc/sys/net/ipv4/igmp_max_memberships") >> limit)) return std::nullopt;
  return limit;
}

std::expected<std::unique_ptr<MulticastSocket>, NetError> MulticastSocket::open(asio::io_context& io,
                                                                                const HostClock& clock,
                                                                                const MulticastOptions& options) {
  GroupPlan checked = options.groups;
  if (options.any_port) checked.port = 1;
  if (auto good = check_plan(checked); !good) return std::unexpected(good.error());
  if (options.ttl < 0 || options.ttl > 255) {
    return failure(NetError::Kind::kBadSetting, "a TTL is a number of hops from 0 to 255, not " +
                                                    std::to_string(options.ttl) + "; 1 stays on the LAN");
  }
  if (options.dscp < 0 || options.dscp > 63) {
    return failure(NetError::Kind::kBadSetting, "a DSCP is a number from 0 to 63, not " + std::to_string(options.dscp));
  }
  const auto interfaces = list_interfaces();
  if (!interfaces) return std::unexpected(interfaces.error());
  auto chosen = choose_interface(*interfaces, options.interface, family_of(options.groups));
  if (!chosen) return std::unexpected(chosen.error());

  std::unique_ptr<MulticastSocket> opened(new MulticastSocket(io, clock, options, *std::move(chosen)));
  if (!options.receives_own_datagrams) {
    if (auto good = opened->add_sender(); !good) return std::unexpected(good.error());
  }
  if (auto good = opened->add_socket(); !good) return std::unexpected(good.error());
  if (auto good = opened->probe_route(); !good) return std::unexpected(good.error());
  return opened;
}

MulticastSocket::MulticastSocket(asio::io_context& io, const HostClock& clock, const MulticastOptions& options,
                                 ChosenInterface chosen)
    : io_(io),
      options_(options),
      chosen_(std::move(chosen)),
      reading_(clock, counters_, most_bytes(options.groups)),
      memberships_max_(memberships_limit(family_of(options.groups)).value_or(std::numeric_limits<std::size_t>::max())),
      queue_(most_bytes(options.groups)) {
  filtered_by_.reserve(kBatch);
}

// The sender is bound to a port of its own. Nothing is read from it.
std::expected<void, NetError> MulticastSocket::add_sender() {
  udp::socket& socket = sender_.emplace(io_);
  if (auto good = open_udp(socket, {options_.groups.base.is_v4(), options_.dscp, 0}); !good) return good;
  if (auto good = configure(socket.native_handle()); !good) return good;
  if (auto good = bind_udp(socket, 0, "end a program that uses many"); !good) return good;
  return share_port(socket.native_handle());
}

// Makes the kernel drop the sender's datagrams before they are queued, by their source port and because they are from
// this computer. The filter is a classic BPF program, which sees a datagram from its UDP header on (sk_filter); 0 drops
// it.
std::expected<void, NetError> MulticastSocket::filter_own_datagrams(int fd) const {
  constexpr std::uint32_t kAll = 0xffffffff;
  const std::uint32_t port = sender_->local_endpoint().port();
  std::array<sock_filter, 6> program{{
      BPF_STMT(BPF_LD | BPF_H | BPF_ABS, 0),  // the source port
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, port, 0, 2),
      // On lo every datagram is of this computer; elsewhere the copy that loops back is marked.
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_PKTTYPE)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_LOOPBACK, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, kAll),
      BPF_STMT(BPF_RET | BPF_K, 0),
  }};
  if (chosen_.interface.loopback) program[2] = BPF_STMT(BPF_LD | BPF_IMM, PACKET_LOOPBACK);
  const sock_fprog filter{program.size(), program.data()};
  if (const int error = set_option(fd, SOL_SOCKET, SO_ATTACH_FILTER, filter)) {
    return failure(NetError::Kind::kOther, "the system refuses socket option SO_ATTACH_FILTER: " + text_of(error));
  }
  return {};
}

// All sockets share one port. The kernel delivers a datagram to each socket that has joined its group, and one socket
// joins each group.
std::expected<void, NetError> MulticastSocket::add_socket() {
  auto made = std::make_unique<Socket>(io_, reading_);
  udp::socket& socket = made->receiver.socket();
  GroupPlan& groups = options_.groups;
  const UdpOptions wanted{groups.base.is_v4(), options_.dscp, options_.receive_buffer_bytes};
  if (auto good = open_udp(socket, wanted); !good) return good;
  if (auto good = configure(socket.native_handle()); !good) return good;
  if (sender_) {
    if (auto good = filter_own_datagrams(socket.native_handle()); !good) return good;
  }
  const bool choose_port = options_.any_port && sockets_.empty();
  if (!choose_port) {
    if (auto good = share_port(socket.native_handle()); !good) return good;
  }
  if (auto good = bind_udp(socket, choose_port ? 0 : groups.port, options_.if_port_is_taken); !good) return good;
  if (choose_port) {
    groups.port = socket.local_endpoint().port();
    if (auto good = share_port(socket.native_handle()); !good) return good;
  }
  sockets_.push_back(std::move(made));
  if (handler_) start(*sockets_.back());
  return {};
}

// The reason for each option is in README.md.
std::expected<void, NetError> MulticastSocket::configure(int fd) const {
  const std::array<SocketOption, 3> v4{{{IPPROTO_IP, IP_MULTICAST_ALL, 0, "IP_MULTICAST_ALL"},
                                        {IPPROTO_IP, IP_MULTICAST_LOOP, 1, "IP_MULTICAST_LOOP"},
                                        {IPPROTO_IP, IP_MULTICAST_TTL, options_.ttl, "IP_MULTICAST_TTL"}}};
  const std::array<SocketOption, 3> v6{{{IPPROTO_IPV6, IPV6_MULTICAST_ALL, 0, "IPV6_MULTICAST_ALL"},
                                        {IPPROTO_IPV6, IPV6_MULTICAST_LOOP, 1, "IPV6_MULTICAST_LOOP"},
                                        {IPPROTO_IPV6, IPV6_MULTICAST_HOPS, options_.ttl, "IPV6_MULTICAST_HOPS"}}};
  if (auto good = options_.groups.base.is_v4() ? set_options(fd, v4) : set_options(fd, v6); !good) return good;
  // A vanished interface is no error: follow_interface() sets the option once the interface is back.
  if (const int error = send_over_our_interface(fd); error && !interface_was_replaced()) {
    return failure(NetError::Kind::kNoMulticast, "cannot send multicast over \"" + chosen_.interface.name +
                                                     "\": " + text_of(error) + "; name another interface");
  }
  return {};
}

// Asks the routing table from which address a datagram would leave. Connecting a UDP socket sends nothing; the probe is
// a socket of its own, because a connected socket receives from its peer only.
int MulticastSocket::find_own_address() {
  error_code ec;
  udp::socket probe(io_);
  probe.open(options_.groups.base.is_v4() ? udp::v4() : udp::v6(), ec);
  if (ec) return ec.value();
  close_on_exec(probe);
  if (const int error = send_over_our_interface(probe.native_handle())) return error;
  probe.connect(on_our_interface(udp::endpoint(options_.groups.base, options_.groups.port)), ec);
  if (ec) return ec.value();
  const auto own = probe.local_endpoint(ec).address();
  if (!ec) own_address_ = own;
  return ec.value();
}

// Now, so that not every send fails later.
std::expected<void, NetError> MulticastSocket::probe_route() {
  const int reason = find_own_address();
  if (reason == 0) return {};
  const std::string where =
      "cannot multicast to " + options_.groups.base.to_string() + " over \"" + chosen_.interface.name + "\"";
  if (options_.groups.base.is_v6()) {
    return failure(
        NetError::Kind::kNoMulticast,
        where + ": " + text_of(reason) +
            (chosen_.interface.loopback ? "; lo carries no IPv6 multicast: use an IPv4 group such as "
                                          "239.192.0.0, or name an interface that reaches other computers"
                                        : "; use an IPv4 group such as 239.192.0.0 or name another interface"));
  }
  return failure(NetError::Kind::kNoMulticast, where + ": " + text_of(reason) + "; name another interface");
}

int MulticastSocket::receive_buffer_bytes() const {
  return granted_receive_buffer(sockets_.front()->receiver.socket());
}

std::string MulticastSocket::describe() const {
  const GroupPlan& groups = options_.groups;
  std::string regions;
  if (groups.pool > 0) {
    regions = " and on, " + std::to_string(groups.pool);
  } else if (const auto first = group_endpoint(groups, RegionId{1}); first && groups.offset > 0) {
    regions = ", of regions from " + first->address().to_string() + " on,";
  }
  return "group " + groups.base.to_string() + regions + " port " + std::to_string(groups.port) + " over " + chosen_.why;
}

std::expected<void, NetError> MulticastSocket::join(RegionId region) {
  if (joined_.contains(region)) return {};
  const auto group = group_endpoint(options_.groups, region);
  if (!group) return std::unexpected(group.error());
  const std::uint32_t number = group_number(options_.groups, region);
  auto membership = memberships_.find(number);
  if (membership == memberships_.end()) {
    const auto socket = add_membership(region, group->address());
    if (!socket) return std::unexpected(socket.error());
    membership = memberships_.emplace(number, Membership{*socket, group->address()}).first;
  }
  ++membership->second.regions;
  joined_.insert(region);
  return {};
}

// The kernel's limit may have been lowered since the start, or may count memory. So a socket that is unexpectedly full
// is no error as long as a new socket can join the group.
std::expected<MulticastSocket::Socket*, NetError> MulticastSocket::add_membership(RegionId region,
                                                                                  const asio::ip::address& group) {
  for (const auto& socket : sockets_) {
    if (socket->memberships >= memberships_max_) continue;
    const int error = change_membership(*socket, true, group);
    if (error == ENOBUFS || error == ENOMEM) continue;
    // A vanished interface is no error: follow_interface() joins the group once the interface is back.
    if (error && !interface_was_replaced()) return std::unexpected(join_error(region, error));
    ++socket->memberships;
    return socket.get();
  }
  if (auto good = add_socket(); !good) return std::unexpected(good.error());
  Socket& added = *sockets_.back();
  if (const int error = change_membership(added, true, group); error && !interface_was_replaced()) {
    sockets_.pop_back();
    return std::unexpected(join_error(region, error));
  }
  ++added.memberships;
  return &added;
}

std::expected<void, NetError> MulticastSocket::leave(RegionId region) {
  if (joined_.erase(region) == 0) return {};
  const auto membership = memberships_.find(group_number(options_.groups, region));
  assert(membership != memberships_.end());
  if (--membership->second.regions > 0) return {};
  Socket& socket = *membership->second.socket;
  const asio::ip::address group = membership->second.group;
  memberships_.erase(membership);
  --socket.memberships;
  if (const int error = change_membership(socket, false, group); error && !interface_was_replaced()) {
    return failure(NetError::Kind::kOther, "cannot leave multicast group " + group.to_string() + " on \"" +
                                               chosen_.interface.name + "\": " + text_of(error) +
                                               "; its datagrams are dropped here all the same");
  }
  return {};
}

void MulticastSocket::follow_world(std::uint32_t group_offset) {
  assert(std::ranges::all_of(joined_, [](RegionId region) { return region == RegionId{0}; }));
  options_.groups.offset = group_offset;
}

std::optional<InterfaceChange> MulticastSocket::follow_interface() {
  if (auto change = leave_loopback()) return change;
  const std::string name = "interface \"" + chosen_.interface.name + '"';
  const auto index = index_of(chosen_.interface.name);
  if (!index) return say_unseen(index.error());
  interface_unseen_ = false;
  if (*index == chosen_.interface.index && !interface_gone_) {
    (void)find_own_address();  // where there is none at present, the last one stays
    return std::nullopt;
  }
  Interface anew = chosen_.interface;
  anew.index = *index;
  const int error = *index == 0 ? ENODEV : switch_to(anew);
  const bool was_gone = std::exchange(interface_gone_, error != 0);
  if (error == 0) return InterfaceChange{true, name + " is another one by now: goes on over that"};
  if (was_gone) return std::nullopt;
  return InterfaceChange{false, name + " is gone (" + text_of(error) + "): nothing is sent or heard until it is back"};
}

// Asking takes a descriptor: a process that has none left learns nothing of its interface, which may be there.
std::optional<InterfaceChange> MulticastSocket::say_unseen(int error) {
  if (std::exchange(interface_unseen_, true)) return std::nullopt;
  return InterfaceChange{false,
                         "cannot ask the system for interface \"" + chosen_.interface.name + "\": " + text_of(error)};
}

// A peer that was started before the network is on lo, which reaches nobody else. Nobody has named an interface: it
// goes over to the one that it would begin with now.
std::optional<InterfaceChange> MulticastSocket::leave_loopback() {
  if (!options_.interface.empty() || !chosen_.interface.loopback) return std::nullopt;
  const auto interfaces = list_interfaces();
  if (!interfaces) return std::nullopt;
  auto chosen = choose_interface(*interfaces, {}, family_of(options_.groups));
  if (!chosen) return std::nullopt;
  if (chosen->interface.loopback) {
    chosen_.why = std::move(chosen->why);  // for another reason than before, perhaps
    return std::nullopt;
  }
  const int error = switch_to(chosen->interface);
  chosen_ = *std::move(chosen);
  interface_gone_ = error != 0;
  if (error == 0) return InterfaceChange{true, "the network is there by now: goes over from lo to " + chosen_.why};
  return InterfaceChange{false, "cannot go over from lo to " + chosen_.why + ": " + text_of(error)};
}

std::string MulticastSocket::why_only_here() const {
  return options_.interface.empty() && chosen_.interface.loopback ? chosen_.why : "";
}

bool MulticastSocket::interface_was_replaced() const {
  const auto index = index_of(chosen_.interface.name);
  return index && *index != chosen_.interface.index;
}

// The memberships vanished with the old interface, but the sockets count them until they leave the groups.
int MulticastSocket::switch_to(const Interface& interface) {
  const auto change_all = [this](bool join) {
    int error = 0;
    for (const auto& [number, membership] : memberships_) {
      const int failed = change_membership(*membership.socket, join, membership.group);
      if (error == 0) error = failed;
    }
    return error;
  };
  (void)change_all(false);  // fails for groups that were joined while the interface was gone
  chosen_.interface = interface;
  if (const int error = sender_ ? send_over_our_interface(sender_->native_handle()) : 0) return error;
  for (const auto& socket : sockets_) {
    const int fd = socket->receiver.socket().native_handle();
    if (const int error = send_over_our_interface(fd)) return error;
    if (sender_ && !filter_own_datagrams(fd)) return EIO;
  }
  const int error = change_all(true);
  if (error == 0) (void)find_own_address();
  return error;
}

// Sets the interface by its index, as change_membership() does: addresses change, and an interface may have none.
int MulticastSocket::send_over_our_interface(int fd) const {
  const int index = static_cast<int>(chosen_.interface.index);
  if (options_.groups.base.is_v6()) return set_option(fd, IPPROTO_IPV6, IPV6_MULTICAST_IF, index);
  ip_mreqn outgoing{};
  outgoing.imr_ifindex = index;
  // Linux does not choose lo's own address as the source of multicast: datagrams would come from another interface's
  // address, or from 0.0.0.0 where there is none. For other interfaces the kernel chooses, again after each change.
  if (chosen_.interface.loopback) outgoing.imr_address.s_addr = htonl(INADDR_LOOPBACK);
  return set_option(fd, IPPROTO_IP, IP_MULTICAST_IF, outgoing);
}

int MulticastSocket::change_membership(Socket& socket, bool join, const asio::ip::address& group) {
  const int fd = socket.receiver.socket().native_handle();
  if (group.is_v4()) {
    ip_mreqn request{};
    request.imr_multiaddr.s_addr = htonl(group.to_v4().to_uint());
    request.imr_ifindex = static_cast<int>(chosen_.interface.index);
    return set_option(fd, IPPROTO_IP, join ? IP_ADD_MEMBERSHIP : IP_DROP_MEMBERSHIP, request);
  }
  ipv6_mreq request{};
  const auto bytes = group.to_v6().to_bytes();
  std::memcpy(&request.ipv6mr_multiaddr, bytes.data(), bytes.size());
  request.ipv6mr_interface = chosen_.interface.index;
  return set_option(fd, IPPROTO_IPV6, join ? IPV6_ADD_MEMBERSHIP : IPV6_DROP_MEMBERSHIP, request);
}

NetError MulticastSocket::join_error(RegionId region, int error) const {
  const std::string what = "cannot join the multicast group of region " + std::to_string(region.value) + " on \"" +
                           chosen_.interface.name + "\": ";
  if (error == ENOBUFS || error == ENOMEM) {
    const char* setting = options_.groups.base.is_v4() ? "net.ipv4.igmp_max_memberships" : "net.core.optmem_max";
    return {NetError::Kind::kLimit,
            what + "the system lets a socket join none (" + setting + "); raise it with sysctl -w"};
  }
  if (error == ENODEV)
    return {NetError::Kind::kNoMulticast, what + "the interface is gone; bring it back or name another"};
  return {NetError::Kind::kOther, what + text_of(error)};
}

// An IPv6 group of link-local scope is incomplete without its interface; wider scopes ignore the index.
udp::endpoint MulticastSocket::on_our_interface(const udp::endpoint& group) const {
  if (group.address().is_v4()) return group;
  return {asio::ip::address_v6(group.address().to_v6().to_bytes(), chosen_.interface.index), group.port()};
}

void MulticastSocket::send(RegionId region, std::span<const std::byte> datagram) {
  if (datagram.size() > kMaxDatagramBytes) {
    ++counters_.out_too_large;
    return;
  }
  const auto group = group_endpoint(options_.groups, region);
  if (!group) {
    ++counters_.out_no_group;
    return;
  }
  if (queue_.full()) flush();
  const auto header = region_header(region);
  queue_.push(on_our_interface(*group), std::span(header).first(options_.groups.pool > 0 ? header.size() : 0),
              datagram);
  if (!sender_) return;
  const auto membership = memberships_.find(group_number(options_.groups, region));
  filtered_by_.push_back(membership == memberships_.end() ? nullptr : &membership->second.socket->receiver);
}

void MulticastSocket::flush() {
  const auto refused = queue_.flush(native_handle(), counters_);
  for (std::size_t i = 0; i < filtered_by_.size(); ++i) {
    if (filtered_by_[i] != nullptr && !refused.test(i)) filtered_by_[i]->on_filtered();
  }
  filtered_by_.clear();
}

void MulticastSocket::on_receive(ReceiveHandler handler) {
  assert(handler && !handler_);
  handler_ = std::move(handler);
  for (const auto& socket : sockets_) start(*socket);
}

void MulticastSocket::start(Socket& socket) {
  socket.receiver.start([this](const Received& received, HostTime at) { take(received, at); });
}

bool MulticastSocket::receive_pending() {
  bool any = false;
  // The loop uses indices, because the handler may join a region, which may add a socket.
  for (std::size_t i = 0; i < sockets_.size(); ++i) any |= sockets_[i]->receiver.read();
  return any;
}

void MulticastSocket::take(const Received& received, HostTime at) {
  if (received.truncated) {
    ++counters_.in_truncated;
    return;
  }
  if (!received.to) {
    ++counters_.in_no_destination;
    return;
  }
  // The kernel matches the group of an IPv6 datagram with the socket's groups, but not its interface.
  if (received.interface_index != chosen_.interface.index) {
    ++counters_.in_other_interface;
    return;
  }
  const auto group = group_number(options_.groups, *received.to);
  if (!group || !memberships_.contains(*group)) {
    ++counters_.in_other_group;
    return;
  }
  std::optional<RegionId> region = region_of_group(options_.groups, *group);
  std::span<const std::byte> datagram = received.bytes;
  if (options_.groups.pool > 0) {
    const auto named_region = read_region_header(datagram);
    if (!named_region || group_number(options_.groups, *named_region) != *group) {
      ++counters_.in_malformed;
      return;
    }
    if (!joined_.contains(*named_region)) {
      ++counters_.in_other_region;
      return;
    }
    region = named_region;
    datagram = datagram.subspan(kRegionHeaderBytes);
  }
  assert(region);  // the sockets join groups of regions only
  ++counters_.packets_in;
  counters_.bytes_in += received.bytes.size();
  handler_({*region, datagram, at, received.from});
}

}  // namespace peerd::net
