#pragma once
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <random>
#include <set>
#include <sstream>

#include "replication/peer/peer.hpp"
#include "replication/wire/codec.hpp"
#include "tests/replication/peer/worlds.hpp"

// A few peers on a small network of their own, in fake time. The class does all that a driver does.
namespace peerd::replication::test {

// True time, which no peer knows: it is 0 when a test begins. A host clock shows kEpoch, plus true time, plus its own
// offset.
inline constexpr Duration kEpoch = std::chrono::hours(24 * 365 * 50);

// A row of boxes of 1 m, 3 m apart, with the names O0, O1 and so on.
inline std::string field(int objects) {
  std::string text;
  for (int i = 0; i < objects; ++i) text += box("O" + std::to_string(i), "1 1 1", std::to_string(3 * i) + " 0 0");
  return text;
}

// A smooth curve of session time.
inline KinematicState on_a_circle(SimTime t) {
  const double phase = to_seconds(t.time_since_epoch() - kEpoch);
  const double s = std::sin(phase), c = std::cos(phase);
  return moving({5 * c, 5 * s, 0}, {-5 * s, 5 * c, 0}, {-5 * c, -5 * s, 0});
}

struct Link {
  Duration latency = 5ms, jitter = 0ms;
  double loss = 0.0, duplicates = 0.0;
};

class Lan {
 public:
  using Motion = std::function<KinematicState(SimTime)>;

  struct Node {
    std::unique_ptr<Peer> peer;
    Duration ahead{0};
    bool running = true;
    std::map<ObjectId, Motion> motions;                // of what is driven
    std::vector<std::pair<Duration, Output>> outputs;  // all but Send
    std::uint64_t ticks = 0;                           // calls of on_tick
    Duration last_call{-1};
    int calls_at_once = 0;
  };

  explicit Lan(const World& world, Link all = {}, std::uint64_t seed = 1) : world_(world), link_(all), rng_(seed) {}

  // `world`: the peer has read it, which is the same text; none: that of the network.
  std::size_t add(PeerConfig config, Duration ahead = 0s, std::map<ObjectId, Motion> motions = {},
                  const World* world = nullptr) {
    nodes_.push_back({std::make_unique<Peer>(std::move(config), *(world != nullptr ? *world : world_).model),
                      ahead,
                      true,
                      std::move(motions),
                      {},
                      0,
                      Duration{-1},
                      0});
    joined_.emplace_back();
    drain(nodes_.size() - 1);
    return nodes_.size() - 1;
  }
  // The same computer starts the next incarnation of a peer; datagrams that were sent to the last one are still under
  // way.
  void restart(std::size_t i, PeerConfig config) {
    nodes_[i].peer = std::make_unique<Peer>(std::move(config), *world_.model);
    nodes_[i].running = true;
  }
  void kill(std::size_t i) { nodes_[i].running = false; }
  void leave(std::size_t i) {
    nodes_[i].peer->leave(host_now(i));
    drain(i);
    nodes_[i].running = false;
  }
  // Peers of different groups do not receive each other.
  void part(std::set<std::size_t> side) { apart_ = std::move(side); }
  // Sees each datagram on each link before it is sent; false loses it.
  std::function<bool(std::size_t from, std::size_t to, const Message&)> filter;
  // The observer sees each datagram once, when it leaves.
  std::function<void(std::size_t from, RegionId, const Message&)> on_send;
  // A hostile peer: what it sends instead of the message; none: the message.
  std::function<std::optional<Message>(std::size_t from, const Message&)> forge;
  // Delays a datagram on top of its link's latency.
  std::function<Duration(std::size_t from, std::size_t to, const Message&)> delay;

