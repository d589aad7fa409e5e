// Bare UDP multicast over lo: a datagram of an update's size, sendto() and a recv() that blocks or is repeated until
// there is something, nothing else.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "ping_pong.hpp"

namespace peerd::bench {
namespace {

constexpr std::size_t kDatagram_bytes = 64;
constexpr std::uint16_t kPingPort = 19'470, kPongPort = 19'471;  // below the ephemeral ones

void check(int result, const char* what) {
  if (result < 0) throw std::runtime_error(std::string(what) + ": " + std::strerror(errno));
}

class Socket {
 public:
  Socket(std::uint16_t port, Waits waits) : fd_(socket(AF_INET, SOCK_DGRAM, 0)), waits_(waits) {
    check(fd_, "socket");
    const int on = 1;
    check(setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on), "SO_REUSEADDR");
    const sockaddr_in here = endpoint(port);
    check(bind(fd_, reinterpret_cast<const sockaddr*>(&here), sizeof here), "bind");
    ip_mreqn lo{here.sin_addr, {htonl(INADDR_LOOPBACK)}, 0};
    check(setsockopt(fd_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &lo, sizeof lo), "IP_ADD_MEMBERSHIP");
    check(setsockopt(fd_, IPPROTO_IP, IP_MULTICAST_IF, &lo, sizeof lo), "IP_MULTICAST_IF");
    const timeval within{kPongWithin.count(), 0};
    check(setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &within, sizeof within), "SO_RCVTIMEO");
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() { close(fd_); }

  void send(std::uint16_t port, std::size_t value) {
    std::memcpy(datagram_.data(), &value, sizeof value);
    const sockaddr_in to = endpoint(port);
    check(static_cast<int>(
              sendto(fd_, datagram_.data(), datagram_.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to)),
          "sendto");
  }
  void receive(std::size_t value) {
    check(static_cast<int>(waits_ == Waits::kAsleep ? recv(fd_, datagram_.data(), datagram_.size(), 0) : poll()),
          "recv");
    std::size_t got = 0;
    std::memcpy(&got, datagram_.data(), sizeof got);
    if (got != value) throw std::runtime_error("another datagram than was expected");
  }

 private:
  ssize_t poll() {
    for (const auto end = Clock::now() + kPongWithin;;) {
      const ssize_t got = recv(fd_, datagram_.data(), datagram_.size(), MSG_DONTWAIT);
      if (got >= 0 || errno != EAGAIN || Clock::now() > end) return got;
      std::this_thread::yield();
    }
  }
  static sockaddr_in endpoint(std::uint16_t port) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    inet_pton(AF_INET, "239.192.80.77", &at.sin_addr);
    return at;
  }

  int fd_;
  Waits waits_;
  std::array<std::byte, kDatagram_bytes> datagram_{};
};

void wait_until(Clock::time_point due, Waits waits) {
  if (waits == Waits::kAsleep) return std::this_thread::sleep_until(due);
  while (Clock::now() < due) std::this_thread::yield();
}

}  // namespace

Latencies udp_round(const Round& round) {
  // Both are bound before either sends.
  Socket pinging(kPingPort, round.waits), ponging(kPongPort, round.waits);
  const auto ping = [&](Stamps& stamps) {
    auto next = Clock::now();
    for (std::size_t i = 0; i < stamps.pings; ++i) {
      if (round.pace == Pace::kEveryMillisecond) wait_until(next += kPingInterval, round.waits);
      stamps.published[i] = Clock::now();
      pinging.send(kPongPort, i);
      pinging.receive(i);
      stamps.answered[i] = Clock::now();
    }
  };
  const auto pong = [&](Stamps& stamps) {
    for (std::size_t i = 0; i < stamps.pings; ++i) {
      ponging.receive(i);
      stamps.heard[i] = Clock::now();
      ponging.send(kPingPort, i);
    }
  };
  return ping_pong(round.pings, round.cores, ping, pong);
}

}  // namespace peerd::bench
