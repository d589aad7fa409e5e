#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>

#include "core/ids.hpp"
#include "peerd/net/interfaces.hpp"
#include "peerd/net/net_error.hpp"
#include "peerd/net/region_groups.hpp"
#include "peerd/net/traffic_counters.hpp"

namespace peerd::net {

// Longest UDP payload that is read or sent. Peers send at most 1,200 bytes; an Ethernet frame holds 1,472.
inline constexpr std::size_t kMaxDatagramBytes = 1500;

struct MulticastOptions {
  std::string interface = "";  // "lo", "eth0"; empty: choose_interface picks
  GroupPlan groups;
  int ttl = 1;                             // hops, 0 to 255. 0: this computer only; 1: this LAN
  int receive_buffer_bytes = 1024 * 1024;  // asked of the kernel, which may grant less (net.core.rmem_max)
};

// Why a datagram did not leave; each has its counter. Dead reckoning bears losses, so none of these is an error.
enum class SendDrop : std::uint8_t { kQueueFull, kUnreachable, kBlocked, kTooLarge, kNoGroup, kOther };

// One UDP socket for all regions: sends to any, hears those that it joined, over one interface. Single-threaded, as is
// its io_context.
//
// Datagrams that this socket sent to a group that it joined come back to it: loopback must be on for peers that share a
// computer to hear each other, and the kernel cannot tell them apart. The peer above drops its own by their sender.
class MulticastSocket {
 public:
  // The datagram is only valid during the call. The handler may join, leave and send; it must not destroy the socket.
  using ReceiveHandler =
      std::function<void(RegionId, std::span<const std::byte> datagram, const asio::ip::udp::endpoint& from)>;

  [[nodiscard]] static std::expected<std::unique_ptr<MulticastSocket>, NetError> open(asio::io_context& io,
                                                                                      const MulticastOptions& options);
  MulticastSocket(const MulticastSocket&) = delete;
  MulticastSocket& operator=(const MulticastSocket&) = delete;
  ~MulticastSocket() = default;

  // Starts reading; once, with a handler that can be called. Before that the kernel queues what arrives.
  void on_receive(ReceiveHandler handler);

  // Both may be repeated: joining what is joined and leaving what is not do nothing. After leave() the handler is not
  // called for that region any more, not even for what the kernel had queued.
  std::expected<void, NetError> join(RegionId region);
  std::expected<void, NetError> leave(RegionId region);

  // Never blocks. No need to have joined the region.
  std::expected<void, SendDrop> send(RegionId region, std::span<const std::byte> datagram);

  [[nodiscard]] const TrafficCounters& counters() const { return counters_; }
  [[nodiscard]] const ChosenInterface& chosen_interface() const { return chosen_; }
  [[nodiscard]] std::size_t joined_count() const { return joined_.size(); }
  [[nodiscard]] int receive_buffer_bytes() const;  // granted by the kernel
  [[nodiscard]] int native_handle() { return socket_.native_handle(); }

 private:
  MulticastSocket(asio::io_context& io, GroupPlan groups, ChosenInterface chosen);

  std::expected<void, NetError> configure(const MulticastOptions& options);
  std::expected<void, NetError> bind_port();
  std::expected<void, NetError> probe_route();

  [[nodiscard]] int send_over_our_interface(int fd) const;                         // errno, 0 = done
  [[nodiscard]] int change_membership(bool join, const asio::ip::address& group);  // errno, 0 = done
  [[nodiscard]] NetError join_error(RegionId region, int error) const;
  [[nodiscard]] asio::ip::udp::endpoint on_our_interface(const asio::ip::udp::endpoint& group) const;

  void wait_readable();
  void drain();
  bool receive_one();  // false when there is nothing left to read

  GroupPlan groups_;
  ChosenInterface chosen_;
  asio::ip::udp::socket socket_;
  std::set<RegionId> joined_;
  ReceiveHandler handler_;
  TrafficCounters counters_;
  std::array<std::byte, kMaxDatagramBytes> buffer_{};
  // Closing a socket does not call back completions that are already queued (Asio, cancel()): they look here first.
  std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);
};

}  // namespace peerd::net
