#include "peerd/net/multicast_socket.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <cassert>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <system_error>
#include <utility>

// linux/in6.h has it since 4.20, but cannot be included beside netinet/in.h
#ifndef IPV6_MULTICAST_ALL
#define IPV6_MULTICAST_ALL 29
#endif

namespace peerd::net {
namespace {

using asio::ip::udp;
using boost::system::error_code;

// Datagrams read in one go before timers and signals get their turn; the rest stays in the kernel's queue.
constexpr int kMaxReadsPerWake = 64;

// What recvmsg may put beside a datagram: where it was sent to, and how many were lost before it.
constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(in6_pktinfo)) + CMSG_SPACE(sizeof(std::uint32_t));

std::string text_of(int error) { return std::generic_category().message(error); }

std::unexpected<NetError> fail(NetError::Kind kind, std::string sentence) {
  return std::unexpected(NetError{kind, std::move(sentence)});
}

IpFamily family_of(const GroupPlan& groups) { return groups.base.is_v4() ? IpFamily::kV4 : IpFamily::kV6; }

template <class Value>
int set_option(int fd, int level, int name, const Value& value) {
  return setsockopt(fd, level, name, &value, sizeof value) == 0 ? 0 : errno;
}

SendDrop drop_of(int error) {
  switch (error) {
    case EAGAIN:
    case ENOBUFS:
    case ENOMEM:
      return SendDrop::kQueueFull;
    case ENETUNREACH:
    case EHOSTUNREACH:
    case ENETDOWN:
    case ENODEV:
    case ENXIO:
    case EADDRNOTAVAIL:
      return SendDrop::kUnreachable;
    case EPERM:
    case EACCES:
      return SendDrop::kBlocked;
    case EMSGSIZE:
      return SendDrop::kTooLarge;
    default:
      return SendDrop::kOther;
  }
}

std::uint64_t& counter_of(TrafficCounters& counters, SendDrop drop) {
  switch (drop) {
    case SendDrop::kQueueFull:
      return counters.out_queue_full;
    case SendDrop::kUnreachable:
      return counters.out_unreachable;
    case SendDrop::kBlocked:
      return counters.out_blocked;
    case SendDrop::kTooLarge:
      return counters.out_too_large;
    case SendDrop::kNoGroup:
      return counters.out_no_group;
    case SendDrop::kOther:
      break;
  }
  return counters.out_errors;
}

// Where a datagram was sent to, read from the control messages beside it.
struct Destination {
  std::optional<asio::ip::address> group;
  unsigned interface_index = 0;
  std::optional<std::uint32_t> lost_before;  // by this socket since it was opened, modulo 2^32; none when none
};

// The structures are copied out: a control message's data is aligned for its header only.
template <class Value>
Value data_of(const cmsghdr* control) {
  Value value;
  std::memcpy(&value, CMSG_DATA(control), sizeof value);
  return value;
}

Destination destination_of(msghdr& message) {
  Destination to;
  for (cmsghdr* control = CMSG_FIRSTHDR(&message); control; control = CMSG_NXTHDR(&message, control)) {
    if (control->cmsg_level == IPPROTO_IP && control->cmsg_type == IP_PKTINFO) {
      const auto info = data_of<in_pktinfo>(control);
      to.group = asio::ip::address_v4(ntohl(info.ipi_addr.s_addr));
      to.interface_index = static_cast<unsigned>(info.ipi_ifindex);
    } else if (control->cmsg_level == IPPROTO_IPV6 && control->cmsg_type == IPV6_PKTINFO) {
      const auto info = data_of<in6_pktinfo>(control);
      to.group = asio::ip::address_v6(std::to_array(info.ipi6_addr.s6_addr));
      to.interface_index = info.ipi6_ifindex;
    } else if (control->cmsg_level == SOL_SOCKET && control->cmsg_type == SO_RXQ_OVFL) {
      to.lost_before = data_of<std::uint32_t>(control);
    }
  }
  return to;
}

}  // namespace

