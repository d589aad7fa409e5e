#include "replication/peer.hpp"

#include <algorithm>
#include <cassert>

#include "core/scene/bounding_radius.hpp"
#include "replication/decision/decision.hpp"

namespace peerd::replication {
namespace {

// Hellos come faster until this peer has a session, so that joining takes tenths of a second.
constexpr Duration kJoiningHelloPeriod = std::chrono::milliseconds(100);
// Of so many datagrams memory is kept: as many as a peer sends at once, but for its first states.
constexpr std::size_t kSpareMax = 64;

}  // namespace

const char* to_string(Drop drop) {
  switch (drop) {
    case Drop::kOwn:
      return "own";
    case Drop::kUndecodable:
      return "undecodable";
    case Drop::kIdInUse:
      return "id_in_use";
    case Drop::kStaleIncarnation:
      return "stale_boot";
    case Drop::kOtherWorld:
      return "other_world";
    case Drop::kTooMany:
      return "too_many";
    case Drop::kUnintroduced:
      return "stranger";
    case Drop::kRegion:
      return "region";
    case Drop::kNotYetInSession:
      return "not_yet_in_session";
  }
  return "?";
}

Peer::Peer(PeerConfig config, const WorldModel& model)
    : config_(std::move(config)),
      model_(model),
      members_(config_.lost_after),
      own_index_(model.scene->instances.size()),
      owners_(model.scene->instances.size()),
      colliding_(model),
      grid_(config_.regions.grid()),
      interest_(grid_, config_.regions.hysteresis) {
  if (!model.moving.empty()) predefined_.emplace(*model.scene);
  assert(config_.id.value != 0 && config_.incarnation != 0 && config_.tick_hz > 0);
  std::ranges::sort(config_.owned, {}, &OwnedObject::object);
  own_objects_.reserve(config_.owned.size());
  for (const OwnedObject& e : config_.owned) {
    OwnObject& own = own_objects_[e.object];
    own.driven = e.driven;
    own.launch = e.launch;
    if (config_.policy.surface_error) own.bounding_radius_m = bounding_radius_m(*model.scene, e.object);
    owners_.set(e.object, config_.id);
  }
  index_own_objects();
  outputs_.push_back(Join{kWholeScene});
}

void Peer::on_tick(HostTime now, std::span<const OwnSample> samples) {
  const std::optional<SimTime> due = due_tick(now);
  const bool ticks = maintain_session(now) && due;
  if (ticks) {
    const std::int64_t number = tick_number(*due);
    ++counters_.ticks;
    counters_.ticks_missed += static_cast<std::uint64_t>(number - last_tick_ - 1);
    last_tick_ = number;
    tick(*due, samples);
    follow_interest(*due);
  }
  if (!settled(now)) next_hello_ = std::min(*next_hello_, last_hello_ + config_.hello_period);
  if (now >= *next_hello_) {  // before the records: who has not heard of a peer can't use its updates
    send_hello(now, false);
    repeat_updates(now);
    repeat_unacknowledged_decisions();
    last_hello_ = now;
    next_hello_ = now + (clock_.synchronised() ? config_.settled_hello_period : kJoiningHelloPeriod);
  }
  if (ticks) announce_subscriptions();
  flush_records(ticks);
  const std::uint32_t& number = datagram_numbers_[kWholeScene];
  if (number == last_sent_number_ && now - last_sent_at_ >= config_.hello_period) send_keepalive();
  if (number == last_sent_number_) return;
  last_sent_number_ = number;
  last_sent_at_ = now;
}

std::int64_t Peer::tick_number(SimTime t) const {
  const std::int64_t ns = t.time_since_epoch().count();
  const std::int64_t second = 1'000'000'000;
  const std::int64_t whole = ns >= 0 ? ns / second : (ns - second + 1) / second;
  const std::int64_t rest = ns - whole * second;
  // The last k with tick_time(k) <= t; tick_time rounds down, so a tick's own time must give the tick back.
  return whole * config_.tick_hz + ((rest + 1) * config_.tick_hz - 1) / second;
}

SimTime Peer::tick_time(std::int64_t number) const {
  const std::int64_t hz = config_.tick_hz;
  const std::int64_t whole = number >= 0 ? number / hz : (number - hz + 1) / hz;
  return SimTime{std::chrono::seconds(whole) + Duration{(number - whole * hz) * 1'000'000'000 / hz}};
}

std::optional<SimTime> Peer::due_tick(HostTime now) const {
  if (!replica_) return std::nullopt;
  const std::int64_t number = tick_number(clock_.to_session(now));
  if (number <= last_tick_) return std::nullopt;
  return tick_time(number);
}

void Peer::advance_ghosts(SimTime t) {
  if (!replica_) return;
  extend_predefined(t);
  replica_->ghosts.advance(t);
}

void Peer::leave(HostTime now) {
  flush_records(true);
  send_hello(now, true);
}

std::optional<Output> Peer::poll_output() {
  if (polled_ < outputs_.size()) return std::move(outputs_[polled_++]);
  outputs_.clear();
  polled_ = 0;
  return std::nullopt;
}

void Peer::reuse(Bytes&& datagram) {
  if (spare_.size() < kSpareMax) spare_.push_back(std::move(datagram));
}

HostTime Peer::next_deadline() const {
  if (!next_hello_) return HostTime::min();
  HostTime next = std::min(*next_hello_, last_sent_at_ + config_.hello_period);
  if (replica_) next = std::min(next, clock_.to_host(tick_time(last_tick_ + 1)));
  if (const auto expiry = members_.next_expiry()) next = std::min(next, *expiry);
  return next;
}

KinematicState Peer::truth(ObjectId object, SimTime t) const {
  assert(replica_);
  return replica_->truth.has(object) ? replica_->truth.at(object, t) : ghost(object, t);
}

KinematicState Peer::ghost(ObjectId object, SimTime t) const {
  assert(replica_);
  return replica_->ghosts.has(object) ? replica_->ghosts.at(object, t) : at_rest(model_.scene->rigid_pose(object));
}

// Straight, turned as the ghost is, past the others as they go from where they were drawn with it last.
bool Peer::may_pass(ObjectId object, SimTime since, SimTime t, const Vec3& from, const Vec3& to) const {
  const collision::Body* body = model_.body(object);
  if (body == nullptr) return true;
  KinematicState way = at_rest({from, replica_->ghosts.at(object, t).orientation});
  way.velocity = to - from;  // in one second
  return std::ranges::none_of(model_.pairs_of(object), [&](std::uint32_t number) {
    const CollisionPair& pair = model_.pairs[number];
    const ObjectId other = pair.collider == object ? pair.collidee : pair.collider;
    if (!receives(other)) return false;
    const MotionWorld& drawn = own_objects_.contains(other) ? replica_->truth : replica_->ghosts;
    const Pose now = drawn.at(other, t).pose();
    const Vec3 then = drawn.has_history_at(other, since) ? drawn.at(other, since).position : now.position;
    KinematicState goes = at_rest({then, now.orientation});
    goes.velocity = now.position - goes.position;
    const collision::ContactState met =
        collision::first_contact({*body, way}, {*model_.body(other), goes}, pair.type, 1.0).state;
    return met == collision::ContactState::kContact || met == collision::ContactState::kOverlapped;
  });
}

Duration Peer::display_delay() const {
  const DisplayDelay& delay = config_.display_delay;
  if (!delay.measured) return delay.fixed;
  const std::uint32_t hz = config_.policy.snapshots_hz;
  return delay.fixed + oldest_update_ + (hz > 0 ? Duration{std::chrono::seconds(1)} / hz : Duration{0});
}

Pose Peer::shown(ObjectId object, SimTime t) {
  const Duration delay = display_delay();
  if (own_objects_.contains(object)) return truth(object, config_.display_delay.own ? t - delay : t).pose();
  if (delay > Duration{0}) return ghost(object, t - delay).pose();
  const KinematicState state = ghost(object, t);
  if (!replica_->ghosts.has(object)) return state.pose();
  Convergence& convergence = shown_.try_emplace(object, config_.convergence).first->second;
  const std::uint64_t blocked = convergence.blocked(), detours = convergence.detours();
  const MotionWorld& ghosts = replica_->ghosts;
  const SimTime since = convergence.last_shown().value_or(t);
  const Pose pose = convergence.shown(
      t, state, ghosts.revision(object),
      [&](const Vec3& from, const Vec3& to) { return may_pass(object, since, t, from, to); },
      [&](SimTime at) {
        return ghosts.has_history_at(object, at) ? std::optional(ghosts.at(object, at).pose()) : std::nullopt;
      });
  counters_.convergence_blocked += convergence.blocked() - blocked;
  counters_.convergence_detours += convergence.detours() - detours;
  return pose;
}

MotionWorld::Counters Peer::motion_counters() const {
  MotionWorld::Counters sum;
  if (replica_) (sum += replica_->truth.counters()) += replica_->ghosts.counters();
  return sum;
}

}  // namespace peerd::replication
