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
#include "peerd/os/datagram_limits.hpp"
#include "peerd/os/net_error.hpp"
#include "peerd/os/traffic_counters.hpp"

namespace peerd::net {

namespace asio = boost::asio;

// One datagram from the network; `datagram` and `from` are only valid during the call that gets it.
struct Arrival {
  RegionId region;
  std::span<const std::byte> datagram;
  // When the kernel had it, by HostClock; when it was read, where the kernel's stamp says nothing. Never after the
  // reading, but earlier perhaps than that of the one before: sockets are read one after the other.
  HostTime at;
  const asio::ip::udp::endpoint& from;
};

// What became of a transport's interface, for the log.
struct InterfaceChange {
  bool is_back;  // else it is gone
  std::string sentence;
};

// What carries datagrams between peers: multicast (MulticastSocket) or, where there is none, unicast to each
// (UnicastFanOut). Same datagrams, same regions. Single-threaded, as its io_context.
class Transport {
 public:
  // The handler may join, leave, send and flush; it must not receive, nor destroy the transport.
  using ReceiveHandler = std::function<void(const Arrival&)>;

  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  // Starts reading; once, with a handler that can be called. Before that the kernel queues what arrives.
  virtual void on_receive(ReceiveHandler handler) = 0;
  // Hands on what waits by now, so that what came before a tick is known in it; whether anything did. After
  // on_receive().
  virtual bool receive_pending() = 0;

  // Both may be repeated: joining what is joined and leaving what is not do nothing. After leave() the handler is not
  // called for that region any more, not even for what the kernel had queued.
  virtual std::expected<void, NetError> join(RegionId region) = 0;
  virtual std::expected<void, NetError> leave(RegionId region) = 0;

  // Takes a copy; no need to have joined the region. What waits leaves with flush(), or by itself kBatch at a time.
  // Neither blocks, and what doesn't leave is counted by its reason: dead reckoning bears losses, so none is an error.
  virtual void send(RegionId region, std::span<const std::byte> datagram) = 0;
  virtual void flush() = 0;

  // An interface that is deleted and made anew under its old name (a VPN, a container's network) is another one to the
  // kernel: goes over to it. What there is to say of that, each time once. Asks the system: for now and then.
  [[nodiscard]] virtual std::optional<InterfaceChange> follow_interface() = 0;

  [[nodiscard]] virtual const TrafficCounters& counters() const = 0;
  [[nodiscard]] virtual std::size_t joined_count() const = 0;  // regions
  // Granted by the kernel for each socket.
  [[nodiscard]] virtual int receive_buffer_bytes() const = 0;
  // Where its datagrams come from; the unspecified address of its family where that depends on where they go.
  [[nodiscard]] virtual asio::ip::address own_address() const = 0;
  // For the log: "group 239.192.80.0 port 47474 over lo, as configured".
  [[nodiscard]] virtual std::string describe() const = 0;
};

}  // namespace peerd::net