std::expected<std::unique_ptr<MulticastSocket>, NetError> MulticastSocket::open(asio::io_context& io,
                                                                                const MulticastOptions& options) {
  if (auto good = check_plan(options.groups); !good) return std::unexpected(good.error());
  if (options.ttl < 0 || options.ttl > 255) {
    return fail(NetError::Kind::kBadSetting,
                "a TTL is a number of hops from 0 to 255, not " + std::to_string(options.ttl) + "; 1 stays on the LAN");
  }
  const auto interfaces = list_interfaces();
  if (!interfaces) return std::unexpected(interfaces.error());
  auto chosen = choose_interface(*interfaces, options.interface, family_of(options.groups));
  if (!chosen) return std::unexpected(chosen.error());

  std::unique_ptr<MulticastSocket> opened(new MulticastSocket(io, options.groups, *std::move(chosen)));
  if (auto good = opened->configure(options); !good) return std::unexpected(good.error());
  if (auto good = opened->bind_port(); !good) return std::unexpected(good.error());
  if (auto good = opened->probe_route(); !good) return std::unexpected(good.error());
  return opened;
}

MulticastSocket::MulticastSocket(asio::io_context& io, GroupPlan groups, ChosenInterface chosen)
    : groups_(std::move(groups)), chosen_(std::move(chosen)), socket_(io) {}

