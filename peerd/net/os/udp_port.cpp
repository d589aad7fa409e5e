#include "peerd/net/os/udp_port.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>

#include "peerd/net/os/close_on_exec.hpp"

namespace peerd::net {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

constexpr std::size_t kDatagramMax_bytes = 65'535;  // no UDP payload is longer, so none is truncated
constexpr int kReceiveBuffer_bytes = 1 << 20;       // requested; the system may grant less
// The number of datagrams that are read before ticks have their turn, so that a flood of the port does not stop them.
constexpr int kDatagramsAtOnce = 32;

}  // namespace

std::expected<udp::endpoint, std::string> parse_udp_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::string address = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const std::string port_text = colon == std::string::npos ? text : text.substr(colon + 1);
  if (address.size() > 1 && address.front() == '[' && address.back() == ']') {
    address = address.substr(1, address.size() - 2);
  } else if (address.find(':') != std::string::npos) {
    return std::unexpected("write an IPv6 address in brackets: [::1]:47480");
  }
  std::uint16_t port = 0;
  const char* const end = port_text.data() + port_text.size();
  const auto [stop, bad] = std::from_chars(port_text.data(), end, port);
  error_code error;
  const auto parsed = asio::ip::make_address(address, error);
  if (error || bad != std::errc{} || stop != end) {
    return std::unexpected("write it as \"127.0.0.1:47480\", an address of this computer and a port from 0 to 65535");
  }
  return udp::endpoint(parsed, port);
}

UdpPort::UdpPort(asio::io_context& io, OnDatagram on_datagram)
    : socket_(io), on_datagram_(std::move(on_datagram)), buffer_(kDatagramMax_bytes) {}

Result<std::unique_ptr<UdpPort>> UdpPort::open(asio::io_context& io, const std::string& address,
                                               const std::string& asked_by, OnDatagram on_datagram) {
  const auto fail = [&](const std::string& why, int code) {
    return std::unexpected(InputError{"error: " + asked_by + " = \"" + address + "\": " + why, code});
  };
  const auto endpoint = parse_udp_address(address);
  if (!endpoint) return fail(endpoint.error(), 2);
  std::unique_ptr<UdpPort> port(new UdpPort(io, std::move(on_datagram)));
  error_code error;
  udp::socket& socket = port->socket_;
  socket.open(endpoint->protocol(), error);
  close_on_exec(socket);
  if (!error) socket.non_blocking(true, error);
  if (error) return fail(error.message(), 3);
  error_code ignored;  // a smaller buffer is acceptable, for losses are counted
  socket.set_option(asio::socket_base::receive_buffer_size(kReceiveBuffer_bytes), ignored);
  const int on = 1;
  if (setsockopt(socket.native_handle(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) != 0) {
    return fail("the system does not count what it loses (SO_RXQ_OVFL)", 3);
  }
  socket.bind(*endpoint, error);
  if (error == asio::error::address_in_use) return fail("another program listens there; choose another port", 3);
  if (error) return fail(error.message(), 3);
  port->wait();
  return port;
}

udp::endpoint UdpPort::endpoint() const {
  error_code ignored;  // a bound socket has a local endpoint
  return socket_.local_endpoint(ignored);
}

void UdpPort::wait() {
  socket_.async_wait(udp::socket::wait_read, [this](const error_code& cancelled) {
    if (!cancelled) receive();  // a cancelled wait means that the port is destroyed
  });
}

void UdpPort::receive() {
  for (int i = 0; i < kDatagramsAtOnce && receive_one(); ++i) {
  }
  wait();
}

// Returns false where no datagram waits.
bool UdpPort::receive_one() {
  iovec part{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(std::uint32_t))];
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t size = recvmsg(socket_.native_handle(), &message, 0);
  if (size < 0) {
    const bool none = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    counters_.errors += !none;
    return !none;
  }
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t lost = 0;
    std::memcpy(&lost, CMSG_DATA(c), sizeof lost);
    counters_.lost = lost;
  }
  ++counters_.datagrams;
  counters_.bytes += static_cast<std::size_t>(size);
  on_datagram_({buffer_.data(), static_cast<std::size_t>(size)});
  return true;
}

}  // namespace peerd::net
