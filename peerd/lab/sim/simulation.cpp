#include "peerd/lab/sim/simulation.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "peerd/lab/sim/clock_oracle.hpp"
#include "peerd/lab/sim/event_times.hpp"
#include "peerd/lab/sim/interest_oracle.hpp"
#include "peerd/lab/sim/network.hpp"
#include "peerd/net/transport/transport_options.hpp"
#include "peerd/peer/config/shown_path.hpp"
#include "peerd/peer/record/capture.hpp"
#include "replication/settings/output/tick_grid.hpp"

namespace peerd::sim {
namespace {

// The virtual clock starts here, so that no host's clock offset makes a time negative.
constexpr VirtualTime kBegin{std::chrono::seconds(10'000'000)};
// Peers that have not all joined after this time never will: the scenario's links lose everything.
constexpr Duration kJoinWithin = std::chrono::seconds(600);

struct SimulatedPeer {
  std::unique_ptr<PeerNode> node;  // null: the peer is not there
  Duration clock_offset;
  VirtualTime came_at;
  VirtualTime due{};  // deadline(), which changes with what the node takes in alone
  bool late = false;  // it came when the motions had begun
  std::uint64_t incarnations = 0;
  std::unique_ptr<record::CaptureWriter> capture = nullptr;  // null: none

