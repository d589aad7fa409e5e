#include "peerd/lab/sim/interest_oracle.hpp"

#include <algorithm>
#include <cassert>

#include "core/scene/bounding_radius.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::sim {
namespace {

// The number of updates of one object that are kept is more than can be under way.
constexpr std::size_t kUpdatesKeptMax = 1024;

double ms(Duration d) { return 1e3 * to_seconds(d); }

}  // namespace

bool InterestOracle::has_areas(const config::RunSettings& run) {
  return std::ranges::any_of(run.peers, [](const config::PeerSettings& p) { return p.interest_radius_m.has_value(); });
}

InterestOracle::InterestOracle(const config::RunSettings& run, const Scene& scene, std::vector<WatchedPeer> peers)
    : run_(run), scene_(scene), peers_(std::move(peers)), grid_(run.replication.regions.grid()) {
  assert(run_.peers.size() == peers_.size());
  for (std::size_t i = 0; i < peers_.size(); ++i) {
    const config::PeerSettings& settings = run_.peers[i];
    if (settings.interest_radius_m)
      observed_.push_back({i, *settings.interest_radius_m, {PeerId{settings.id}}, 0, 0, {}, {}});
  }
  for (const config::PeerSettings& from : run_.peers) {
    for (const config::PeerSettings& to : run_.peers) {
      const config::LinkSettings& link = config::link(run_, from.name, to.name);
      if (from.id != to.id) found_.latency_ms = std::max(found_.latency_ms, link.longest_delay_ms());
    }
  }
}

SimTime InterestOracle::session_time(std::size_t peer, VirtualTime t) const {
  return peers_[peer].node->peer().clock().to_session(HostTime{t.time_since_epoch() + peers_[peer].clock_offset});
}

std::optional<VirtualTime> InterestOracle::next_sample_time() {
  if (!begin_) {
    const bool ready = std::ranges::all_of(peers_, [](const WatchedPeer& p) { return p.node->start().has_value(); });
    if (!ready) return std::nullopt;
    const WatchedPeer& first = peers_.front();
    const HostTime host = first.node->peer().clock().to_host(*first.node->start());
    begin_ = VirtualTime{host.time_since_epoch() - first.clock_offset};
  }
  const VirtualTime at = *begin_ + from_seconds(static_cast<double>(samples_taken_) / run_.sample_hz);
  return in_run(at) ? std::optional(at) : std::nullopt;
}

bool InterestOracle::in_run(VirtualTime t) {
  return begin_ && t >= *begin_ && t <= *begin_ + from_seconds(run_.duration_s);
}

KinematicState InterestOracle::truth(ObjectId object, VirtualTime t) const {
  const std::size_t owner = owners_.at(object);
  return peers_[owner].node->peer().truth(object, session_time(owner, t));
}

bool InterestOracle::in_area(const ObservedPeer& observed, ObjectId object, VirtualTime t) const {
  const Vec3 position = truth(object, t).position;
  const double within_m = observed.radius_m + reaches_m_.at(object);
  const auto near = [&](const Vec3& seen_from) {
    Vec3 apart = position - seen_from;
    for (int axis = 0; axis < 3; ++axis) {
      if (run_.replication.regions.regions[static_cast<std::size_t>(axis)] == 1) apart[axis] = 0.0;
    }
    return apart.norm() <= within_m;
  };
  const WatchedPeer& self = peers_[observed.peer];
  const auto& viewpoint = self.node->peer().config().decisions.viewpoint;
  if (!viewpoint) {
    return std::ranges::any_of(
        owners_, [&](const auto& o) { return o.second == observed.peer && near(truth(o.first, t).position); });
  }
  if (!viewpoint->object || !owners_.contains(*viewpoint->object)) return near(viewpoint->pose.position);
  return near(truth(*viewpoint->object, t).pose() * viewpoint->pose.position);
}

void InterestOracle::take_sample() {
  const VirtualTime t = *next_sample_time();
  ++samples_taken_;
  owners_.clear();
  for (std::size_t i = 0; i < peers_.size(); ++i) {
    for (const auto& [object, owner] : peers_[i].node->peer().owners()) {
      if (owner != peers_[i].node->peer().id()) continue;
      owners_.emplace(object, i);
      if (!reaches_m_.contains(object)) reaches_m_.emplace(object, bounding_radius_m(scene_, object));
    }
  }
  for (ObservedPeer& observed : observed_) take_sample(observed, t);
}