// Each option's reason is in README.md.
std::expected<void, NetError> MulticastSocket::configure(const MulticastOptions& options) {
  const bool v4 = groups_.base.is_v4();
  error_code ec;
  socket_.open(v4 ? udp::v4() : udp::v6(), ec);
  if (ec.value() == EAFNOSUPPORT) {
    return fail(NetError::Kind::kNoMulticast,
                "this computer has IPv6 switched off; use an IPv4 group such as 239.192.0.0");
  }
  if (ec.value() == EMFILE || ec.value() == ENFILE) {
    return fail(NetError::Kind::kLimit, "no file descriptor left for a socket; raise the limit (ulimit -n)");
  }
  if (ec.value() == EPERM || ec.value() == EACCES) {
    return fail(NetError::Kind::kPermission, "the system does not let this process open a UDP socket: " + ec.message());
  }
  if (ec) return fail(NetError::Kind::kOther, "cannot open a UDP socket: " + ec.message());
  socket_.non_blocking(true, ec);
  if (ec) return fail(NetError::Kind::kOther, "cannot make a socket non-blocking: " + ec.message());

  const int fd = socket_.native_handle();
  struct Option {
    int level, name, value;
    const char* text;
  };
  const auto set_all = [&](std::initializer_list<Option> table) -> std::expected<void, NetError> {
    for (const auto& [level, name, value, text] : table) {
      if (const int error = set_option(fd, level, name, value)) {
        return fail(NetError::Kind::kOther, std::string("the system refuses socket option ") + text + ": " +
                                                text_of(error) + "; Linux 4.20 or later is needed");
      }
    }
    return {};
  };
  if (auto good = set_all({{SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR"}, {SOL_SOCKET, SO_RXQ_OVFL, 1, "SO_RXQ_OVFL"}});
      !good) {
    return good;
  }
  auto good = v4 ? set_all({{IPPROTO_IP, IP_MULTICAST_ALL, 0, "IP_MULTICAST_ALL"},
                            {IPPROTO_IP, IP_MULTICAST_LOOP, 1, "IP_MULTICAST_LOOP"},
                            {IPPROTO_IP, IP_MULTICAST_TTL, options.ttl, "IP_MULTICAST_TTL"},
                            {IPPROTO_IP, IP_PKTINFO, 1, "IP_PKTINFO"}})
                 : set_all({{IPPROTO_IPV6, IPV6_V6ONLY, 1, "IPV6_V6ONLY"},
                            {IPPROTO_IPV6, IPV6_MULTICAST_ALL, 0, "IPV6_MULTICAST_ALL"},
                            {IPPROTO_IPV6, IPV6_MULTICAST_LOOP, 1, "IPV6_MULTICAST_LOOP"},
                            {IPPROTO_IPV6, IPV6_MULTICAST_HOPS, options.ttl, "IPV6_MULTICAST_HOPS"},
                            {IPPROTO_IPV6, IPV6_RECVPKTINFO, 1, "IPV6_RECVPKTINFO"}});
  if (!good) return good;

  if (const int error = send_over_our_interface(fd)) {
    return fail(NetError::Kind::kNoMulticast, "cannot send multicast over \"" + chosen_.interface.name +
                                                  "\": " + text_of(error) + "; name another interface");
  }
  // Asked, not demanded: the kernel caps it without a word, and receive_buffer_bytes() tells what came of it.
  socket_.set_option(asio::socket_base::receive_buffer_size(options.receive_buffer_bytes), ec);
  return {};
}

std::expected<void, NetError> MulticastSocket::bind_port() {
  error_code ec;
  socket_.bind(udp::endpoint(groups_.base.is_v4() ? udp::v4() : udp::v6(), groups_.port), ec);
  const std::string port = std::to_string(groups_.port);
  if (ec.value() == EADDRINUSE) {
    return fail(NetError::Kind::kPortBusy, "UDP port " + port +
                                               " is held by another program that does not share it; stop that one "
                                               "(ss -ulnp \"sport = :" +
                                               port + "\" names it) or choose another port for all peers");
  }
  if (ec.value() == EACCES || ec.value() == EPERM) {
    return fail(NetError::Kind::kPermission,
                "UDP port " + port + " needs privileges that this process lacks; choose one from 1024 to 65535");
  }
  if (ec) return fail(NetError::Kind::kOther, "cannot bind UDP port " + port + ": " + ec.message());
  return {};
}

// Asks the routing table now whether a datagram would get out, rather than let every send fail later. Connecting a UDP
// socket sends nothing; it is another socket, since a connected one hears its peer only.
std::expected<void, NetError> MulticastSocket::probe_route() {
  error_code ec;
  udp::socket probe(socket_.get_executor());
  probe.open(groups_.base.is_v4() ? udp::v4() : udp::v6(), ec);
  if (ec) return fail(NetError::Kind::kOther, "cannot open a UDP socket: " + ec.message());
  const int error = send_over_our_interface(probe.native_handle());
  if (!error) probe.connect(on_our_interface(udp::endpoint(groups_.base, groups_.port)), ec);
  const int reason = error ? error : ec.value();
  if (reason == 0) return {};
  const std::string where =
      "cannot multicast to " + groups_.base.to_string() + " over \"" + chosen_.interface.name + "\"";
  if (groups_.base.is_v6()) {
    return fail(NetError::Kind::kNoMulticast,
                where + ": " + text_of(reason) +
                    (chosen_.interface.loopback ? "; lo carries no IPv6 multicast: use an IPv4 group such as "
                                                  "239.192.0.0, or name an interface that reaches other computers"
                                                : "; use an IPv4 group such as 239.192.0.0 or name another interface"));
  }
  return fail(NetError::Kind::kNoMulticast, where + ": " + text_of(reason) + "; name another interface");
}

int MulticastSocket::receive_buffer_bytes() const {
  asio::socket_base::receive_buffer_size size;
  error_code ec;
  socket_.get_option(size, ec);
  return ec ? 0 : size.value();
}

std::expected<void, NetError> MulticastSocket::join(RegionId region) {
  if (joined_.contains(region)) return {};
  const auto group = group_endpoint(groups_, region);
  if (!group) return std::unexpected(group.error());
  if (const int error = change_membership(true, group->address())) return std::unexpected(join_error(region, error));
  joined_.insert(region);
  return {};
}

std::expected<void, NetError> MulticastSocket::leave(RegionId region) {
  if (joined_.erase(region) == 0) return {};
  const auto group = group_endpoint(groups_, region);
  assert(group);  // it was joined
  if (const int error = change_membership(false, group->address())) {
    return fail(NetError::Kind::kOther, "cannot leave multicast group " + group->address().to_string() + " on \"" +
                                            chosen_.interface.name + "\": " + text_of(error) +
                                            "; its datagrams are dropped here all the same");
  }
  return {};
}

// By interface index, here and when joining: addresses come and go, and an interface may have none of its own.
int MulticastSocket::send_over_our_interface(int fd) const {
  const int index = static_cast<int>(chosen_.interface.index);
  if (groups_.base.is_v6()) return set_option(fd, IPPROTO_IPV6, IPV6_MULTICAST_IF, index);
  ip_mreqn outgoing{};
  outgoing.imr_ifindex = index;
  // Linux does not take lo's own address for multicast: datagrams would come from another interface's address, or from
  // 0.0.0.0 where there is none. Elsewhere the kernel chooses, and goes on choosing when an address changes.
  if (chosen_.interface.loopback) outgoing.imr_address.s_addr = htonl(INADDR_LOOPBACK);
  return set_option(fd, IPPROTO_IP, IP_MULTICAST_IF, outgoing);
}

int MulticastSocket::change_membership(bool join, const asio::ip::address& group) {
  const int fd = socket_.native_handle();
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
    // IPv4 counts groups (20 by default), IPv6 the memory that they take.
    const bool v4 = groups_.base.is_v4();
    const char* setting = v4 ? "net.ipv4.igmp_max_memberships" : "net.core.optmem_max";
    std::string limit = "unknown";
    std::ifstream(v4 ? "/proc/sys/net/ipv4/igmp_max_memberships" : "/proc/sys/net/core/optmem_max") >> limit;
    return {NetError::Kind::kLimit, what + std::to_string(joined_.size()) +
                                        " groups are joined and the system allows no more (" + setting + " is " +
                                        limit + "); raise it with sysctl -w or join fewer regions"};
  }
  if (error == ENODEV)
    return {NetError::Kind::kNoMulticast, what + "the interface is gone; bring it back or name another"};
  return {NetError::Kind::kOther, what + text_of(error)};
}

// An IPv6 group of link-local scope means nothing without its interface; wider ones ignore the number.
udp::endpoint MulticastSocket::on_our_interface(const udp::endpoint& group) const {
  if (group.address().is_v4()) return group;
  return {asio::ip::address_v6(group.address().to_v6().to_bytes(), chosen_.interface.index), group.port()};
}

std::expected<void, SendDrop> MulticastSocket::send(RegionId region, std::span<const std::byte> datagram) {
  const auto drop = [&](SendDrop reason) {
    ++counter_of(counters_, reason);
    return std::unexpected(reason);
  };
  if (datagram.size() > kMaxDatagramBytes) return drop(SendDrop::kTooLarge);
  const auto group = group_endpoint(groups_, region);
  if (!group) return drop(SendDrop::kNoGroup);
  error_code ec;
  socket_.send_to(asio::buffer(datagram.data(), datagram.size()), on_our_interface(*group), 0, ec);
  if (ec) return drop(drop_of(ec.value()));
  ++counters_.packets_out;
  counters_.bytes_out += datagram.size();
  return {};
}

void MulticastSocket::on_receive(ReceiveHandler handler) {
  assert(handler && !handler_);
  handler_ = std::move(handler);
  wait_readable();
}

void MulticastSocket::wait_readable() {
  socket_.async_wait(udp::socket::wait_read, [this, alive = std::weak_ptr(alive_)](const error_code& ec) {
    if (alive.expired() || ec) return;  // a wait fails only when its socket is closed
    drain();
    wait_readable();
  });
}

void MulticastSocket::drain() {
  for (int reads = 0; reads < kMaxReadsPerWake && receive_one(); ++reads) {
  }
}

bool MulticastSocket::receive_one() {
  udp::endpoint from;
  iovec into{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) std::array<std::byte, kControlBytes> control;
  msghdr message{};
  message.msg_name = from.data();
  message.msg_namelen = static_cast<socklen_t>(from.capacity());
  message.msg_iov = &into;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();

  const ssize_t received = recvmsg(socket_.native_handle(), &message, 0);
  if (received < 0) {
    if (errno == EINTR) return true;
    if (errno != EAGAIN) ++counters_.in_errors;
    return false;
  }
  const Destination to = destination_of(message);
  if (to.lost_before) counters_.in_queue_overflow = *to.lost_before;

  const auto drop = [](std::uint64_t& counter) {
    ++counter;
    return true;
  };
  if (message.msg_flags & MSG_TRUNC) return drop(counters_.in_truncated);
  if (!to.group) return drop(counters_.in_no_destination);
  // IPv6 matches a datagram's group with this socket's, but not the interface that it came over.
  if (to.interface_index != chosen_.interface.index) return drop(counters_.in_other_interface);
  const auto region = region_of(groups_, *to.group);
  if (!region || !joined_.contains(*region)) return drop(counters_.in_other_group);

  from.resize(message.msg_namelen);
  const auto size_bytes = static_cast<std::size_t>(received);
  ++counters_.packets_in;
  counters_.bytes_in += size_bytes;
  handler_(*region, std::span<const std::byte>(buffer_.data(), size_bytes), from);
  return true;
}

}  // namespace peerd::net