  void run_until(Duration t) {
    for (;;) {
      const std::size_t i = next_to_tick();
      const Duration tick_at = i == nodes_.size() ? Duration::max() : std::max(now_, deadline(i));
      if (!flights_.empty() && flights_.top().at <= std::min(tick_at, t)) {
        const Flight f = flights_.top();
        flights_.pop();
        now_ = std::max(now_, f.at);
        if (nodes_[f.to].running) inject(f.to, f.datagram, f.region);
        continue;
      }
      if (tick_at > t) break;
      // A clock that is slewed forwards within a call may make the next tick due at once, but not a third one.
      Node& n = nodes_[i];
      n.calls_at_once = tick_at == n.last_call ? n.calls_at_once + 1 : 1;
      n.last_call = tick_at;
      ASSERT_LE(n.calls_at_once, 3) << "a driver would spin";
      now_ = tick_at;
      tick(i);
    }
    now_ = t;
  }
  std::expected<void, Drop> inject(std::size_t to, const Bytes& datagram, RegionId region = kWholeScene) {
    const auto result = nodes_[to].peer->on_packet(host_now(to), region, datagram);
    drain(to);
    return result;
  }
  void tick(std::size_t i) {
    Node& n = nodes_[i];
    std::vector<OwnSample> samples;
    if (const auto due = n.peer->due_tick(host_now(i))) {
      for (const auto& [object, motion] : n.motions) {
        if (n.peer->owner(object) == n.peer->id()) samples.push_back({object, motion(*due)});
      }
    }
    ++n.ticks;
    n.peer->on_tick(host_now(i), samples);
    drain(i);
  }
  // All clocks jump, as they do when computers sleep. The driver calls no peer meanwhile.
  void skip(Duration d) { now_ += d; }

  [[nodiscard]] Duration now() const { return now_; }
  [[nodiscard]] HostTime host_now(std::size_t i) const { return host_at(i, now_); }
  [[nodiscard]] HostTime host_at(std::size_t i, Duration t) const { return HostTime{kEpoch + t + nodes_[i].ahead}; }
  [[nodiscard]] SimTime session_now(std::size_t i) const { return peer(i).clock().to_session(host_now(i)); }
  [[nodiscard]] Peer& peer(std::size_t i) const { return *nodes_[i].peer; }
  [[nodiscard]] Node& node(std::size_t i) { return nodes_[i]; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] const std::set<RegionId>& joined(std::size_t i) const { return joined_[i]; }

  // The outputs of one kind, in order.
  template <class Kind>
  [[nodiscard]] std::vector<Kind> seen(std::size_t i) const {
    std::vector<Kind> all;
    for (const auto& [at, out] : nodes_[i].outputs) {
      if (const auto* o = std::get_if<Kind>(&out)) all.push_back(*o);
    }
    return all;
  }
  [[nodiscard]] std::vector<ContactSeen> contacts(std::size_t i, ContactKind kind) const {
    auto all = seen<ContactSeen>(i);
    std::erase_if(all, [&](const ContactSeen& c) { return c.kind != kind; });
    return all;
  }
  [[nodiscard]] std::uint64_t drops(std::size_t i, const char* reason) const {
    const auto& drops = peer(i).counters().drops;
    const auto at = drops.find(reason);
    return at == drops.end() ? 0 : at->second;
  }
  [[nodiscard]] bool all_in_session() const {
    return std::ranges::all_of(nodes_, [](const Node& n) { return n.peer->clock().synchronised(); });
  }

 private:
  struct Flight {
    Duration at;
    std::uint64_t order;
    std::size_t to;
    Bytes datagram;
    RegionId region;
    bool operator<(const Flight& other) const { return std::tie(other.at, other.order) < std::tie(at, order); }
  };

