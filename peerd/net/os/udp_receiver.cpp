#include "peerd/net/os/udp_receiver.hpp"

#include <cassert>
#include <utility>

namespace peerd::net {
namespace {

// The number of batches that are read of one socket before timers, signals and other sockets have their turn; the rest
// stays in the kernel's queue.
constexpr int kReadsPerTurn = 2;

}  // namespace

UdpReceiver::UdpReceiver(asio::io_context& io, Reading& reading)
    : socket_(io), reading_(reading), empty_at_(reading.clock.now()) {}

void UdpReceiver::start(Handler handler) {
  assert(handler && !handler_);
  handler_ = std::move(handler);
  wait();
}

void UdpReceiver::wait() {
  socket_.async_wait(asio::ip::udp::socket::wait_read,
                     [this, alive = std::weak_ptr(alive_)](const boost::system::error_code& ec) {
                       if (alive.expired() || ec) return;  // a wait fails only because its socket is closed
                       read();
                       wait();
                     });
}

bool UdpReceiver::read() {
  assert(handler_ && !reading_.busy);
  reading_.busy = true;
  bool any = false;
  for (int turn = 0; turn < kReadsPerTurn; ++turn) {
    const HostTime before = reading_.clock.now();
    ++reading_.counters.calls_in;
    const int count = reading_.batch.read(socket_.native_handle());
    if (count < 0 && count != -EAGAIN) {
      ++reading_.counters.in_errors;
      break;
    }
    if (count > 0) {
      any = true;
      const HostClock::Pair pair = reading_.clock.pair_with_wall();
      reading_.arrivals.on_pair(pair);
      for (int i = 0; i < count; ++i) {
        const Received received = reading_.batch[static_cast<std::size_t>(i)];
        count_lost(received);
        handler_(received, time_of(received, pair.before));
      }
    }
    if (count < static_cast<int>(kBatch)) {
      empty_at_ = before;
      break;
    }
  }
  reading_.busy = false;
  return any;
}

// The kernel reports the total of losses, modulo 2^32, at the arrival of this datagram. Losses that are already known
// may have happened after its arrival; then the difference is negative until the next datagram.
void UdpReceiver::count_lost(const Received& received) {
  if (!received.lost_before) return;
  const auto more = static_cast<std::int32_t>(*received.lost_before - filtered_ - lost_);
  if (more <= 0) return;
  reading_.counters.in_queue_overflow += static_cast<std::uint32_t>(more);
  lost_ += static_cast<std::uint32_t>(more);
}

HostTime UdpReceiver::time_of(const Received& received, HostTime read_at) {
  if (!received.wall_stamp) {
    ++reading_.counters.in_unstamped;
    return read_at;
  }
  if (const auto at = reading_.arrivals.arrival(*received.wall_stamp, empty_at_)) return *at;
  ++reading_.counters.in_stamp_refused;
  return read_at;
}

}  // namespace peerd::net
