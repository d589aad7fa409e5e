#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/os/datagram_limits.hpp"
#include "peerd/net/os/net_error.hpp"
#include "peerd/net/os/traffic_counters.hpp"

namespace peerd::net {

namespace asio = boost::asio;

// One datagram from the network; `datagram` and `from` are valid during the handler's call only.
struct Arrival {
  RegionId region;
  std::span<const std::byte> datagram;
  // The time of arrival at the kernel, by HostClock; the time of reading where the kernel's timestamp is unusable. It
  // is never after the reading, but may be before that of the last arrival, because sockets are read one after the
  // other.
  HostTime at;
  const asio::ip::udp::endpoint& from;
};

// A change of a transport's interface, for the log.
struct InterfaceChange {
  bool is_back;  // false: the interface is gone
  std::string sentence;
};

// Carries datagrams between peers: by multicast (MulticastSocket) or, where there is none, by unicast to each peer
// (UnicastFanOut). Datagrams and regions are the same for both. Single-threaded, as its io_context.
class Transport {
 public:
  // The handler may join, leave, send and flush; it must not receive, nor destroy the transport.
  using ReceiveHandler = std::function<void(const Arrival&)>;

  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  // Starts reading; to be called once, with a callable handler. Before that the kernel queues datagrams.
  virtual void on_receive(ReceiveHandler handler) = 0;
  // Passes all datagrams that wait to the handler, so that a tick knows what arrived before it. Returns whether there
  // was one. To be called after on_receive().
  virtual bool receive_pending() = 0;

  // Joining a joined region and leaving a region that is not joined have no effect. After leave() the handler is not
  // called for that region, not even for datagrams that the kernel had queued.
  virtual std::expected<void, NetError> join(RegionId region) = 0;
  virtual std::expected<void, NetError> leave(RegionId region) = 0;

  // Copies the datagram; the region need not be joined. Waiting datagrams leave with flush(), or kBatch at a time.
  // Neither call blocks. Datagrams that do not leave are counted by reason and are no error, for dead reckoning
  // tolerates losses.
  virtual void send(RegionId region, std::span<const std::byte> datagram) = 0;
  virtual void flush() = 0;

  // Switches to an interface that was deleted and made anew under its old name (a VPN, a container's network), which
  // the kernel regards as another one; and, where none was named and this computer could reach no other, to one that
  // has come since and does. Returns each change once. It asks the system, so it is to be called about once a second.
  [[nodiscard]] virtual std::optional<InterfaceChange> follow_interface() = 0;

  [[nodiscard]] virtual const TrafficCounters& counters() const = 0;
  [[nodiscard]] virtual std::size_t joined_count() const = 0;  // regions
  // The receive buffer that the kernel grants to each socket [bytes].
  [[nodiscard]] virtual int receive_buffer_bytes() const = 0;
  // The source address of own datagrams as of the last follow_interface(); the unspecified address of its family where
  // it depends on the destination.
  [[nodiscard]] virtual asio::ip::address own_address() const = 0;
  // Why this computer alone is reached, though nobody has asked for that; empty: others are, or somebody has.
  [[nodiscard]] virtual std::string why_only_here() const { return {}; }
  // For the log: "group 239.192.80.0 port 47474 over lo, as configured".
  [[nodiscard]] virtual std::string describe() const = 0;
};

}  // namespace peerd::net