  [[nodiscard]] Duration deadline(std::size_t i) const {
    const HostTime host = nodes_[i].peer->next_deadline();
    return host == HostTime::min() ? now_ : host.time_since_epoch() - kEpoch - nodes_[i].ahead;
  }
  [[nodiscard]] std::size_t next_to_tick() const {
    std::size_t next = nodes_.size();
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].running && (next == nodes_.size() || deadline(i) < deadline(next))) next = i;
    }
    return next;
  }
  void drain(std::size_t i) {
    while (auto out = nodes_[i].peer->poll_output()) {
      if (const auto* send = std::get_if<Send>(&*out)) {
        transmit(i, send->datagram, send->region);
      } else {
        if (const auto* join = std::get_if<Join>(&*out)) joined_[i].insert(join->region);
        if (const auto* leave = std::get_if<Leave>(&*out)) joined_[i].erase(leave->region);
        nodes_[i].outputs.emplace_back(now_, std::move(*out));
      }
    }
  }
  void transmit(std::size_t from, const Bytes& datagram, RegionId region) {
    EXPECT_LE(datagram.size(), kDatagramMax_bytes);
    const auto message = decode(datagram, session_now(from));
    ASSERT_TRUE(message.has_value()) << to_string(message.error());
    if (on_send) on_send(from, region, *message);
    const auto forged = forge ? forge(from, *message) : std::nullopt;
    const Bytes sent = forged ? encode(*forged) : datagram;
    std::uniform_real_distribution<double> u(0.0, 1.0);
    for (std::size_t to = 0; to < nodes_.size(); ++to) {  // multicast comes back to its sender too
      if (apart_.contains(from) != apart_.contains(to) || !joined_[to].contains(region)) continue;
      if (filter && !filter(from, to, *message)) continue;
      const int copies = (u(rng_) < link_.loss ? 0 : 1) + (u(rng_) < link_.duplicates ? 1 : 0);
      for (int c = 0; c < copies; ++c) {
        const Duration late = seconds(to_seconds(link_.jitter) * u(rng_)) + (delay ? delay(from, to, *message) : 0s);
        flights_.push({now_ + (to == from ? 0ms : link_.latency + late), ++sent_, to, sent, region});
      }
    }
  }

  const World& world_;
  Link link_;
  std::mt19937_64 rng_;
  std::vector<Node> nodes_;
  std::vector<std::set<RegionId>> joined_;  // by node
  std::priority_queue<Flight> flights_;
  std::set<std::size_t> apart_;
  Duration now_{0};
  std::uint64_t sent_ = 0;
};

// The contacts that a peer has reported and not retracted since, as its log has them.
inline std::vector<ContactEvent> standing_contacts(Lan& lan, std::size_t i) {
  std::vector<ContactEvent> all;
  for (const auto& [at, out] : lan.node(i).outputs) {
    if (const auto* seen = std::get_if<ContactSeen>(&out)) all.push_back(seen->contact);
    if (const auto* back = std::get_if<ContactsRetracted>(&out)) {
      std::erase_if(all, [&](const ContactEvent& c) { return back->retracts(c.at, c.collider, c.collidee); });
    }
  }
  return all;
}

inline PeerConfig config(std::uint32_t id, std::vector<OwnedObject> owned = {}) {
  PeerConfig c;
  c.id = PeerId{id};
  c.name = "peer" + std::to_string(id);
  c.incarnation = 100;
  c.world_hash = 0xC0FFEE;
  c.owned = std::move(owned);
  return c;
}

// A message of a peer that does not run. The receiver takes its sender for a member of the session.
inline Message message_of(std::uint32_t id, std::uint64_t incarnation = 100) {
  Message m;
  m.sender = PeerId{id};
  m.incarnation = incarnation;
  return m;
}
inline Message hello_of(std::uint32_t id, HostTime now, std::vector<ObjectId> owned = {},
                        std::uint64_t incarnation = 100) {
  Message m = message_of(id, incarnation);
  m.number = 1;
  Hello& hello = m.hello.emplace();
  hello.session_tx = SimTime{now.time_since_epoch()};
  Introduction& introduction = hello.introduction.emplace();
  introduction.name = "forged" + std::to_string(id);
  introduction.world_hash = 0xC0FFEE;
  introduction.owned = std::move(owned);
  return m;
}

// The whole state of a peer that a datagram could change and a test can read.
inline std::string fingerprint(const Lan& lan, std::size_t i) {
  const Peer& p = lan.peer(i);
  std::ostringstream s;
  s.precision(17);
  for (const auto& [object, owner] : p.owners()) s << object.number << " by " << owner.value << '\n';
  for (const auto& [id, m] : p.members().all())
    s << id.value << ' ' << m.incarnation << ' ' << m.last_received.time_since_epoch().count() << '\n';
  s << p.clock().session_minus_host(lan.host_now(i)).count() << '\n';
  if (p.clock().synchronised()) {
    for (const auto& [object, owner] : p.owners()) {
      const KinematicState k = p.ghost(object, lan.session_now(i));
      s << k.position.transpose() << ' ' << k.velocity.transpose() << ' ' << k.orientation.coeffs().transpose() << '\n';
    }
  }
  return s.str();
}

}  // namespace peerd::replication::test
