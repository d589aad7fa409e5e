#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/os/traffic_counters.hpp"
#include "peerd/net/relay/forwarding_table.hpp"

namespace peerd::relay {

// A network of many peers that a relay joins as one link: all of them hear each other without it.
class Network {
 public:
  // A datagram of a peer there. To be passed on at once; the network must not be destroyed meanwhile.
  using OnDatagram = std::function<void(RegionId, std::span<const std::byte>, HostTime at)>;
  // Somebody may want other regions than before.
  using OnChange = std::function<void()>;

  Network() = default;
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;
  virtual ~Network() = default;

  // To be called once.
  virtual void start(OnDatagram on_datagram, OnChange on_change) = 0;
  // The place of this relay in its tree, which decides between relays of one network. `distance`: relays on the way to
  // the root, itself included.
  struct Place {
    std::size_t distance = 1;
    bool detached = false;  // from a parent that it is to have
  };
  // About twenty times a second. A sentence is for the log.
  [[nodiscard]] virtual std::optional<std::string> advance(HostTime now, const Place& place) = 0;

  // The regions that peers there want; nothing while another relay joins that network to the others.
  [[nodiscard]] virtual Wanted wanted() const = 0;
  // These regions are wanted elsewhere, and so are to be received there.
  virtual void receive(const Wanted& wanted_elsewhere) = 0;
  virtual void send(RegionId region, std::span<const std::byte> datagram) = 0;
  virtual void flush() = 0;

  [[nodiscard]] virtual const net::TrafficCounters& counters() const = 0;
  [[nodiscard]] virtual std::size_t peers() const = 0;  // that are there now
  // Datagrams that were not passed on, because another relay does, or has brought them.
  [[nodiscard]] virtual std::uint64_t left_to_others() const { return 0; }
  [[nodiscard]] virtual bool is_active() const = 0;        // it joins that network to the others
  [[nodiscard]] virtual std::string describe() const = 0;  // for the log
};

}  // namespace peerd::relay
