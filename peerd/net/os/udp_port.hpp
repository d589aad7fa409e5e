#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/udp.hpp>

#include "peerd/input/input_error.hpp"

namespace peerd::net {

// Parses "PORT" (of 127.0.0.1), "127.0.0.1:PORT" or "[::1]:PORT"; with port 0 the system chooses the port. The error is
// one sentence.
[[nodiscard]] std::expected<boost::asio::ip::udp::endpoint, std::string> parse_udp_address(const std::string& text);

// Receives datagrams in the io_context's one thread, and never answers. It does not authenticate senders: the address
// that it is bound to decides who can reach it.
class UdpPort {
 public:
  using OnDatagram = std::function<void(std::string_view datagram)>;

  // Opens the port and listens. `asked_by` is the configuration key of the address, for errors.
  [[nodiscard]] static Result<std::unique_ptr<UdpPort>> open(boost::asio::io_context& io, const std::string& address,
                                                             const std::string& asked_by, OnDatagram);
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  // The bound address, with the port that the system chose.
  [[nodiscard]] boost::asio::ip::udp::endpoint endpoint() const;

  struct Counters {
    std::uint64_t datagrams = 0, bytes = 0;
    std::uint64_t lost = 0;    // in the kernel, because the receive buffer was full; modulo 2^32
    std::uint64_t errors = 0;  // failed reads
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  UdpPort(boost::asio::io_context& io, OnDatagram on_datagram);
  void wait();
  void receive();
  bool receive_one();

  boost::asio::ip::udp::socket socket_;
  OnDatagram on_datagram_;
  std::vector<char> buffer_;
  Counters counters_;
};

}  // namespace peerd::net
