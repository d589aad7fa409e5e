#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "peerd/os/arrival_clock.hpp"
#include "peerd/os/host_clock.hpp"
#include "peerd/os/udp_batch.hpp"

namespace peerd::net {

// What all sockets of one transport read with, one after the other.
struct Reading {
  Reading(const HostClock& host_clock, TrafficCounters& traffic, std::size_t max_bytes)
      : clock(host_clock), counters(traffic), batch(max_bytes) {
    arrivals.on_pair(clock.pair_with_wall());
  }
  const HostClock& clock;
  TrafficCounters& counters;
  ReceiveBatch batch;
  ArrivalClock arrivals;
  bool busy = false;
};

// One UDP socket that is read whenever something has come.
class UdpReceiver {
 public:
  using Handler = std::function<void(const Received&, HostTime at)>;

  // `reading` outlives it.
  UdpReceiver(asio::io_context& io, Reading& reading);

  [[nodiscard]] asio::ip::udp::socket& socket() { return socket_; }
  [[nodiscard]] const asio::ip::udp::socket& socket() const { return socket_; }
  // Once, with the socket open. `handler` must not read, nor destroy this.
  void start(Handler handler);
  // The socket's filter has dropped one, or soon will: the kernel counts it among those it lost.
  void on_filtered() { ++filtered_; }
  // What waits now, as much as is fair to others; whether anything did.
  bool read();

 private:
  void wait();
  void count_lost(const Received& received);
  [[nodiscard]] HostTime time_of(const Received& received, HostTime read_at);

  asio::ip::udp::socket socket_;
  Reading& reading_;
  Handler handler_;
  std::uint32_t filtered_ = 0;  // modulo 2^32, as the next one
  std::uint32_t lost_ = 0;         // for want of room, as far as the kernel has said
  HostTime empty_at_;              // the socket's queue was empty then or later
  // Closing a socket does not call back completions that are already queued (Asio, cancel()): they look here first.
  std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);
};

}  // namespace peerd::net
