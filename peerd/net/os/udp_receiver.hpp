#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "peerd/net/os/arrival_clock.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/os/udp_batch.hpp"

namespace peerd::net {

// The buffers and clocks that all sockets of one transport share; the sockets are read one after the other.
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

// One UDP socket, which is read whenever datagrams wait.
class UdpReceiver {
 public:
  using Handler = std::function<void(const Received&, HostTime at)>;

  // `reading` outlives it.
  UdpReceiver(asio::io_context& io, Reading& reading);

  [[nodiscard]] asio::ip::udp::socket& socket() { return socket_; }
  [[nodiscard]] const asio::ip::udp::socket& socket() const { return socket_; }
  // Starts reading; to be called once, with the socket open. `handler` must neither read nor destroy the receiver.
  void start(Handler handler);
  // Notes that the socket's filter has dropped a datagram, or soon will. The kernel counts it as lost.
  void on_filtered() { ++filtered_; }
  // Reads the datagrams that wait, up to a limit that is fair to other sockets. Returns whether there was one.
  bool read();

 private:
  void wait();
  void count_lost(const Received& received);
  [[nodiscard]] HostTime time_of(const Received& received, HostTime read_at);

  asio::ip::udp::socket socket_;
  Reading& reading_;
  Handler handler_;
  std::uint32_t filtered_ = 0;  // modulo 2^32
  std::uint32_t lost_ = 0;      // for want of room, as far as the kernel has reported; modulo 2^32
  HostTime empty_at_;           // the socket's queue was empty then or later
  // Closing a socket does not cancel completions that are already queued (Asio, cancel()), so they check this first.
  std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);
};

}  // namespace peerd::net
