#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/udp.hpp>

#include "peerd/input/input_error.hpp"

namespace peerd::feed {

// "PORT" (of 127.0.0.1), "127.0.0.1:PORT" or "[::1]:PORT"; port 0: the system chooses. The error is one sentence.
[[nodiscard]] std::expected<boost::asio::ip::udp::endpoint, std::string> parse_udp_address(const std::string& text);

// Hears datagrams in the io_context's one thread and answers none. It has no idea who sends them: what it is bound to
// decides who can.
class UdpPort {
 public:
  using OnDatagram = std::function<void(std::string_view datagram)>;

  // Listens from now on. `asked_by` is the key that names the address, for errors.
  [[nodiscard]] static Result<std::unique_ptr<UdpPort>> open(boost::asio::io_context& io,
                                                                     const std::string& address,
                                                                     const std::string& asked_by, OnDatagram);
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  // Where it listens, with the port that the system chose.
  [[nodiscard]] boost::asio::ip::udp::endpoint endpoint() const;

  struct Counters {
    std::uint64_t datagrams = 0, bytes = 0;
    std::uint64_t lost = 0;    // in the kernel: the receive buffer was full. Modulo 2^32
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

}  // namespace peerd::feed
