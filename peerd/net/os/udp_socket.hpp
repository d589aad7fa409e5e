#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <expected>
#include <span>
#include <string>

#include "peerd/net/os/net_error.hpp"

namespace peerd::net {

namespace asio = boost::asio;

[[nodiscard]] std::string text_of(int error);  // the system's text for an errno
[[nodiscard]] std::unexpected<NetError> failure(NetError::Kind kind, std::string sentence);

template <class Value>
[[nodiscard]] int set_option(int fd, int level, int name, const Value& value) {
  return setsockopt(fd, level, name, &value, sizeof value) == 0 ? 0 : errno;
}

struct SocketOption {
  int level, name, value;
  const char* text;
};
[[nodiscard]] std::expected<void, NetError> set_options(int fd, std::span<const SocketOption> options);

struct UdpOptions {
  bool v4 = true;
  int dscp = 0;                  // 0 to 63
  int receive_buffer_bytes = 0;  // requested of the kernel
};
// Opens a non-blocking socket for which the kernel timestamps datagrams, counts lost ones, and names destinations.
[[nodiscard]] std::expected<void, NetError> open_udp(asio::ip::udp::socket& socket, const UdpOptions& options);

// Binds to the wildcard address. `advice` says, for the error, what to do where another program holds the port.
[[nodiscard]] std::expected<void, NetError> bind_udp(asio::ip::udp::socket& socket, std::uint16_t port,
                                                     const std::string& advice);

// The receive buffer that the kernel grants [bytes], which may be less than requested (net.core.rmem_max). 0: unknown.
[[nodiscard]] int granted_receive_buffer(const asio::ip::udp::socket& socket);

}  // namespace peerd::net
