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
#include "peerd/net/os/datagram_limits.hpp"
#include "peerd/net/os/traffic_counters.hpp"

namespace peerd::net {

namespace asio = boost::asio;

// A datagram with the kernel's metadata. It is valid until the next read.
struct Received {
  std::span<const std::byte> bytes;
  bool truncated = false;
  const asio::ip::udp::endpoint& from;
  std::optional<asio::ip::address> to;       // by IP_PKTINFO, IPV6_PKTINFO
  unsigned interface_index = 0;              // of the receiving interface
  std::optional<std::uint32_t> lost_before;  // datagrams that the socket has lost in all, modulo 2^32; none: no losses
  std::optional<Duration> wall_stamp;        // Unix time at which the kernel received it
};

// Reads up to kBatch datagrams of one socket by one recvmmsg. It allocates at construction only.
class ReceiveBatch {
 public:
  explicit ReceiveBatch(std::size_t max_bytes);
  ReceiveBatch(const ReceiveBatch&) = delete;
  ReceiveBatch& operator=(const ReceiveBatch&) = delete;

  // Returns the number of datagrams that were waiting, at most kBatch, or an error as -errno.
  [[nodiscard]] int read(int fd);
  [[nodiscard]] Received operator[](std::size_t i);  // the i-th datagram of the last read

 private:
  // Room for the destination address, the number of lost datagrams and the timestamp.
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
  std::size_t used_ = kBatch;  // messages whose lengths are to be reset before the next read
};

// Datagrams that wait to leave by one sendmmsg. The queue allocates at construction only.
class SendQueue {
 public:
  explicit SendQueue(std::size_t max_bytes);
  SendQueue(const SendQueue&) = delete;
  SendQueue& operator=(const SendQueue&) = delete;

  [[nodiscard]] bool full() const { return size_ == kBatch; }
  // Copies header and datagram, which together have at most `max_bytes`. The queue must not be full.
  void push(const asio::ip::udp::endpoint& to, std::span<const std::byte> header, std::span<const std::byte> datagram);
  // Sends and empties the queue. Counts the datagrams that the kernel takes, and the others by reason; returns the
  // indices of those others.
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