void InterestOracle::take_sample(ObservedPeer& observed, VirtualTime t) {
  const replication::Peer& peer = peers_[observed.peer].node->peer();
  observed.groups += 1 + peer.interest().regions().size();
  for (const auto& [object, owner] : owners_) {
    if (owner == observed.peer) continue;
    const auto gap = observed.missing_since.find(object);
    const bool inside = in_area(observed, object, t);
    const replication::UpdateRecord* held = peer.last_update_of(object);
    const bool missing = inside && (!peer.receives(object) || held == nullptr);
    if (inside) ++observed.objects, ++found_.samples;
    if (missing) ++found_.missing_samples;
    if (missing && gap == observed.missing_since.end()) observed.missing_since.emplace(object, t);
    if (!missing && gap != observed.missing_since.end()) {
      close_gap(t - gap->second);
      observed.missing_since.erase(gap);
    }
    if (!inside || missing) continue;
    if (const auto since = outdated_since(object, held->sequence)) {
      found_.longest_outdated_ms = std::max(found_.longest_outdated_ms, ms(t - *since));
    }
  }
}

void InterestOracle::close_gap(Duration length) {
  ++found_.gaps;
  found_.longest_missing_ms = std::max(found_.longest_missing_ms, ms(length));
}

// The time at which an update newer than that sequence number was first sent; none where that update is the newest.
std::optional<VirtualTime> InterestOracle::outdated_since(ObjectId object, std::uint32_t sequence) const {
  const auto sent = sent_updates_.find(object);
  if (sent == sent_updates_.end()) return std::nullopt;
  const auto newer = std::ranges::upper_bound(sent->second, sequence, {}, &SentUpdate::sequence);
  return newer == sent->second.end() ? std::nullopt : std::optional(newer->at);
}

void InterestOracle::on_send(VirtualTime now, std::size_t from, RegionId region, std::span<const std::byte> datagram,
                             const Network& network) {
  const auto message = replication::decode(datagram, session_time(from, now));
  if (!message || (message->updates.empty() && message->handovers.empty() && message->subscriptions.empty())) return;
  std::size_t counted_bytes = datagram.size();
  if (message->hello) {  // count only the subscriptions that go with the hello
    replication::Message hello = *message;
    hello.subscriptions.clear();
    counted_bytes = replication::encode(*message).size() - replication::encode(hello).size();
  }
  double records_bytes = 0.0;
  const auto size_bytes = [&](const replication::UpdateRecord& u) {
    return static_cast<double>(replication::encoded_size_bytes(u, message->updates.front().at));
  };
  for (const replication::UpdateRecord& u : message->updates) {
    records_bytes += size_bytes(u);
    std::deque<SentUpdate>& sent = sent_updates_[u.object];
    if (sent.empty() || u.sequence > sent.back().sequence) sent.push_back({now, u.sequence});
    if (sent.size() > kUpdatesKeptMax) sent.pop_front();
  }
  if (!in_run(now)) return;
  for (ObservedPeer& observed : observed_) {
    if (observed.peer == from) continue;
    if (network.joined(observed.peer, region)) observed.found.received_bytes += counted_bytes;
    double wanted_bytes = 0.0;
    for (const replication::UpdateRecord& u : message->updates) {
      const bool own_region = !grid_.cuts() || grid_.region_of(u.model.state.position) == region;
      if (own_region && owners_.contains(u.object) && in_area(observed, u.object, now)) {
        wanted_bytes += size_bytes(u);
      }
    }
    const double share = records_bytes > 0.0 ? wanted_bytes / records_bytes : 0.0;
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): the sum is positive, and a byte more or less is no matter
    observed.found.interest_bytes += static_cast<std::uint64_t>(share * static_cast<double>(counted_bytes) + 0.5);
  }
}

void InterestOracle::on_membership(VirtualTime now, std::size_t peer, bool joined) {
  if (!in_run(now)) return;
  for (ObservedPeer& observed : observed_) {
    if (observed.peer != peer) continue;
    if (!joined) {
      ++observed.found.leaves;
      continue;
    }
    ++observed.found.joins;
    std::deque<VirtualTime>& late = observed.joins_of_late;
    late.push_back(now);
    while (late.front() <= now - std::chrono::seconds(1)) late.pop_front();
    observed.found.joins_in_a_second =
        std::max(observed.found.joins_in_a_second, static_cast<std::uint32_t>(late.size()));
  }
}

measure::InterestRecord InterestOracle::record() const {
  InterestOracle all = *this;
  for (ObservedPeer& observed : all.observed_) {
    for (const auto& [object, since] : observed.missing_since) {  // gaps that last until the run's end
      all.close_gap(*begin_ + from_seconds(static_cast<double>(samples_taken_) / run_.sample_hz) - since);
    }
    const double samples = static_cast<double>(std::max<std::uint64_t>(samples_taken_, 1));
    observed.found.objects = static_cast<double>(observed.objects) / samples;
    observed.found.groups = static_cast<double>(observed.groups) / samples;
    all.found_.peers.push_back(observed.found);
  }
  return all.found_;
}

}  // namespace peerd::sim