  [[nodiscard]] HostTime host(VirtualTime t) const { return HostTime{t.time_since_epoch() + clock_offset}; }
  [[nodiscard]] VirtualTime virtual_time(HostTime t) const { return VirtualTime{t.time_since_epoch() - clock_offset}; }
  [[nodiscard]] VirtualTime deadline() const {
    const HostTime host = node->next_deadline();
    return host == HostTime::min() ? came_at : virtual_time(host);
  }
};

constexpr double kFallback_s = 1.0;

std::optional<InputError> why_not_simulated(const config::RunSettings& run,
                                            const std::vector<config::PeerObjects>& objects) {
  if (run.baseline.system != config::BaselineSystem::kNone) {
    return InputError{"error: baseline.system: this needs peers of this project; peerd sim alone runs other systems"};
  }
  for (std::size_t i = 0; i < run.peers.size(); ++i) {
    if (objects[i].outside.empty()) continue;  // the program's poses would depend on how fast this computer simulates
    return InputError{
        "error: peer." + run.peers[i].name + " leaves " + config::shown(objects[i].outside.begin()->first) +
        " to a program outside, which runs in real time, and a simulation does not; use peerd run or peerd "
        "scenario, or move it by a formula or a recorded track"};
  }
  return std::nullopt;
}

// The address that a simulated peer's datagrams have in captures: 10.ID or fd00::ID.
boost::asio::ip::udp::endpoint address_of(const config::PeerSettings& peer, const net::GroupPlan& groups) {
  namespace ip = boost::asio::ip;
  if (groups.base.is_v4()) return {ip::address_v4(10u << 24 | (peer.id & 0xFF'FFFF)), groups.port};
  ip::address_v6::bytes_type bytes{0xFD};
  for (std::size_t i = 0; i < 4; ++i) bytes[15 - i] = static_cast<unsigned char>(peer.id >> 8 * i);
  return {ip::address_v6(bytes), groups.port};
}

// The state of a run in progress.
class Simulation {
 public:
  Simulation(const config::RunSettings& run, const SharedWorld& shared, const Observer& observer,
             const ActionObserver& action_observer, const Captures* captures, LogRows* rows, const Progress& progress,
             PeersWatch* watch)
      : run_(run),
        shared_(shared),
        observer_(observer),
        action_observer_(action_observer),
        captures_(captures),
        rows_(rows),
        progress_(progress),
        watch_(watch),
        network_(run),
        events_(run.events),
        longest_delay_s_(config::longest_delay_s(run)) {}

  Result<std::vector<PeerLog>> all(std::optional<measure::InterestRecord>* interest) {
    auto objects = config::resolve(run_, shared_.world.scene);
    if (!objects) return std::unexpected(objects.error());
    if (const auto error = why_not_simulated(run_, *objects)) return std::unexpected(*error);
    if (captures_ != nullptr) {
      if (config::peers_change(run_.events)) {
        return std::unexpected(InputError{
            "error: --capture: a capture is of one life of a peer, and here peers join, leave or are killed"});
      }
      const auto reach = net::transport_options(run_.transport, {});
      if (!reach) return std::unexpected(reach.error());
      const std::uint64_t session_hash = run_.replication.session_hash(shared_.world.hash);
      groups_ = net::plan_of_world(reach->multicast.groups, session_hash);
    }
    for (std::size_t i = 0; i < run_.peers.size(); ++i) {
      peers_.push_back({nullptr, from_seconds(run_.peers[i].clock_offset_s), kBegin});
      if (!config::starts_with(run_.events, run_.peers[i].name)) continue;
      if (const auto error = enter(i, std::move((*objects)[i]), false)) return std::unexpected(*error);
    }
    for (std::size_t i = 0; i < peers_.size(); ++i) {
      auto& unused = unused_.emplace_back();
      if (!peers_[i].node) unused = std::move((*objects)[i]);
    }
    if (interest != nullptr && InterestOracle::has_areas(run_)) {
      if (config::peers_change(run_.events)) {
        return std::unexpected(InputError{
            "error: interest_radius_m: what comes of it is not measured yet where peers join, leave or are killed"});
      }
      std::vector<WatchedPeer> watched;
      for (const SimulatedPeer& p : peers_) watched.push_back({p.node.get(), p.clock_offset});
      oracle_.emplace(run_, shared_.world.scene, std::move(watched));
    }
    if (!config::peers_change(run_.events)) {  // the clock oracle watches a fixed set of peers
      std::vector<ClockOracle::WatchedPeer> clocks;
      for (const SimulatedPeer& p : peers_) clocks.push_back({p.node.get(), p.clock_offset});
      clock_oracle_.emplace(std::move(clocks));
    }
    for (std::size_t i = 0; i < peers_.size(); ++i) drain(i);
    if (const auto error = go_on()) return std::unexpected(*error);
    if (oracle_) *interest = oracle_->record();
    for (SimulatedPeer& p : peers_) {
      if (p.node) logs_.push_back(p.node->log());
      if (clock_oracle_) logs_.back().clock_error = clock_oracle_->error_of(logs_.size() - 1);
      if (p.capture) p.capture->flush();
      if (p.capture && !p.capture->good()) {
        return std::unexpected(InputError{
            "error: can't write the captures to " + captures_->folder.string() + "; is the disk full?", kSystemFailed});
      }
    }
    std::ranges::stable_sort(logs_, {}, &PeerLog::peer);
    return std::move(logs_);
  }

 private:
  std::optional<InputError> enter(std::size_t i, config::PeerObjects objects, bool late) {
    SimulatedPeer& peer = peers_[i];
    PeerNode::Options options;
    options.incarnation = ++peer.incarnations;
    options.late = late;
    for (const config::PeerSettings& p : run_.peers) {
      if (config::starts_with(run_.events, p.name)) options.wait_for.push_back({PeerId{p.id}, p.name});
    }
    // All peers must know the start, and the objects that already move, before it comes.
    options.start_lead = from_seconds(1.0 + 2.0 * longest_delay_s_);
    options.clock_offset = peer.clock_offset;
    options.sample_hz = run_.sample_hz;
    options.rows = rows_;
    peer.came_at = now_;
    peer.late = late;
    if (captures_ != nullptr) {
      const config::PeerSettings& settings = run_.peers[i];
      auto opened = record::CaptureWriter::open(
          captures_->folder / (settings.name + ".pcapng"),
          record::make_setup(captures_->scenario, run_, settings, captures_->file, shared_, options, groups_),
          peer.host(now_), address_of(settings, groups_).address());
      if (!opened) return opened.error();
      peer.capture = *std::move(opened);
    }
    peer.node = PeerNode::make(run_.peers[i], run_.replication, shared_, std::move(objects), std::move(options));
    if (rows_ != nullptr) rows_->enter(peer.node->log());
    return std::nullopt;
  }

  void end(std::size_t i, bool with_a_goodbye) {
    SimulatedPeer& peer = peers_[i];
    if (with_a_goodbye) {
      peer.node->leave(peer.host(now_));
      drain(i);
    }
    PeerLog& log = logs_.emplace_back(peer.node->log());
    log.ended_at = HostTime{now_.time_since_epoch()};
    if (rows_ != nullptr) rows_->end(log.peer, *log.ended_at);
    peer.node.reset();
    due_.erase({peer.due, i});
    network_.leave_all(i);
  }

  std::optional<InputError> happen(const config::ScenarioEvent& event) {
    using config::EventKind;
    const auto index = [&](const std::string& name) {
      const auto at = std::ranges::find(run_.peers, name, &config::PeerSettings::name);
      return static_cast<std::size_t>(at - run_.peers.begin());
    };
    switch (event.kind) {
      case EventKind::kJoin: {
        const std::size_t i = index(event.peer);
        if (!unused_[i]) {  // it has been there before
          auto objects = config::resolve(run_, shared_.world.scene);
          if (!objects) return objects.error();
          unused_[i] = std::move((*objects)[i]);
        }
        config::PeerObjects objects = std::move(*unused_[i]);
        unused_[i].reset();
        if (auto error = enter(i, std::move(objects), true)) return error;
        drain(i);
        break;
      }
      case EventKind::kLeave:
      case EventKind::kKill:
        end(index(event.peer), event.kind == EventKind::kLeave);
        break;
      case EventKind::kPartition:
        network_.part(event.sides);
        break;
      case EventKind::kHeal:
        network_.part({});
        break;
      case EventKind::kNetwork:
        for (std::size_t from = 0; from < peers_.size(); ++from) {
          for (std::size_t to = 0; to < peers_.size(); ++to) {
            const bool meant =
                (event.from.empty() || from == index(event.from)) && (event.to.empty() || to == index(event.to));
            if (meant) network_.change(from, to, event.change);
          }
        }
        break;
      case EventKind::kKey:  // the peer presses it, or makes it, by itself (config::give_to_peers)
      case EventKind::kEdit:
        break;
    }
    return std::nullopt;
  }

  void drain(std::size_t i) {
    if (!peers_[i].node) return;
    PeerNode& node = *peers_[i].node;
    while (auto out = node.poll_output()) {
      if (auto* send = std::get_if<replication::Send>(&*out)) {
        if (peers_[i].capture) peers_[i].capture->on_send(send->region, send->datagram);
        if (oracle_) oracle_->on_send(now_, i, send->region, send->datagram, network_);
        network_.send(now_, i, send->region, std::move(send->datagram));
        continue;
      }
      if (const auto* join = std::get_if<replication::Join>(&*out)) network_.join(i, join->region);
      if (const auto* leave = std::get_if<replication::Leave>(&*out)) network_.leave(i, leave->region);
      const bool joins = std::holds_alternative<replication::Join>(*out);
      if (oracle_ && (joins || std::holds_alternative<replication::Leave>(*out))) {
        oracle_->on_membership(now_, i, joins);
      }
      if (observer_) observer_(HostTime{now_.time_since_epoch()}, node, *out);
    }
    const auto act = [&](const LogLine& line, bool done) {
      if (action_observer_) action_observer_(HostTime{now_.time_since_epoch()}, node, line, done);
    };
    while (const auto key = node.poll_key_report()) {
      for (const LogLine& line : describe(*key, node.scene())) act(line, key->done());
    }
    while (const auto edit = node.poll_edit_report()) act(describe(*edit), edit->done());
    set_due(i, peers_[i].deadline());
  }

  void set_due(std::size_t i, VirtualTime due) {
    due_.erase({peers_[i].due, i});
    peers_[i].due = due;
    due_.emplace(due, i);
  }

  // The peer whose tick is next; none where no peer is there.
  [[nodiscard]] std::optional<std::size_t> next_peer() const {
    return due_.empty() ? std::nullopt : std::optional(due_.begin()->second);
  }

  void note_begin() {
    for (const SimulatedPeer& p : peers_) {
      if (events_.begun() || !p.node || !p.node->start()) continue;
      events_.begin(p.virtual_time(p.node->peer().clock().to_host(*p.node->start())));
      if (watch_ != nullptr) watch_->begin(*p.node->start(), HostTime{events_.begun()->time_since_epoch()});
    }
  }

  // Lets the watch see the peers at its instants up to `until`.
  void watch_until(VirtualTime until) {
    if (watch_ == nullptr || !events_.begun()) return;
    for (;; ++next_watch_) {
      const Duration since = replication::TickGrid(watch_->rate_hz()).time_of(next_watch_).time_since_epoch();
      const VirtualTime at = *events_.begun() + since;
      if (at > until || since > from_seconds(run_.duration_s)) return;
      std::vector<SeenPeer> seen;
      for (const SimulatedPeer& p : peers_) seen.push_back({p.node.get(), p.host(at)});
      watch_->see(to_seconds(since), seen);
    }
  }

  [[nodiscard]] std::optional<double> run_time_s() const {
    if (!events_.begun()) return std::nullopt;
    return to_seconds(now_ - *events_.begun());
  }

  // Runs to the end, to where it is stopped, or to an error.
  std::optional<InputError> go_on() {
    // The run lingers so that late updates still arrive and deferred contacts are decided and applied: a fallback waits
    // for two latencies and three hellos.
    const Duration linger = from_seconds(run_.duration_s + 3.0 * longest_delay_s_ + kFallback_s);
    while (!progress_ || progress_(run_time_s())) {
      const std::optional<std::size_t> next = next_peer();
      const std::optional<VirtualTime> event_at = events_.next();
      if (!next && !event_at) return std::nullopt;  // all peers have gone
      const VirtualTime tick_at = next ? std::max(now_, peers_[*next].due) : VirtualTime::max();
      const VirtualTime first_at = network_.idle() ? tick_at : std::min(tick_at, network_.next_delivery());
      watch_until(event_at ? std::min(*event_at, first_at) : first_at);
      if (event_at && *event_at <= first_at) {
        now_ = std::max(now_, *event_at);
        if (const auto error = happen(events_.take())) return error;
        continue;
      }
      while (oracle_ && oracle_->next_sample_time() && *oracle_->next_sample_time() < first_at) oracle_->take_sample();
      if (!network_.idle() &&
          network_.next_delivery() <=
              tick_at) {  // datagrams precede a tick of the same time, because a tick begins by draining them
        const Delivery d = network_.take_next();
        now_ = d.at;
        const SimulatedPeer& to = peers_[d.to];
        if (!to.node) continue;
        if (to.capture) {
          to.capture->on_packet(to.host(now_), address_of(run_.peers[d.from], groups_), d.region, *d.datagram);
        }
        to.node->on_packet(to.host(now_), d.region, *d.datagram);
        drain(d.to);
        continue;
      }
      now_ = tick_at;
      PeerNode& node = *peers_[*next].node;
      const HostTime host = peers_[*next].host(now_);
      if (peers_[*next].capture) peers_[*next].capture->on_tick(host);
      node.on_tick(host);
      drain(*next);
      if (clock_oracle_) clock_oracle_->take_sample(HostTime{now_.time_since_epoch()}, *next);
      if (!events_.begun()) note_begin();
      if (!node.start() && peers_[*next].late && events_.begun() && now_ > *events_.begun() + linger)
        return std::nullopt;
      if (!node.start() && now_ - peers_[*next].came_at > kJoinWithin) {
        return InputError{"error: peer " + run_.peers[*next].name +
                          " never had all the others; does the network lose everything?"};
      }
      if (node.start() && node.peer().clock().to_session(host) > *node.start() + linger) return std::nullopt;
    }
    return std::nullopt;
  }

  const config::RunSettings& run_;
  const SharedWorld& shared_;
  const Observer& observer_;
  const ActionObserver& action_observer_;
  const Captures* captures_;  // null: none
  LogRows* rows_;             // null: the logs keep their rows
  const Progress& progress_;  // empty: nobody asks
  PeersWatch* watch_;         // null: nobody watches
  std::int64_t next_watch_ = 0;
  net::GroupPlan groups_;  // named in the captures
  Network network_;
  EventTimes events_;
  double longest_delay_s_;
  VirtualTime now_ = kBegin;
  std::vector<SimulatedPeer> peers_;                        // in the run's order
  std::set<std::pair<VirtualTime, std::size_t>> due_;       // of the peers that are there
  std::vector<std::optional<config::PeerObjects>> unused_;  // of those that have not been there yet
  std::vector<PeerLog> logs_;                               // logs of peers that have left
  std::optional<InterestOracle> oracle_;
  std::optional<ClockOracle> clock_oracle_;
};

}  // namespace

config::RunSettings without_latency(config::RunSettings run) {
  run.network = {};
  run.islands.clear();
  run.island_of.clear();
  run.links.clear();
  std::erase_if(run.events, [](const config::ScenarioEvent& e) { return e.peer.empty(); });  // events of the network
  run.replication.policy.error_threshold_m = 0.0;
  run.replication.policy.order = replication::ModelOrder::kSecond;
  run.replication.policy.predict_collisions = true;
  run.replication.decisions = {};
  run.baseline = {};
  return run;
}

Result<std::vector<PeerLog>> simulate(const config::RunSettings& run, const SharedWorld& shared,
                                      const Observer& observer, const ActionObserver& action_observer,
                                      std::optional<measure::InterestRecord>* interest, const Captures* captures,
                                      LogRows* rows, const Progress& progress, PeersWatch* watch) {
  return Simulation(run, shared, observer, action_observer, captures, rows, progress, watch).all(interest);
}

}  // namespace peerd::sim
