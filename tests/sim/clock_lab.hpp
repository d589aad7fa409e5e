#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "peerd/lab/sim/network.hpp"
#include "replication/peer/peer.hpp"

namespace peerd::sim::testing_support {

// Peers of an empty world on the simulated network, on hosts whose clocks drift, jump and stop; and an oracle that sees
// the session time of all of them at one true instant, which no peer can.
//
// At every call of a peer (tick or datagram) its session time is read, must not be before the last reading, and is
// compared with that of the peer it follows, read at the same true instant.
class ClockLab {
 public:
  struct HostSettings {
    Duration ahead{0};
    int drift_ppm = 0;
    // How far the clock of its operating system is ahead of true time, and the error bound that this clock states;
    // without a bound it states that it does not know.
    Duration os_error{0};
    std::optional<Duration> os_bound = {};
  };
  struct Sample {
    Duration at;  // true time since the begin
    std::size_t peer;
    Duration error, bound;  // against the peer that it follows
    Duration followed_for;  // without a break, by both of the two
  };

  ClockLab(const config::LinkSettings& links, std::vector<HostSettings> hosts, std::uint64_t seed);
  // Makes one direction of one link another link. The caller calls it before run_until().
  void set_link(std::size_t from, std::size_t to, const config::LinkSettings& link);
  void run_until(Duration t);

  // Makes this host's clock jump forward by so much.
  void jump(std::size_t peer, Duration by) { hosts_[peer].ahead += by; }
  // Nothing runs on this host and what is sent to it is lost until wake(). `clock_runs`: its clock counts on meanwhile.
  void suspend(std::size_t peer, bool clock_runs);
  void wake(std::size_t peer);
  // Its peer says goodbye; a new one starts on the same host.
  void leave(std::size_t peer);
  void start(std::size_t peer);
  // The operating system's clock is set.
  void set_os_clock(std::size_t peer, Duration error, std::optional<Duration> bound);
  // The network falls apart into these and the others; none: it is whole again.
  void part(std::vector<std::size_t> side) { apart_ = std::move(side); }
  // Nobody can know the error of this peer and of its followers until then: its clock has just jumped.
  void restart_silence_of_all(std::size_t peer, Duration until) { hosts_[peer].excused_until = until; }

  [[nodiscard]] Duration now() const { return now_; }
  [[nodiscard]] const replication::Peer& peer(std::size_t i) const { return *hosts_[i].peer; }
  [[nodiscard]] HostTime host_now(std::size_t i) const { return host_at(i, now_); }
  [[nodiscard]] SimTime session_now(std::size_t i) const { return peer(i).clock().to_session(host_now(i)); }
  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] std::size_t steps(std::size_t i) const { return hosts_[i].steps; }
  [[nodiscard]] std::size_t excused() const { return excused_; }
  // Broken invariants: times that ran backwards, errors beyond their bound. Empty is good.
  [[nodiscard]] const std::vector<std::string>& findings() const { return findings_; }

 private:
  struct Host : HostSettings {
    std::unique_ptr<replication::Peer> peer;
    bool runs = true, clock_runs = true;
    Duration stopped_at{0};
    std::uint64_t incarnation = 1;
    std::optional<SimTime> last_reading;
    Duration excused_until{-1};
    std::size_t steps = 0;
    std::optional<PeerId> follows;
    Duration follows_since{0};
  };

  [[nodiscard]] HostTime host_at(std::size_t i, Duration t) const;
  [[nodiscard]] Duration true_time(std::size_t i, HostTime host) const;
  [[nodiscard]] Duration deadline(std::size_t i) const;
  [[nodiscard]] bool apart(std::size_t a, std::size_t b) const;
  void drain(std::size_t i);
  void look(std::size_t i);

  config::RunSettings run_;
  std::unique_ptr<Network> network_;
  std::unique_ptr<const Scene> scene_;
  std::unique_ptr<const replication::WorldModel> model_;
  std::vector<Host> hosts_;
  std::vector<std::size_t> apart_;
  Duration longest_delay_{0};
  Duration now_{0};
  std::vector<Sample> samples_;
  std::size_t excused_ = 0;
  std::vector<std::string> findings_;
};

}  // namespace peerd::sim::testing_support
