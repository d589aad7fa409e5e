#include "peerd/sim/simulation.hpp"

#include <algorithm>
#include <limits>

#include "peerd/record/capture.hpp"
#include "peerd/sim/interest_oracle.hpp"
#include "peerd/sim/network.hpp"
#include "peerd/transport_options.hpp"

namespace peerd::sim {
namespace {

// The virtual clock starts here, so that no host's clock offset makes a time negative.
constexpr VirtualTime kBegin{std::chrono::seconds(10'000'000)};
// Peers that have not all joined by then never will: the scenario's links lose everything.
constexpr Duration kJoinWithin = std::chrono::seconds(600);

struct SimulatedPeer {
  std::unique_ptr<PeerNode> node;
  Duration clock_offset;
  PeerNode::Options options;
  std::unique_ptr<record::CaptureWriter> capture;  // null: none

  [[nodiscard]] HostTime host(VirtualTime t) const { return HostTime{t.time_since_epoch() + clock_offset}; }
  [[nodiscard]] VirtualTime virtual_time(HostTime t) const { return VirtualTime{t.time_since_epoch() - clock_offset}; }
};

constexpr double kFallback_s = 1.0;

double longest_delay_s(const config::RunSettings& run) {
  const auto longest_ms = [](const config::LinkSettings& link) {
    return (link.latency_ms + link.jitter_ms) * (link.reordering > 0.0 ? 2.0 : 1.0);
  };
  double most_ms = longest_ms(run.network);
  for (const auto& [ends, link] : run.links) most_ms = std::max(most_ms, longest_ms(link));
  return most_ms * 1e-3;
}

config::Result<std::vector<SimulatedPeer>> make_peers(const config::RunSettings& run, const SharedWorld& shared) {
  auto objects = config::resolve(run, shared.world.scene);
  if (!objects) return std::unexpected(objects.error());
  std::vector<SimulatedPeer> peers;
  for (std::size_t i = 0; i < run.peers.size(); ++i) {
    const config::PeerSettings& settings = run.peers[i];
    if (!(*objects)[i].outside.empty()) {  // what it sends would depend on how fast this computer simulates
      return std::unexpected(config::InputError{
          "error: peer." + settings.name + " leaves \"" + (*objects)[i].outside.begin()->first +
          "\" to a program outside, which runs in real time, and a simulation does not; use peerd run or peerd "
          "scenario, or move it by a formula or a recorded track"});
    }
    PeerNode::Options options;
    for (const config::PeerSettings& p : run.peers) options.wait_for.push_back(PeerId{p.id});
    // Everybody must have heard of the start, and of the objects that already move, before it comes.
    options.start_lead = from_seconds(1.0 + 2.0 * longest_delay_s(run));
    options.clock_offset = from_seconds(settings.clock_offset_s);
    options.sample_hz = run.sample_hz;
    auto node = PeerNode::make(settings, run.replication, shared, std::move((*objects)[i]), options);
    peers.push_back({std::move(node), options.clock_offset, options, nullptr});
  }
  return peers;
}

// Where a simulated peer's datagrams come from, in its captures: 10.ID or fd00::ID.
boost::asio::ip::udp::endpoint address_of(const config::PeerSettings& peer, const net::GroupPlan& groups) {
  namespace ip = boost::asio::ip;
  if (groups.base.is_v4()) return {ip::address_v4(10u << 24 | (peer.id & 0xFF'FFFF)), groups.port};
  ip::address_v6::bytes_type bytes{0xFD};
  for (std::size_t i = 0; i < 4; ++i) bytes[15 - i] = static_cast<unsigned char>(peer.id >> 8 * i);
  return {ip::address_v6(bytes), groups.port};
}

config::Result<void> open_captures(const Captures& captures, const config::RunSettings& run, const SharedWorld& shared,
                                   const net::GroupPlan& groups, std::vector<SimulatedPeer>& peers) {
  for (std::size_t i = 0; i < peers.size(); ++i) {
    const config::PeerSettings& settings = run.peers[i];
    const auto setup =
        record::make_setup(captures.scenario, run, settings, captures.file, shared, peers[i].options, groups);
    auto opened = record::CaptureWriter::open(captures.folder / (settings.name + ".pcapng"), setup,
                                              peers[i].host(kBegin), address_of(settings, groups).address());
    if (!opened) return std::unexpected(opened.error());
    peers[i].capture = *std::move(opened);
  }
  return {};
}

}  // namespace

config::RunSettings without_latency(config::RunSettings run) {
  run.network = {};
  run.links.clear();
  run.replication.policy.error_threshold_m = 0.0;
  run.replication.policy.order = replication::ModelOrder::kSecond;
  run.replication.policy.predict_collisions = true;
  run.replication.decisions = {};
  return run;
}

config::Result<std::vector<PeerLog>> simulate(const config::RunSettings& run, const SharedWorld& shared,
                                              const Observer& observer, const KeyObserver& key_observer,
                                              std::optional<report::InterestRecord>* interest,
                                              const Captures* captures) {
  auto made = make_peers(run, shared);
  if (!made) return std::unexpected(made.error());
  std::vector<SimulatedPeer>& peers = *made;
  net::GroupPlan groups;
  if (captures != nullptr) {
    const auto reach = transport_options(run.transport, {});
    if (!reach) return std::unexpected(reach.error());
    groups = reach->multicast.groups;
    if (auto opened = open_captures(*captures, run, shared, groups, peers); !opened) {
      return std::unexpected(opened.error());
    }
  }
  Network network(run);
  std::optional<InterestOracle> oracle;
  if (interest != nullptr && InterestOracle::has_areas(run)) {
    std::vector<WatchedPeer> watched;
    for (const SimulatedPeer& p : peers) watched.push_back({p.node.get(), p.clock_offset});
    oracle.emplace(run, std::move(watched));
  }

  VirtualTime now = kBegin;
  const auto drain = [&](std::size_t i) {
    while (auto out = peers[i].node->poll_output()) {
      if (auto* send = std::get_if<replication::Send>(&*out)) {
        if (peers[i].capture) peers[i].capture->on_send(send->region, send->datagram);
        if (oracle) oracle->on_send(now, i, send->region, send->datagram, network);
        network.send(now, i, send->region, std::move(send->datagram));
        continue;
      }
      if (const auto* join = std::get_if<replication::Join>(&*out)) network.join(i, join->region);
      if (const auto* leave = std::get_if<replication::Leave>(&*out)) network.leave(i, leave->region);
      const bool joins = std::holds_alternative<replication::Join>(*out);
      if (oracle && (joins || std::holds_alternative<replication::Leave>(*out))) oracle->on_membership(now, i, joins);
      if (observer) observer(HostTime{now.time_since_epoch()}, *peers[i].node, *out);
    }
    while (const auto key = peers[i].node->poll_key_report()) {
      if (key_observer) key_observer(HostTime{now.time_since_epoch()}, *peers[i].node, *key);
    }
  };
  const auto deadline = [&](const SimulatedPeer& p) {
    const HostTime host = p.node->next_deadline();
    return host == HostTime::min() ? kBegin : p.virtual_time(host);
  };
  for (std::size_t i = 0; i < peers.size(); ++i) drain(i);

  // Late updates end no belief early, and what is held back is decided and heard of: a fallback waits for two latencies
  // and three hellos.
  const Duration linger = from_seconds(run.duration_s + 3.0 * longest_delay_s(run) + kFallback_s);
  for (;;) {
    std::size_t next = 0;
    for (std::size_t i = 1; i < peers.size(); ++i) {
      if (deadline(peers[i]) < deadline(peers[next])) next = i;
    }
    const VirtualTime tick_at = std::max(now, deadline(peers[next]));
    const VirtualTime event_at = network.idle() ? tick_at : std::min(tick_at, network.next_delivery());
    while (oracle && oracle->next_look() && *oracle->next_look() < event_at) oracle->look();
    if (!network.idle() && network.next_delivery() <= tick_at) {  // datagrams first: a tick begins by draining them
      const Delivery d = network.take_next();
      now = d.at;
      const SimulatedPeer& to = peers[d.to];
      if (to.capture) {
        to.capture->on_packet(to.host(now), address_of(run.peers[d.from], groups), d.region, *d.datagram);
      }
      to.node->on_packet(to.host(now), d.region, *d.datagram);
      drain(d.to);
      continue;
    }
    now = tick_at;
    PeerNode& node = *peers[next].node;
    const HostTime host = peers[next].host(now);
    if (peers[next].capture) peers[next].capture->on_tick(host);
    node.on_tick(host);
    drain(next);
    if (!node.start() && now - kBegin > kJoinWithin) {
      return std::unexpected(config::InputError{"error: peer " + run.peers[next].name +
                                                " never had all the others; does the network lose everything?"});
    }
    if (node.start() && node.peer().clock().to_session(host) > *node.start() + linger) break;
  }
  if (oracle) *interest = oracle->record();
  std::vector<PeerLog> logs;
  for (SimulatedPeer& p : peers) {
    logs.push_back(p.node->log());
    if (!p.capture) continue;
    p.capture->flush();
    if (!p.capture->good()) {
      return std::unexpected(config::InputError{
          "error: can't write the captures to " + captures->folder.string() + "; is the disk full?", 3});
    }
  }
  return logs;
}

}  // namespace peerd::sim
