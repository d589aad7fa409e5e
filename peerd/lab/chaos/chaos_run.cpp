#include "peerd/lab/chaos/chaos_run.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <variant>

#include <spdlog/fmt/fmt.h>

#include "peerd/lab/chaos/damaged_network.hpp"
#include "peerd/lab/chaos/edit_maker.hpp"
#include "peerd/lab/chaos/host_store.hpp"
#include "peerd/lab/chaos/oracle.hpp"
#include "peerd/lab/chaos/random_stream.hpp"
#include "peerd/lab/chaos/skewed_clock.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::chaos {
namespace {

using sim::VirtualTime;

// The virtual clock starts here, so that no host's clock is negative.
constexpr VirtualTime kClockBegin{std::chrono::seconds(10'000'000)};
constexpr Duration kCheckEvery = std::chrono::milliseconds(250);
constexpr std::uint32_t kGhostSamples_hz = 4;
// The host of a daemon whose clock is kept by NTP says so.
constexpr Duration kOsClockError = std::chrono::milliseconds(20);

struct Host {
  std::unique_ptr<PeerNode> node;  // null: nobody runs here
  SkewedClock clock;
  double wall_offset_s = 0.0;
  std::uint64_t incarnation = 0;
  bool joined = false;
  std::set<std::size_t> down_by;  // the faults that keep it down, by their index
  VirtualTime runs_from = kClockBegin, due = kClockBegin;
  std::optional<std::size_t> dies_by;  // this fault ends it as soon as an operation of it is held
  bool states_os_clock = false;
  std::unique_ptr<HostStore> store;             // null: nobody ever stores anything here
  std::optional<std::size_t> dies_at_write_by;  // this fault ends it with a write of its disk
};

// The things that are due at an instant.
struct Due {
  enum class Kind : std::uint8_t { kJoin, kBegin, kEnd, kEdit, kHeal, kCheck, kStop };
  Kind kind{};
  std::size_t index = 0;
};

class ChaosRun {
 public:
  explicit ChaosRun(const ChaosPlan& plan)
      : plan_(plan),
        shared_(share(plan.world)),
        network_(plan.seed, plan.peers.size(), plan.links),
        oracle_(plan.peers.size(), !plan.has(Rare::kUnchecked)),
        hosts_(plan.peers.size()) {
    oracle_.set_file(shared_->world.scene);
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
      hosts_[i].wall_offset_s = plan.peers[i].wall_offset_s;
      hosts_[i].states_os_clock = stream_of(plan.seed, Stream::kOsClock, i).chance(0.4);
      if (plan.peers[i].has_store) {
        hosts_[i].store = std::make_unique<HostStore>(stream_of(plan.seed, Stream::kDisk, i), name_of(i));
      }
      schedule(plan.peers[i].joins_at_s, Due::Kind::kJoin, i);
    }
    for (std::size_t i = 0; i < plan.faults.size(); ++i) {
      schedule(plan.faults[i].at_s, Due::Kind::kBegin, i);
      schedule(plan.faults[i].at_s + plan.faults[i].for_s, Due::Kind::kEnd, i);
    }
    for (std::size_t i = 0; i < plan.edits.size(); ++i) schedule(plan.edits[i].at_s, Due::Kind::kEdit, i);
    schedule(plan.heal_s, Due::Kind::kHeal, 0);
    schedule(plan.limits.seconds, Due::Kind::kStop, 0);
    due_.emplace(kClockBegin, Due{Due::Kind::kCheck, 0});
  }

  ChaosReport all() {
    while (!stopped_) step();
    oracle_.finish(now_s());
    check_damage();
    if (!plan_.has(Rare::kUnchecked) && !one_world_after_s_) {
      oracle_.violate(now_s(), "the peers have never had one scene since the network healed");
    }
    ChaosReport report;
    report.seed = plan_.seed;
    report.violations = oracle_.violations();
    report.trace_hash = trace_;
    report.peers = hosts_.size();
    for (const Host& host : hosts_) report.lives += host.incarnation;
    report.faults = plan_.faults.size();
    report.edits = plan_.edits.size();
    report.operations = oracle_.operations();
    report.held = oracle_.held();
    report.datagrams = network_.counters().sent;
    report.damaged = network_.counters().damaged;
    report.one_world_after_s = one_world_after_s_;
    for (const Host& host : hosts_) {
      if (host.store) oracle_.count(host.store->disk().counters());
    }
    report.branches = oracle_.branches();
    return report;
  }

