#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/node/describe.hpp"
#include "peerd/os/forward_time.hpp"
#include "peerd/os/host_clock.hpp"
#include "peerd/transport/transport.hpp"
#include "peerd/node/peer_node.hpp"
#include "peerd/record/capture.hpp"
#include "peerd/daemon/tick_lateness.hpp"

namespace peerd {

class CacheWarmer;

// The driver of DESIGN section 5, over a real clock and a real network. One thread.
//
// The peer is told when a datagram came, not when it was read, and its `now` must not run backwards: what came before
// something that the peer has been told of already counts as having come with that. A tick reads what waits first, so
// that this is rare and short; it is counted.
//
// Nothing waits for a tick that need not: a datagram is applied when it is read, and what a program or a key changes
// leaves in the same turn of the loop.
class Daemon {
 public:
  using Log = std::function<void(const LogLine&)>;

  // All that it refers to outlives it. leave_after: from the start of motions. capture: null: nothing is recorded.
  Daemon(boost::asio::io_context& io, PeerNode& node, net::Transport& transport, const net::HostClock& clock, Log log,
         std::optional<Duration> leave_after, record::CaptureWriter* capture = nullptr);

  // One line of the control protocol; the reply to "leave" is out before the peer is gone.
  std::string on_control(std::string_view line);
  // One datagram of a program that moves objects; or, not to be recorded, the poses of one.
  void on_poses(std::string_view datagram);
  void on_poses(std::span<const feed::FedPose> poses);
  // Each update gets a line from now on. They are many: else not even their words are put together.
  void log_updates() { logs_updates_ = true; }
  // Whenever it has done something, it looks for more for so long before it sleeps, so that what comes meanwhile need
  // not wake it. Not negative; zero, as at first: it sleeps at once. Every kCacheWarmingPeriod of that it runs
  // `cache_warmer`, if there is one; that outlives it.
  void busy_poll(Duration before_sleep, CacheWarmer* cache_warmer = nullptr) {
    busy_poll_ = before_sleep;
    cache_warmer_ = cache_warmer;
  }
  static constexpr Duration kCacheWarmingPeriod = std::chrono::microseconds(200);
  // `handler` is called whenever a datagram has been taken: what it told is in the node's ghosts by then, and what the
  // node has to say to that leaves afterwards.
  void on_received(std::function<void()> handler) { received_handler_ = std::move(handler); }

  // Until a signal comes, it is told to leave or the scenario is over. The exit code.
  int run();

  // Counts the datagrams that came before something that the peer had been told of.
  [[nodiscard]] const net::ForwardTime& forward() const { return forward_; }
  [[nodiscard]] const TickLateness& lateness() const { return lateness_; }

 private:
  HostTime now() { return forward_(clock_.now()); }
  void serve();
  void wake();
  void read_os_clock_into_node(HostTime now);
  void follow_interface();
  void leave();
  void stop();
  void drain();
  void keep_capture();
  void check(const std::expected<void, net::NetError>& done);

  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;
  boost::asio::signal_set signals_;
  PeerNode& node_;
  net::Transport& transport_;
  const net::HostClock& clock_;
  Log log_;
  std::optional<Duration> leave_after_;
  record::CaptureWriter* capture_;  // null: none, or none any more
  std::function<void()> received_handler_;
  net::ForwardTime forward_;
  TickLateness lateness_;
  std::optional<HostTime> due_;  // what the timer was set for
  HostTime system_due_ = HostTime::min();
  Duration busy_poll_{0};
  CacheWarmer* cache_warmer_ = nullptr;  // null: none
  bool logs_updates_ = false;
  bool over_ = false;
  int exit_code_ = 0;
};

}  // namespace peerd
