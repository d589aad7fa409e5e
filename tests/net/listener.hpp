#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "peerd/net/transport/multicast_socket.hpp"

namespace peerd::net::testing_support {

// A port that no other test process uses: each has 16, below the range that the system assigns. `slot` < 16.
inline std::uint16_t own_port(unsigned slot) {
  return static_cast<std::uint16_t>(10'000 + static_cast<unsigned>(getpid()) % 1400 * 16 + slot);
}

inline std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// The clock of all sockets of the tests, as a peer has one.
inline const HostClock& clock() {
  static const HostClock host_clock;
  return host_clock;
}

// A socket that records what it receives.
struct Listener {
  Listener(asio::io_context& io, const MulticastOptions& options) {
    auto opened = MulticastSocket::open(io, clock(), options);
    if (!opened) {
      ADD_FAILURE() << opened.error().sentence;
      throw std::runtime_error(opened.error().sentence);
    }
    socket = *std::move(opened);
    socket->on_receive([this](const Arrival& arrival) {
      heard.emplace_back(arrival.region.value, text_of(arrival.datagram));
      from.push_back(arrival.from);
      at.push_back(arrival.at);
    });
  }
  void join(std::uint32_t region) {
    const auto joined = socket->join(RegionId{region});
    EXPECT_TRUE(joined) << joined.error().sentence;
  }
  void leave(std::uint32_t region) {
    const auto left = socket->leave(RegionId{region});
    EXPECT_TRUE(left) << left.error().sentence;
  }
  void send(std::uint32_t region, std::string_view text) {
    socket->send(RegionId{region}, bytes_of(text));
    socket->flush();
  }

  using Heard = std::vector<std::pair<std::uint32_t, std::string>>;
  Heard heard;
  std::vector<asio::ip::udp::endpoint> from;
  std::vector<HostTime> at;
  std::unique_ptr<MulticastSocket> socket;
};

// Runs the sockets until `done`, at most 5 s. No test waits for silence: a test that a datagram is not received sends a
// marker after it, for datagrams do not overtake each other on one computer.
template <class Predicate>
bool run_until(asio::io_context& io, Predicate done) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!done() && std::chrono::steady_clock::now() < give_up) {
    io.restart();
    io.run_one_for(std::chrono::milliseconds(20));
  }
  return done();
}

}  // namespace peerd::net::testing_support