 private:
  void schedule(double at_s, Due::Kind kind, std::size_t index) {
    due_.emplace(kClockBegin + from_seconds(at_s), Due{kind, index});
  }
  [[nodiscard]] std::string name_of(std::size_t i) const { return fmt::format("p{}", plan_.peers[i].id); }
  [[nodiscard]] double now_s() const { return to_seconds(now_ - kClockBegin); }

  // The host that is due next; none where nobody runs.
  [[nodiscard]] std::optional<std::pair<VirtualTime, std::size_t>> next_tick() const {
    std::optional<std::pair<VirtualTime, std::size_t>> next;
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
      if (!hosts_[i].node) continue;
      const VirtualTime at = std::max({hosts_[i].due, hosts_[i].runs_from, now_});
      if (!next || at < next->first) next = {at, i};
    }
    return next;
  }

  void step() {
    const auto tick = next_tick();
    const VirtualTime tick_at = tick ? tick->first : VirtualTime::max();
    const VirtualTime arrival_at = network_.idle() ? VirtualTime::max() : network_.next_arrival();
    const VirtualTime due_at = due_.begin()->first;
    if (due_at <= std::min(tick_at, arrival_at)) {
      now_ = std::max(now_, due_at);
      const Due due = due_.begin()->second;
      due_.erase(due_.begin());
      happen(due);
    } else if (arrival_at <= tick_at) {
      now_ = std::max(now_, arrival_at);
      arrive(network_.take_next());
    } else {
      now_ = tick_at;
      tick_host(tick->second);
    }
  }

  // After each input: the deadline changes by that alone.
  void note_deadline(std::size_t i) {
    Host& host = hosts_[i];
    HostTime deadline = host.node->next_deadline();
    if (const auto* keeper = keeper_of(i)) deadline = std::min(deadline, keeper->due());
    host.due = deadline == HostTime::min() ? now_ : host.clock.when(deadline);
  }

  void tick_host(std::size_t i) {
    const auto* keeper = keeper_of(i);
    if (keeper != nullptr && host_now(i) >= keeper->due() && !write_store(i)) return;
    hosts_[i].node->on_tick(host_now(i));
    drain(i);
  }

  [[nodiscard]] const store::StoreKeeper* keeper_of(std::size_t i) const {
    return hosts_[i].store ? hosts_[i].store->keeper() : nullptr;
  }

  // False: the peer has ended.
  bool write_store(std::size_t i) {
    Host& host = hosts_[i];
    const auto written = host.store->write(host_now(i));
    if (host.store->disk().is_dead()) {
      die_by_disk(i);
      return false;
    }
    if (written.own) {
      host.node->note_stored(*written.own);
      oracle_.on_stored(i, *written.own);
    }
    if (written.error) {
      host.node->note_store_failed();
      oracle_.count("store could not be written");
    }
    if (written.is_good_again) oracle_.count("store good again");
    if (!written.must_stop) return true;
    oracle_.count("peer ended, because it could contradict itself");
    const auto fault = disk_fault_of(i);
    if (!fault) oracle_.violate(now_s(), fmt::format("the store of peer {} fails for no reason", i + 1));
    stop(i, false);
    if (fault) host.down_by.insert(*fault);
    return false;
  }

  // The fault by which the disk fails now.
  [[nodiscard]] std::optional<std::size_t> disk_fault_of(std::size_t i) const {
    const auto of_host = [&](std::size_t fault) { return plan_.faults[fault].peer == i; };
    const auto fault = std::ranges::find_if(disk_faults_, of_host);
    return fault == disk_faults_.end() ? std::nullopt : std::optional(*fault);
  }

  void die_by_disk(std::size_t i) {
    const std::size_t fault = std::exchange(hosts_[i].dies_at_write_by, std::nullopt).value();
    oracle_.count("peer died in a write of its disk");
    hosts_[i].down_by.insert(fault);
    stop(i, false, plan_.faults[fault].disk.power_fails);
  }

  [[nodiscard]] HostTime host_now(std::size_t i) const { return hosts_[i].clock.at(now_); }

  void arrive(DamagedNetwork::Arrival arrival) {
    const std::size_t to = arrival.delivery.to;
    Host& host = hosts_[to];
    if (!host.node) {
      damage_unread_ += arrival.is_damaged ? 1 : 0;
      return;
    }
    if (host.runs_from > now_) {  // it waits in the buffer of the socket
      network_.put_off(std::move(arrival), host.runs_from);
      return;
    }
    if (arrival.is_damaged && !plan_.has(Rare::kUnchecked)) {
      ++damage_refused_;
      return;
    }
    const std::uint64_t before = arrival.is_damaged ? seen_by(*host.node) : 0;
    host.node->on_packet(host_now(to), arrival.delivery.region, *arrival.delivery.datagram);
    if (arrival.is_damaged) note_damage(to, before);
    drain(to);
  }

  // The datagrams that a peer has taken or dropped, with their records.
  [[nodiscard]] static std::uint64_t seen_by(const PeerNode& node) {
    std::uint64_t seen = node.peer().counters().datagrams_in;
    for (const auto& [reason, times] : node.peer().counters().drops) seen += times;
    return seen;
  }
  void note_damage(std::size_t to, std::uint64_t before) {
    ++damage_read_;
    if (seen_by(*hosts_[to].node) > before) return;
    oracle_.count("damaged datagram under the receiver's own name");
  }

  // All damage is accounted for.
  void check_damage() {
    std::uint64_t on_the_way = 0;
    while (!network_.idle()) on_the_way += network_.take_next().is_damaged ? 1 : 0;
    const std::uint64_t known = damage_unread_ + damage_refused_ + damage_read_ + on_the_way;
    if (known != network_.counters().damaged) {
      oracle_.violate(now_s(), fmt::format("{} datagrams were damaged, and {} are accounted for",
                                           network_.counters().damaged, known));
    }
    oracle_.count("damage refused by the checksum", damage_refused_);
    oracle_.count("damage that a peer has read", damage_read_);
  }

  void trace(std::uint64_t bits) { trace_ = mixed_bits(trace_ ^ bits) + 0x9E37'79B9'7F4A'7C15; }
  void trace(std::span<const std::byte> bytes) {
    std::uint64_t word = bytes.size();
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      word = word << 8 ^ static_cast<std::uint64_t>(bytes[i]);
      if (i % 7 == 6) trace(std::exchange(word, 0));
    }
    trace(word);
  }

  void drain(std::size_t i) {
    PeerNode& node = *hosts_[i].node;
    bool dies = false;
    oracle_.on_input(i);
    while (auto out = node.poll_output()) {
      if (auto* send = std::get_if<replication::Send>(&*out)) {
        if (const auto* keeper = keeper_of(i); keeper != nullptr && keeper->must_write() && !write_store(i)) return;
        trace(static_cast<std::uint64_t>(now_.time_since_epoch().count()) ^ i);
        trace(std::span<const std::byte>(send->datagram));
        network_.send(now_, i, send->region, std::move(send->datagram));
        continue;
      }
      if (const auto* join = std::get_if<replication::Join>(&*out)) network_.join(i, join->region);
      if (const auto* leave = std::get_if<replication::Leave>(&*out)) network_.leave(i, leave->region);
      dies = dies || (hosts_[i].dies_by && std::holds_alternative<replication::OperationHeld>(*out));
      oracle_.on_output(now_s(), i, *out);
      const auto* grown = std::get_if<replication::LogGrown>(&*out);
      if (grown != nullptr && keeper_of(i) != nullptr) hosts_[i].store->add({grown->range, grown->last}, host_now(i));
    }
    if (const auto* keeper = keeper_of(i); keeper != nullptr && keeper->must_write() && !write_store(i)) return;
    while (node.poll_key_report()) {
    }
    while (node.poll_edit_report()) {
    }
    if (!dies) return note_deadline(i);
    oracle_.count("author died when its operation was held");
    hosts_[i].down_by.insert(*std::exchange(hosts_[i].dies_by, std::nullopt));
    stop(i, false);
  }

  void start(std::size_t i) {
    Host& host = hosts_[i];
    if (host.node || !host.joined || !host.down_by.empty()) return;
    config::PeerSettings settings;
    settings.id = plan_.peers[i].id;
    settings.name = name_of(i);
    config::ReplicationSettings replication;
    replication.tick_hz = plan_.tick_hz;
    replication.decisions.policy = plan_.policy;
    config::PeerObjects objects;
    for (const std::string& path : plan_.world.owned[i]) {
      objects.owned.push_back(shared_->world.scene.find(path).value());
    }
    PeerNode::Options options;
    options.incarnation = ++host.incarnation;
    options.late = true;
    options.start_lead = std::chrono::milliseconds(500);
    options.sample_hz = kGhostSamples_hz;
    options.rows = &oracle_;
    options.rare = rare_branches_of(i);
    if (host.store && !open_store(i, options)) return;
    // A host's clock begins with the wall clock.
    host.clock = SkewedClock(now_, HostTime{now_.time_since_epoch() + from_seconds(host.wall_offset_s)},
                             plan_.peers[i].skew_ppm);
    host.runs_from = now_;
    host.node = PeerNode::make(settings, replication, *shared_, std::move(objects), options);
    if (options.stores) host.store->keep(host.node->peer().logs());
    oracle_.begin_life(i, *host.node);
    drain(i);
  }

  // Those of one life, which are counted.
  replication::RareBranches rare_branches_of(std::size_t i) {
    const auto random =
        std::make_shared<Random>(stream_of(plan_.seed, Stream::kRareBranches, i << 32U | hosts_[i].incarnation));
    return replication::RareBranches([this, random](replication::RareBranch branch) {
      const double probability = plan_.rare_branches[static_cast<std::size_t>(branch)];
      if (probability == 0.0 || !random->chance(probability)) return false;
      oracle_.count(fmt::format("taken on purpose: {}", to_string(branch)));
      return true;
    });
  }

  // False: the peer can't begin now.
  bool open_store(std::size_t i, PeerNode::Options& options) {
    Host& host = hosts_[i];
    Random random = stream_of(plan_.seed, Stream::kAuthor, i << 32U | host.incarnation);
    const replication::AuthorId fresh{static_cast<std::uint32_t>(1 + random.below(replication::kAuthorMax))};
    auto opened = host.store->open(plan_.seed, fresh);
    if (host.store->disk().is_dead()) {
      die_by_disk(i);
      return false;
    }
    if (opened) {
      if (opened->lost) {
        oracle_.violate(now_s(),
                        fmt::format("the store of {} has lost operations of {}", name_of(i), opened->lost->value));
      }
      oracle_.count(opened->log.empty() ? "store with nothing opened" : "store opened");
      options.author = opened->author;
      options.stores = true;
      options.log = std::move(opened->log);
      return true;
    }
    const auto fault = disk_fault_of(i);
    if (!fault || opened.error().exit_code == 1) oracle_.violate(now_s(), opened.error().text);
    if (!host.store->exists()) {
      oracle_.count("peer without the store that could not be made");
      return true;
    }
    oracle_.count("peer that could not open its store");
    if (fault) host.down_by.insert(*fault);
    return false;
  }

  void stop(std::size_t i, bool says_goodbye, bool power_is_cut = false) {
    Host& host = hosts_[i];
    if (!host.node) {
      if (host.store && (power_is_cut || host.store->disk().is_dead())) host.store->crash(power_is_cut);
      return;
    }
    if (says_goodbye) {
      host.node->leave(host_now(i));
      drain(i);
      if (host.node && keeper_of(i) != nullptr && !write_store(i)) return;
    }
    if (!host.node) return;
    oracle_.end_life(i);
    if (host.store && !says_goodbye) host.store->crash(power_is_cut);
    if (host.store && says_goodbye) host.store->close();
    host.node.reset();
    network_.leave_all(i);
    if (host.store && host.store->disk().is_dead()) die_by_disk(i);  // in the last write
  }

  void happen(const Due& due) {
    switch (due.kind) {
      case Due::Kind::kJoin:
        hosts_[due.index].joined = true;
        return start(due.index);
      case Due::Kind::kBegin:
        return set(due.index, true);
      case Due::Kind::kEnd:
        return set(due.index, false);
      case Due::Kind::kEdit:
        return edit(plan_.edits[due.index]);
      case Due::Kind::kHeal:
        return heal();
      case Due::Kind::kCheck:
        return check();
      case Due::Kind::kStop:
        stopped_ = true;
        return;
    }
  }

  void cut(const Fault& fault, bool cuts) {
    for (std::size_t from = 0; from < hosts_.size(); ++from) {
      for (std::size_t to = 0; to < hosts_.size(); ++to) {
        const bool is_meant =
            fault.kind == FaultKind::kOneWay ? fault.side[from] && !fault.side[to] : fault.side[from] != fault.side[to];
        if (is_meant) network_.cut(from, to, cuts);
      }
    }
  }

  // The fault begins, or is over.
  void set(std::size_t index, bool begins) {
    if (!begins && healed_) return;  // all faults ended with that
    const Fault& fault = plan_.faults[index];
    if (begins) oracle_.count(fmt::format("fault: {}", to_string(fault.kind)));
    switch (fault.kind) {
      case FaultKind::kCrash:
      case FaultKind::kLeave:
      case FaultKind::kPowerCut:
        return begins ? take_down(index) : bring_back(index);
      case FaultKind::kPartition:
      case FaultKind::kOneWay:
        return cut(fault, begins);
      case FaultKind::kLinks:
        return make_links_bad(index, begins);
      case FaultKind::kSuspend:
        if (begins)
          hosts_[fault.peer].runs_from = std::max(hosts_[fault.peer].runs_from, now_ + from_seconds(fault.for_s));
        return;
      case FaultKind::kClockStep:
        if (begins) hosts_[fault.peer].wall_offset_s += fault.step_s;
        return;
      case FaultKind::kDiskDeath:
        return begins ? die_at_write(index) : bring_back(index);
      case FaultKind::kDiskFull:
      case FaultKind::kDiskErrors:
        return make_disk_fail(index, begins);
      case FaultKind::kAuthorDies:
        return begins ? edit_and_die_when_held(index) : bring_back(index);
    }
  }

  void take_down(std::size_t index) {
    const Fault& fault = plan_.faults[index];
    hosts_[fault.peer].down_by.insert(index);
    stop(fault.peer, fault.kind == FaultKind::kLeave, fault.kind == FaultKind::kPowerCut);
  }

  void die_at_write(std::size_t index) {
    Host& host = hosts_[plan_.faults[index].peer];
    if (!host.store || host.dies_at_write_by) return;
    host.dies_at_write_by = index;
    host.store->disk().die_at_write(plan_.faults[index].disk.dies_at_write);
  }

  // Of several such faults the last one counts.
  void make_disk_fail(std::size_t index, bool begins) {
    const std::size_t peer = plan_.faults[index].peer;
    if (!hosts_[peer].store) return;
    if (begins) {
      disk_faults_.push_back(index);
    } else {
      std::erase(disk_faults_, index);
    }
    SimulatedDisk& disk = hosts_[peer].store->disk();
    disk.set_room(std::nullopt);
    disk.set_error_rate(0.0);
    for (const std::size_t each : disk_faults_) {
      const Fault& fault = plan_.faults[each];
      if (fault.peer != peer) continue;
      if (fault.kind == FaultKind::kDiskFull) {
        disk.set_room(fault.disk.room_bytes);
      } else {
        disk.set_error_rate(fault.disk.error_rate);
      }
    }
    if (!begins) bring_back(index);
  }

  void bring_back(std::size_t index) {
    Host& host = hosts_[plan_.faults[index].peer];
    host.down_by.erase(index);
    if (host.dies_by == index) host.dies_by.reset();
    if (host.dies_at_write_by == index) live_on(host);
    start(plan_.faults[index].peer);
  }

  // It does not die in a write.
  static void live_on(Host& host) {
    host.dies_at_write_by.reset();
    if (host.store) host.store->disk().die_at_write(std::nullopt);
  }

  void edit_and_die_when_held(std::size_t index) {
    const Fault& fault = plan_.faults[index];
    if (!hosts_[fault.peer].node) return;
    hosts_[fault.peer].dies_by = index;
    edit({fault.number, fault.at_s, fault.peer, EditKind::kAny, mixed_bits(plan_.seed + fault.number)});
  }

  // All links are as the last one of several such faults says.
  void make_links_bad(std::size_t index, bool begins) {
    if (begins) {
      bad_links_.push_back(index);
    } else {
      std::erase(bad_links_, index);
    }
    network_.set_links(bad_links_.empty() ? plan_.links : plan_.faults[bad_links_.back()].links);
  }

  void edit(const PlannedEdit& planned) {
    Host& host = hosts_[planned.peer];
    if (!host.node || host.runs_from > now_) return;
    const replication::Peer& peer = host.node->peer();
    EditView view{peer.scene(), peer.owners(), peer.id()};
    for (const replication::Lock& lock : peer.locks()) view.locked.push_back(lock.object);
    const auto key = make_key(planned, view);
    const std::vector<config::SceneEdit> edits = make_edits(planned, view);
    if (key) {
      oracle_.on_key(host.node->on_key(host_now(planned.peer), *key));
      drain(planned.peer);
    }
    for (const config::SceneEdit& each : edits) {
      if (!host.node) return;  // an author that dies
      const EditReport report = host.node->edit(host_now(planned.peer), each);
      trace(report.operation ? report.operation->number : 0);
      oracle_.on_edit(planned.peer, report);
      drain(planned.peer);
    }
  }

  void heal() {
    healed_ = true;
    disk_faults_.clear();
    network_.mend_all();
    network_.set_links(plan_.healed);
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
      assert(hosts_[i].joined);
      hosts_[i].down_by.clear();
      hosts_[i].dies_by.reset();
      live_on(hosts_[i]);
      if (hosts_[i].store) {
        hosts_[i].store->disk().set_room(std::nullopt);
        hosts_[i].store->disk().set_error_rate(0.0);
      }
      start(i);
    }
  }

  void check() {
    due_.emplace(now_ + kCheckEvery, Due{Due::Kind::kCheck, 0});
    oracle_.check(now_s());
    ++checks_;
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
      Host& host = hosts_[i];
      if (!host.node || !host.states_os_clock || checks_ % 8 != 0 || host.runs_from > now_) continue;
      const Duration wall = now_.time_since_epoch() + from_seconds(host.wall_offset_s);
      host.node->on_os_clock(host_now(i), replication::OsClock{wall - host_now(i).time_since_epoch(), kOsClockError});
      drain(i);
    }
    if (!healed_ || one_world_after_s_ || plan_.has(Rare::kUnchecked)) return;
    if (oracle_.is_one_world()) {
      one_world_after_s_ = now_s() - plan_.heal_s;
      oracle_.begin_calm();
    } else if (now_s() - plan_.heal_s > kOneWorldWithin_s && !was_late_) {
      was_late_ = true;
      oracle_.violate(
          now_s(), fmt::format("the peers have no scene in common {} s after the network healed", kOneWorldWithin_s));
    }
  }

  const ChaosPlan& plan_;
  std::unique_ptr<const SharedWorld> shared_;
  DamagedNetwork network_;
  Oracle oracle_;
  std::vector<Host> hosts_;
  std::multimap<VirtualTime, Due> due_;               // those of one time in the order in which they were scheduled
  std::vector<std::size_t> bad_links_, disk_faults_;  // the faults that make links bad now, and disks, by their index
  VirtualTime now_ = kClockBegin;
  bool healed_ = false, stopped_ = false, was_late_ = false;
  std::uint64_t trace_ = 0, checks_ = 0;
  std::uint64_t damage_unread_ = 0, damage_refused_ = 0, damage_read_ = 0;
  std::optional<double> one_world_after_s_;
};

}  // namespace

ChaosReport run_chaos(const ChaosPlan& plan) { return ChaosRun(plan).all(); }

}  // namespace peerd::chaos
