#pragma once
#include <netinet/in.h>
#include <sys/socket.h>
#include <time.h>

#include <array>
#include <bitset>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "peerd/os/datagram_limits.hpp"
#include "peerd/os/traffic_counters.hpp"

namespace peerd::net {

namespace asio = boost::asio;

// A datagram and what the kernel says beside it. Valid until the next read.
struct Received {
  std::span<const std::byte> bytes;
  bool truncated = false;
  const asio::ip::udp::endpoint& from;
  std::optional<asio::ip::address> to;       // by IP_PKTINFO, IPV6_PKTINFO
  unsigned interface_index = 0;              // that it came over
  std::optional<std::uint32_t> lost_before;  // by this socket since it was opened, modulo 2^32; none when none
  std::optional<Duration> wall_stamp;        // Unix time at which the kernel got it
};

// Up to kBatch datagrams of one socket by one recvmmsg. Allocates when it is made and never again.
class ReceiveBatch {
 public:
  explicit ReceiveBatch(std::size_t max_bytes);
  ReceiveBatch(const ReceiveBatch&) = delete;
  ReceiveBatch& operator=(const ReceiveBatch&) = delete;

  // How many were waiting, kBatch at most; an error as -errno.
  [[nodiscard]] int read(int fd);
  [[nodiscard]] Received operator[](std::size_t i);  // of those that the last read gave

 private:
  // Where it was sent to, how many were lost before it, when it came.
  static constexpr std::size_t kControlBytes =
      CMSG_SPACE(sizeof(in6_pktinfo)) + CMSG_SPACE(sizeof(std::uint32_t)) + CMSG_SPACE(sizeof(timespec));
  struct alignas(cmsghdr) Control {
    std::array<std::byte, kControlBytes> bytes;
  };

  std::size_t max_bytes_;
  std::vector<std::byte> buffer_;
  std::array<Control, kBatch> controls_{};
  std::array<asio::ip::udp::endpoint, kBatch> froms_;
  std::array<iovec, kBatch> into_{};
  std::array<mmsghdr, kBatch> messages_{};
  std::size_t used_ = kBatch;  // whose lengths are to be set before the next read
};

// Datagrams that wait to leave by one sendmmsg. Allocates when it is made and never again.
class SendQueue {
 public:
  explicit SendQueue(std::size_t max_bytes);
  SendQueue(const SendQueue&) = delete;
  SendQueue& operator=(const SendQueue&) = delete;

  [[nodiscard]] bool full() const { return size_ == kBatch; }
  // Not when full. Copies header and datagram, max_bytes together at most.
  void push(const asio::ip::udp::endpoint& to, std::span<const std::byte> header, std::span<const std::byte> datagram);
  // Empties it. Counts what the kernel takes, and why it doesn't take the rest: those, by their place in it.
  std::bitset<kBatch> flush(int fd, TrafficCounters& counters);

 private:
  std::size_t max_bytes_;
  std::size_t size_ = 0;
  std::vector<std::byte> buffer_;
  std::array<asio::ip::udp::endpoint, kBatch> tos_;
  std::array<iovec, kBatch> from_{};
  std::array<mmsghdr, kBatch> messages_{};
};

}  // namespace peerd::net
