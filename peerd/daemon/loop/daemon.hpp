#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/daemon/loop/tick_lateness.hpp"
#include "peerd/net/os/forward_time.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/transport.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/control/event_sink.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "peerd/peer/record/capture.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/store_keeper.hpp"
#include "replication/session/identity.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd {

class CacheWarmer;

// Drives a peer over a real clock and a real network, in one thread.
//
// The peer gets the time at which a datagram arrived, not that at which it was read, and the peer's `now` must not run
// backwards: a datagram that arrived before the last input counts as having arrived with that input. A tick first reads
// the datagrams that wait, so that this is rare and the difference small; ForwardTime counts it.
//
// Only ticks wait for their time: a datagram is applied when it is read, and the updates that a program or a key causes
// leave in the same turn of the loop.
class Daemon {
 public:
  using Log = std::function<void(const LogLine&)>;

  // All arguments by reference and pointer outlive the daemon. It leaves `leave_after` after the start of the motions.
  // Without a `capture` nothing is recorded.
  Daemon(boost::asio::io_context& io, PeerNode& node, net::Transport& transport, const net::HostClock& clock, Log log,
         std::optional<Duration> leave_after, record::CaptureWriter* capture = nullptr);

  // Answers one line of the control protocol; the reply to "leave" is out before the peer leaves.
  control::Answer on_control(std::string_view line);
  // Events go to the clients of this server, too, that have subscribed. It outlives the run.
  void publish_to(control::EventSink& clients) { event_sinks_.push_back(&clients); }
  // Calls `handler` with each thing that happens at the peer, after the datagrams that say so have left.
  void on_event(std::function<void(const replication::Output&)> handler) { event_handler_ = std::move(handler); }
  // The "status" of the control protocol has this, too. The function outlives the run.
  void add_to_status(control::AskMore more) { more_status_.push_back(std::move(more)); }
  // The control protocol says that the peer's page is there.
  void serves_viewer_at(std::string url) { viewer_url_ = std::move(url); }
  // Takes one datagram of an external program.
  void on_poses(std::string_view datagram);
  // Takes poses of a program in this process; there must be no capture, which could not record them. Before the peer
  // has begun, and after it has left, it takes none.
  feed::Outcome on_poses(std::span<const feed::FedPose> poses);
  // Logs each update from now on. Updates are many, so without this call their lines are not even composed.
  void log_updates() { logs_updates_ = true; }
  // After each event the daemon polls for this long before it sleeps, so that the next event need not wake it. The time
  // is not negative; with zero, the default, the daemon sleeps at once. While it polls, it runs `cache_warmer`, which
  // may be null and outlives it, every kCacheWarmingPeriod.
  void busy_poll(Duration before_sleep, CacheWarmer* cache_warmer = nullptr) {
    busy_poll_ = before_sleep;
    cache_warmer_ = cache_warmer;
  }
  static constexpr Duration kCacheWarmingPeriod = std::chrono::microseconds(200);
  // Calls `handler` whenever the node has taken a datagram: its ghosts are up to date by then, and its answers leave
  // afterwards.
  void on_received(std::function<void()> handler) { received_handler_ = std::move(handler); }

  // Calls `handler` once the peer takes part in the session, and the other one when it begins to leave.
  void on_begin(std::function<void()> handler) { begin_handler_ = std::move(handler); }
  void on_leave(std::function<void()> handler) { leave_handler_ = std::move(handler); }
  // SIGHUP calls `handler` and is no reason to leave any more. To be called before run().
  void on_hangup(std::function<void()> handler) { hangup_handler_ = std::move(handler); }

  // The growth of logs that LogGrown says goes to the store from now on.
  void keep(store::OperationStore& store) {
    store_ = &store;
    keeper_.emplace(store, node_.peer().logs());
  }

  // Before it takes part in the session, the daemon asks for kIdentityIsAskedFor whether a peer of its identity is
  // alive already; where one answers, it ends with exit code 3.
  void ask_first(const replication::IdentityQuestion& question) { question_ = question; }
  static constexpr Duration kIdentityIsAskedFor = std::chrono::seconds(1);

  // From now on the process's signals are the peer's: on those that end a process it leaves.
  void take_signals();
  // Runs until such a signal, a request to leave or the end of the scenario. Returns the exit code.
  int run();
  // The same for a program that has a loop of its own: the peer takes part from begin() on, as far as poll() is called.
  // That does what is due, and where nothing is, waits for it, at most for so long. False: the peer has left.
  void begin();
  bool poll(Duration at_most);
  void leave();
  [[nodiscard]] bool has_left() const { return over_; }
  [[nodiscard]] int exit_code() const { return exit_code_; }

  // The time of an input that the peer gets now.
  [[nodiscard]] HostTime now() { return forward_(clock_.now()); }
  // The part of "status" that the peer itself does not know.
  [[nodiscard]] control::More more_status() const;

  // Counts the datagrams that arrived before an input that the peer had got already.
  [[nodiscard]] const net::ForwardTime& forward() const { return forward_; }
  [[nodiscard]] const TickLateness& lateness() const { return lateness_; }

 private:
  void await_signal();
  void take_part();
  void ask(HostTime until);
  void on_datagram(const net::Arrival& arrival);
  void serve();
  void wake();
  void read_os_clock_into_node(HostTime now);
  void follow_interface();
  void log_missing();
  void stop();
  void drain();
  void keep_capture();
  void publish(const replication::Output& event);
  // Writes what has grown; there is a keeper. False: this peer must not go on.
  [[nodiscard]] bool store_growth();
  void check(const std::expected<void, net::NetError>& done);

  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;
  boost::asio::signal_set signals_;
  PeerNode& node_;
  net::Transport& transport_;
  const net::HostClock& clock_;
  Log log_;
  std::optional<Duration> leave_after_;
  std::optional<replication::IdentityQuestion> question_;  // is being asked: the peer has not begun
  store::OperationStore* store_ = nullptr;                 // null: none, and no keeper
  std::optional<store::StoreKeeper> keeper_;
  std::vector<control::EventSink*> event_sinks_;
  std::function<void(const replication::Output&)> event_handler_;
  std::vector<control::AskMore> more_status_;
  std::string viewer_url_;          // empty: it has no page
  record::CaptureWriter* capture_;  // null: none, or it has failed
  std::function<void()> received_handler_, begin_handler_, leave_handler_, hangup_handler_;
  net::ForwardTime forward_;
  TickLateness lateness_;
  std::optional<HostTime> due_;  // expiry of the timer
  HostTime system_due_ = HostTime::min();
  Duration busy_poll_{0};
  CacheWarmer* cache_warmer_ = nullptr;  // null: none
  std::vector<AwaitedPeer> missing_;     // as logged last
  bool logs_updates_ = false;
  bool over_ = false;
  int exit_code_ = 0;
};

}  // namespace peerd
