#include "bench/scale/peer_run.hpp"

#include <algorithm>
#include <deque>
#include <variant>

#include "bench/wire_objects.hpp"
#include "replication/peer/peer.hpp"

namespace peerd::bench {
namespace {

using namespace replication;

constexpr Duration kLatency = std::chrono::milliseconds(20);

class TwoPeers {
 public:
  explicit TwoPeers(const MovingBodies& bodies)
      : bodies_(bodies),
        own_(std::max<std::size_t>(1, bodies.legs.size() / 10)),
        bare_(bodies.scene),
        bare_model_((bare_.interests.clear(), make_world_model(bare_))),
        measured_(owner_of(1, 0, own_), *bodies.model),
        sender_(owner_of(2, own_, bodies.legs.size()), *bare_model_) {}

  void run(HostTime until, PeerCost* cost) {
    while (now_ < until) {
      now_ = std::min({until, std::max(now_, measured_.next_deadline()), std::max(now_, sender_.next_deadline()),
                       flights_.empty() ? until : std::max(now_, flights_.front().at)});
      for (; !flights_.empty() && flights_.front().at <= now_; flights_.pop_front()) deliver(flights_.front(), cost);
      if (sender_.next_deadline() <= now_) {
        sender_.on_tick(now_, samples(sender_, own_, bodies_.legs.size()));
        drain(sender_, nullptr);
      }
      if (measured_.next_deadline() <= now_) {
        const std::vector<OwnSample> own = samples(measured_, 0, own_);
        const double s = seconds_of([&] {
          measured_.on_tick(now_, own);
          drain(measured_, cost);
        });
        if (cost != nullptr) cost->ticks_s += s;
      }
    }
  }
  [[nodiscard]] const Peer& measured() const { return measured_; }
  [[nodiscard]] std::size_t unknown() const {
    std::size_t count = 0;
    for (std::size_t i = own_; i < bodies_.legs.size(); ++i) {
      count +=
          measured_.owner(bodies_.object(i)) != sender_.id() || measured_.last_update_of(bodies_.object(i)) == nullptr;
    }
    return count;
  }

 private:
  struct Flight {
    HostTime at;
    bool to_measured;
    Bytes datagram;
  };

  // The configuration of the peer that owns these bodies. Their ids do not follow each other.
  [[nodiscard]] PeerConfig owner_of(std::uint32_t id, std::size_t from, std::size_t to) const {
    PeerConfig config = config_of(id, bodies_.object(from), 0);
    for (std::size_t i = from; i < to; ++i) config.owned.push_back({bodies_.object(i), true, {}});
    return config;
  }
  [[nodiscard]] std::vector<OwnSample> samples(const Peer& peer, std::size_t from, std::size_t to) const {
    std::vector<OwnSample> all;
    if (const auto due = peer.due_tick(now_)) {
      for (std::size_t i = from; i < to; ++i) all.push_back({bodies_.object(i), bodies_.legs[i].at(*due), true});
    }
    return all;
  }
  void deliver(const Flight& flight, PeerCost* cost) {
    if (!flight.to_measured) {
      (void)sender_.on_packet(now_, kWholeScene, flight.datagram);
      drain(sender_, nullptr);
      return;
    }
    const double s = seconds_of([&] {
      (void)measured_.on_packet(now_, kWholeScene, flight.datagram);
      drain(measured_, cost);
    });
    if (cost != nullptr) cost->packets_s += s;
  }
  void drain(Peer& peer, PeerCost* cost) {
    while (auto out = peer.poll_output()) {
      if (auto* send = std::get_if<Send>(&*out)) {
        flights_.push_back({now_ + kLatency, &peer == &sender_, std::move(send->datagram)});
      } else if (cost != nullptr && std::holds_alternative<ContactSeen>(*out)) {
        ++cost->contacts;
      }
    }
  }

  const MovingBodies& bodies_;
  std::size_t own_;
  Scene bare_;
  std::unique_ptr<const WorldModel> bare_model_;
  Peer measured_, sender_;
  std::deque<Flight> flights_;
  HostTime now_{};
};

}  // namespace

PeerCost run_peer(const MovingBodies& bodies, Duration warm, Duration until) {
  TwoPeers peers(bodies);
  peers.run(HostTime{} + warm, nullptr);
  PeerCost cost;
  const Peer::Counters before = peers.measured().counters();
  const MotionWorld::Counters motion = peers.measured().motion_counters();
  double so_far_s = 0.0;
  for (Duration second = warm + std::chrono::seconds(1); second <= until; second += std::chrono::seconds(1)) {
    peers.run(HostTime{} + second, &cost);
    const double s = cost.packets_s + cost.ticks_s;
    cost.shares.push_back(s - std::exchange(so_far_s, s));
  }
  cost.simulated_s = to_seconds(until - warm);
  const Peer::Counters& after = peers.measured().counters();
  cost.ticks = after.ticks - before.ticks;
  cost.updates_in = after.updates_in - before.updates_in;
  cost.updates_out = after.updates_out - before.updates_out;
  cost.motion = peers.measured().motion_counters();
  cost.motion.contact_searches -= motion.contact_searches;
  cost.motion.searches_far -= motion.searches_far;
  cost.motion.contacts -= motion.contacts;
  cost.unknown = peers.unknown();
  return cost;
}

}  // namespace peerd::bench
