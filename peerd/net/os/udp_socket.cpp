#include "peerd/net/os/udp_socket.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "peerd/net/os/close_on_exec.hpp"

namespace peerd::net {
namespace {

using asio::ip::udp;
using boost::system::error_code;

}  // namespace

std::string text_of(int error) { return std::generic_category().message(error); }

std::unexpected<NetError> failure(NetError::Kind kind, std::string sentence) {
  return std::unexpected(NetError{kind, std::move(sentence)});
}

std::expected<void, NetError> set_options(int fd, std::span<const SocketOption> options) {
  for (const auto& [level, name, value, text] : options) {
    if (const int error = set_option(fd, level, name, value)) {
      return failure(NetError::Kind::kOther, std::string("the system refuses socket option ") + text + ": " +
                                                 text_of(error) + "; Linux 4.20 or later is needed");
    }
  }
  return {};
}

// The reason for each option is in peerd/net/transport/README.md.
std::expected<void, NetError> open_udp(udp::socket& socket, const UdpOptions& options) {
  error_code ec;
  socket.open(options.v4 ? udp::v4() : udp::v6(), ec);
  close_on_exec(socket);
  if (ec.value() == EAFNOSUPPORT) {
    return failure(NetError::Kind::kNoMulticast,
                   "this computer has IPv6 switched off; use an IPv4 group such as 239.192.0.0");
  }
  if (ec.value() == EMFILE || ec.value() == ENFILE) {
    return failure(NetError::Kind::kLimit, "no file descriptor left for a socket; raise the limit (ulimit -n)");
  }
  if (ec.value() == EPERM || ec.value() == EACCES) {
    return failure(NetError::Kind::kPermission,
                   "the system does not let this process open a UDP socket: " + ec.message());
  }
  if (ec) return failure(NetError::Kind::kOther, "cannot open a UDP socket: " + ec.message());
  socket.non_blocking(true, ec);
  if (ec) return failure(NetError::Kind::kOther, "cannot make a socket non-blocking: " + ec.message());

  const int traffic_class = options.dscp << 2;  // RFC 2474: the upper six bits; the lower two are the network's
  const std::array<SocketOption, 2> common{
      {{SOL_SOCKET, SO_RXQ_OVFL, 1, "SO_RXQ_OVFL"}, {SOL_SOCKET, SO_TIMESTAMPNS, 1, "SO_TIMESTAMPNS"}}};
  const std::array<SocketOption, 2> v4{
      {{IPPROTO_IP, IP_PKTINFO, 1, "IP_PKTINFO"}, {IPPROTO_IP, IP_TOS, traffic_class, "IP_TOS"}}};
  const std::array<SocketOption, 3> v6{{{IPPROTO_IPV6, IPV6_V6ONLY, 1, "IPV6_V6ONLY"},
                                        {IPPROTO_IPV6, IPV6_RECVPKTINFO, 1, "IPV6_RECVPKTINFO"},
                                        {IPPROTO_IPV6, IPV6_TCLASS, traffic_class, "IPV6_TCLASS"}}};
  const int fd = socket.native_handle();
  if (auto good = set_options(fd, common); !good) return good;
  if (auto good = options.v4 ? set_options(fd, v4) : set_options(fd, v6); !good) return good;
  // The kernel caps the size silently; granted_receive_buffer() returns the granted size.
  return set_options(fd,
                     std::array<SocketOption, 1>{{{SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes, "SO_RCVBUF"}}});
}

std::expected<void, NetError> bind_udp(udp::socket& socket, std::uint16_t number, const std::string& advice) {
  error_code ec;
  const udp::endpoint any(socket.local_endpoint(ec).protocol(), number);
  socket.bind(any, ec);
  const std::string port = std::to_string(number);
  if (ec.value() == EADDRINUSE) {
    return failure(NetError::Kind::kPortBusy,
                   "UDP port " + port + " is held by another program that does not share it; stop that one (ss -ulnp " +
                       "\"sport = :" + port + "\" names it) or " + advice);
  }
  if (ec.value() == EACCES || ec.value() == EPERM) {
    return failure(NetError::Kind::kPermission,
                   "UDP port " + port + " needs privileges that this process lacks; choose one from 1024 to 65535");
  }
  if (ec) return failure(NetError::Kind::kOther, "cannot bind UDP port " + port + ": " + ec.message());
  return {};
}

// Linux reserves and reports twice the requested size, for its own book-keeping; Asio halves the reported size.
int granted_receive_buffer(const udp::socket& socket) {
  asio::socket_base::receive_buffer_size size;
  error_code ec;
  socket.get_option(size, ec);
  return ec ? 0 : size.value();
}

}  // namespace peerd::net
