#include "replication/peer/peer.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "replication/peer/contact_report.hpp"
#include "replication/peer/intake.hpp"
#include "replication/peer/operation_keeper.hpp"
#include "replication/peer/peer_parts.hpp"
#include "replication/peer/scene_keeper.hpp"
#include "replication/peer/session_keeper.hpp"

namespace peerd::replication {

class Peer::Impl {
 public:
  Impl(PeerConfig config, const WorldModel& model)
      : parts(std::move(config), model),
        scene(parts),
        keeper(parts, scene),
        operations(parts, keeper),
        intake(parts, keeper, scene, operations) {
    parts.outbox.push(Join{kWholeScene});
  }

  [[nodiscard]] std::optional<SimTime> due_tick(HostTime now) const;
  void on_tick(HostTime now, std::span<const OwnSample> samples);
  void publish_now(HostTime now, std::span<const OwnSample> samples);
  void send_hello(HostTime now, bool leaving);

  PeerParts parts;
  SceneKeeper scene;
  SessionKeeper keeper;
  OperationKeeper operations;
  Intake intake;

 private:
  void tick(SimTime t, std::span<const OwnSample> samples);
  void advance(SimTime t);
  void introduce(Hello& hello);
  void send_far_hello(HostTime now);
  [[nodiscard]] bool is_settled(HostTime now) const;
};

std::optional<SimTime> Peer::Impl::due_tick(HostTime now) const {
  if (!parts.replica.begun()) return std::nullopt;
  const std::int64_t number = parts.ticks.number_at(parts.to_session(now));
  if (number <= parts.ticks.last()) return std::nullopt;
  return parts.ticks.time_of(number);
}

void Peer::Impl::on_tick(HostTime now, std::span<const OwnSample> samples) {
  const std::optional<SimTime> due = due_tick(now);
  const bool ticks = keeper.maintain(now) && due;
  if (ticks) {
    const std::int64_t number = parts.ticks.number_at(*due);
    assert(number > parts.ticks.last());
    ++parts.counters.ticks;
    parts.counters.ticks_missed += static_cast<std::uint64_t>(number - parts.ticks.last() - 1);
    parts.ticks.set_last(number);
    const auto take_early = [&](SimTime until) { intake.take_early(now, until); };
    operations.apply_until(*due, take_early);
    take_early(*due);
    tick(*due, samples);
    operations.place_left_behind(now, *due);
    parts.regions.follow_interest(*due, parts.to_session(now));
  }
  if (parts.members.follow_size(parts.replica.begun() && parts.regions.cuts())) {
    parts.greeter.on_size_changed(now, parts.outbox.last_number(parts.members.channel()));
    parts.decisions.forget_numbers();
  }
  operations.send(now);
  if (parts.greeter.is_far_due(now, parts.time.follows() == parts.config.id)) send_far_hello(now);
  if (!is_settled(now) || parts.exchange.has_news()) parts.greeter.hurry();
  if (parts.greeter.is_due(now)) {  // before the records: a peer that does not know this one can't use its updates
    send_hello(now, false);
    parts.publication.repeat_updates(now, parts.to_session(now));
    parts.decisions.repeat_unacknowledged();
    scene.offer(now);
    parts.greeter.schedule_next(now, parts.time.clock().synchronised());
  }
  if (ticks) parts.regions.announce();
  parts.publication.flush(ticks);
  const RegionId channel = parts.members.channel();
  if (parts.greeter.needs_keepalive(now, parts.outbox.last_number(channel))) {
    Message keepalive = parts.outbox.blank();
    (void)parts.regions.send_to_peers(keepalive);
    parts.greeter.note_kept_alive(now);
  }
  parts.greeter.note_sent(now, parts.outbox.last_number(channel));
}

void Peer::Impl::tick(SimTime t, std::span<const OwnSample> samples) {
  parts.extend_motions(t);
  parts.replica.advance_truth(t);
  parts.publication.take(t, samples);
  parts.replica.advance_ghosts(t);
  report_contacts(parts, t);
  parts.return_fallen(t);
  parts.follow_resting_ghosts(t);
  parts.publication.publish(t);
  scene.maintain(t);
  parts.ghost_check.on_tick(t);
  if (const auto delay = parts.display.poll_delay(t)) parts.outbox.push(*delay);
  if (const auto late = parts.display.poll_late(t)) parts.outbox.push(*late);
  parts.counters.predictions_unseen += parts.sight.pairs_put_off();
}

// Does what a tick does, except for the contacts: those wait for the next tick, which finds them at their own times.
void Peer::Impl::publish_now(HostTime now, std::span<const OwnSample> samples) {
  if (!parts.replica.begun() || due_tick(now)) return;
  const SimTime t = parts.to_session(now);
  if (t <= parts.ticks.last_time()) return;  // the session's time was ahead and is being put right
  std::vector<const OwnSample*> urgent;
  for (const OwnSample& sample : samples) {
    if (parts.publication.is_urgent(sample, t)) urgent.push_back(&sample);
  }
  if (urgent.empty() && parts.launches.unpublished().empty()) return;
  const std::uint64_t published_before = parts.counters.updates_out;
  intake.take_early(now, t);
  parts.extend_motions(t);
  parts.replica.advance_truth(t);
  for (const OwnSample* sample : urgent) {
    MotionWorld& truth = parts.replica.truth();
    truth.set_base(sample->object, t, truth.in_carrier(sample->object, t, sample->state));
  }
  parts.replica.advance_ghosts(t);
  parts.publication.publish_at_once(t, urgent);
  parts.counters.updates_at_once += parts.counters.updates_out - published_before;
  parts.publication.flush(false);
}

// Whether nobody waits for what this peer's next hello says: all have a session, know each other and each other's
// clocks, what is sent arrives, and no contact is open that this peer has found or may be the one to decide.
bool Peer::Impl::is_settled(HostTime now) const {
  const bool lossy = copies_against(parts.members.worst_loss_to_peers(), 2) > 1;
  return parts.replica.begun() && !parts.greeter.is_settling(now) &&
         !parts.greeter.must_introduce(parts.time.clock().synchronised()) && !lossy &&
         !parts.decisions.has_deferred() && std::ranges::none_of(parts.members.all(), [&](const auto& entry) {
           const bool waits = !entry.second.synchronised && !parts.members.is_large();  // for far hellos
           return entry.second.awaits_our_decision || waits;
         });
}

void Peer::Impl::send_hello(HostTime now, bool leaving) {
  Message m = parts.outbox.blank();
  m.leaving = leaving;
  Hello& hello = m.hello.emplace();
  parts.time.stamp(hello, now);
  hello.sessions = parts.greeter.sessions();
  hello.latency = parts.members.own_latency();
  if (hello.session_tx) parts.display.on_latency(*hello.session_tx, hello.latency, parts.to_session(now));
  hello.notes = parts.decisions.notes();
  if (hello.session_tx) hello.scene_digest = scene.digest(*hello.session_tx);
  parts.greeter.fill_echoes(hello, now, parts.regions.cuts());
  if (parts.greeter.introduces(parts.time.clock().synchronised())) introduce(hello);
  // Each of these takes the room of one subscription.
  const bool as_founder = hello.introduction && hello.introduction->owned_as_founder != 0;
  const std::size_t subscriptions = kSubscriptionsWithHello - (as_founder ? 1 : 0) - (hello.scene_digest != 0 ? 1 : 0);
  if (!leaving) m.subscriptions = parts.regions.take(subscriptions, true);
  operations.add_lengths(m);
  const RegionId channel = leaving ? kWholeScene : parts.members.channel();
  const std::optional<std::uint32_t> number = leaving ? parts.outbox.send(m) : parts.regions.send_to_peers(m);
  if (number) parts.greeter.on_hello_sent(now, channel, *number);
}

void Peer::Impl::introduce(Hello& hello) {
  std::vector<ObjectId> own;
  for (const auto& [object, each] : std::as_const(parts.own)) {
    if (!each.adopted) own.push_back(object);  // decisions and updates say whose that is, and since when
  }
  Introduction& introduction =
      hello.introduction.emplace(parts.greeter.introduction(own, parts.world_time.start(), parts.world_time.zero()));
  introduction.line = parts.admission.line();
  introduction.has_edits = !parts.logs.empty();
  for (std::size_t k = 0; k < introduction.owned.size(); ++k) {
    if (parts.owners.as_founder(introduction.owned[k])) introduction.owned_as_founder |= std::uint64_t{1} << k;
  }
}

// Says to all peers of a large session that this one is here, and, where it leads, what time it is.
void Peer::Impl::send_far_hello(HostTime now) {
  const bool leads = parts.time.follows() == parts.config.id;
  Message m = parts.outbox.blank();
  m.next_hello = parts.greeter.schedule_next_far(now, leads);
  Hello& hello = m.hello.emplace();
  parts.time.stamp(hello, now);
  hello.sessions = parts.greeter.sessions();
  hello.latency = parts.members.own_latency();
  introduce(hello);
  if (leads) Greeter::fill_far_echoes(hello, now, parts.members);
  operations.add_lengths(m);
  parts.greeter.on_hello_sent(now, kWholeScene, parts.outbox.send(m));
}

// ---- the facade ----

Peer::Peer(PeerConfig config, const WorldModel& model) : impl_(std::make_unique<Impl>(std::move(config), model)) {}
Peer::~Peer() = default;

std::expected<void, Drop> Peer::on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram) {
  return impl_->intake.on_packet(now, region, datagram);
}

void Peer::on_tick(HostTime now, std::span<const OwnSample> samples) { impl_->on_tick(now, samples); }

std::optional<SimTime> Peer::due_tick(HostTime now) const { return impl_->due_tick(now); }

void Peer::publish_now(HostTime now, std::span<const OwnSample> samples) { impl_->publish_now(now, samples); }

void Peer::on_os_clock(HostTime now, std::optional<OsClock> clock) { impl_->parts.time.on_os_clock(now, clock); }

void Peer::start_motions(HostTime now, SimTime start) {
  PeerParts& p = impl_->parts;
  if (!p.replica.begun()) return;
  const SimTime from = std::max(start, p.to_session(now));
  for (const auto& [object, own] : std::as_const(p.own)) {
    if (!own.driven && !own.adopted) p.launches.schedule(object, from + own.launch.after);
  }
}

bool Peer::change_velocity(HostTime now, ObjectId object, const Vec3& velocity, bool absolute) {
  PeerParts& p = impl_->parts;
  const OwnObject* own = std::as_const(p.own).find(object);
  if (!p.replica.begun() || own == nullptr || own->driven) return false;
  const SimTime t = std::max(p.to_session(now), p.ticks.last_time());
  p.launches.begin_due(t, [&p](SimTime at, ObjectId o) { return p.file_velocity(at, o); });
  p.replica.advance_truth(t);
  p.launches.change_velocity(t, object, velocity, absolute);
  return true;
}

bool Peer::begin_driving(HostTime now, ObjectId object) {
  PeerParts& p = impl_->parts;
  OwnObject* const own = p.own.find(object);
  if (!p.replica.begun() || own == nullptr) return false;
  if (own->driven) return true;
  const SimTime t = std::max(p.to_session(now), p.ticks.last_time());
  MotionWorld& truth = p.replica.truth();
  assert(truth.has(object));
  p.replica.advance_truth(t);
  // Let go in the air, it falls as before, also where it rested on something meanwhile.
  const Vec3 before = truth.unborne_acceleration(object, t);
  const bool stood_free = before.isZero(0.0) && !truth.free_acceleration(object);
  truth.set_free_acceleration(object, stood_free ? p.model->gravity_of(object) : before);
  const MotionModel law(at_rest(truth.relative_at(object, t).pose()));
  p.launches.forget(object);
  own->driven = true;
  own->models.reset();
  own->poses = {};
  truth.declare(object, Role::kDriven);
  truth.set_base(object, t, law);
  p.own.check(object);
  return true;
}

void Peer::end_driving(HostTime now, ObjectId object, const KinematicState& state) {
  PeerParts& p = impl_->parts;
  OwnObject* const own = p.own.find(object);
  if (!p.replica.begun() || own == nullptr || !own->driven) return;
  const SimTime t = std::max(p.to_session(now), p.ticks.last_time());
  assert(p.replica.truth().has(object) && p.owners.of(object) == p.config.id);
  p.replica.advance_truth(t);
  own->driven = false;
  own->models.reset();
  p.replica.truth().declare(object, Role::kAuthoritative);
  p.launches.let_go(t, object, state);
}

void Peer::announce_start(SimTime start) {
  impl_->parts.world_time.announce_start(start);
  impl_->keeper.reintroduce();
}

std::expected<OperationId, std::string> Peer::edit(HostTime now, OperationBody body) {
  return impl_->operations.edit(now, std::move(body));
}

std::expected<Taking, std::string> Peer::own(HostTime now, ObjectId object, bool steals) {
  return impl_->operations.own(now, object, steals);
}

std::expected<OperationId, std::string> Peer::give(HostTime now, ObjectId object, PeerId to) {
  return impl_->operations.give(now, object, to);
}

std::expected<UndoneEdit, std::string> Peer::undo(HostTime now, bool redoes) {
  return impl_->operations.undo(now, redoes);
}

void Peer::follow_writers() { impl_->operations.follow_writers(); }

std::vector<std::byte> Peer::log_bytes(const OperationRange& range) const { return impl_->parts.logs.bytes(range); }

void Peer::leave(HostTime now) {
  impl_->parts.publication.flush(true);
  impl_->send_hello(now, true);
}

std::optional<Output> Peer::poll_output() { return impl_->parts.outbox.poll(); }

void Peer::reuse(Bytes&& datagram) { impl_->parts.outbox.reuse(std::move(datagram)); }

HostTime Peer::next_deadline() const {
  const PeerParts& p = impl_->parts;
  HostTime next = p.greeter.next_deadline();
  if (!p.time.started()) return next;
  if (const auto due = p.exchange.next_deadline()) next = std::min(next, *due);
  if (p.replica.begun()) next = std::min(next, p.time.clock().to_host(p.ticks.next_time()));
  if (const auto expiry = p.members.next_expiry()) next = std::min(next, *expiry);
  return next;
}

PeerId Peer::id() const { return impl_->parts.config.id; }
const Scene& Peer::scene() const { return *impl_->parts.model->scene; }
const WorldModel& Peer::model() const { return *impl_->parts.model; }
const NodeData& Peer::data() const { return impl_->parts.living.data(); }
std::vector<Lock> Peer::locks() const {
  const LivingScene& living = impl_->parts.living;
  std::vector<Lock> all;
  for (const auto& [object, author] : living.locks()) all.push_back({object, author, living.name_of_writer(author)});
  return all;
}

std::optional<Lock> Peer::lock_around(ObjectId object) const {
  const LivingScene& living = impl_->parts.living;
  const auto locked = living.lock_around(object);
  if (!locked) return std::nullopt;
  const AuthorId author = living.locks().at(*locked);
  return Lock{*locked, author, living.name_of_writer(author)};
}

const Conflicts& Peer::conflicts() const { return impl_->parts.living.conflicts(); }
std::optional<OperationBody> Peer::find(const OperationKey& operation) const {
  return impl_->parts.living.find(operation);
}
const PeerConfig& Peer::config() const { return impl_->parts.config; }
const SessionClock& Peer::clock() const { return impl_->parts.time.clock(); }
const std::optional<OsClock>& Peer::os_clock() const { return impl_->parts.time.os_clock(); }
OffsetBounds Peer::clock_reach(HostTime now) const { return impl_->parts.time.reach(now); }
std::optional<PeerId> Peer::follows() const { return impl_->parts.time.follows(); }
const Membership& Peer::members() const { return impl_->parts.members; }
const Owners& Peer::owners() const { return impl_->parts.owners; }
bool Peer::owns_any() const { return impl_->parts.own.size() > 0; }
std::optional<double> Peer::threshold_m(ObjectId object) const {
  const OwnObject* const own = std::as_const(impl_->parts.own).find(object);
  return own == nullptr ? std::nullopt : own->threshold_m;
}
std::optional<SimTime> Peer::world_zero() const { return impl_->parts.world_time.zero(); }
std::optional<double> Peer::time_sensors_limited_at() const { return impl_->parts.scripted.limited_at(); }

Vec3 Peer::to_world(SimTime at, ObjectId object, const Vec3& in_parent) {
  return impl_->parts.velocity_in_world(at, object, in_parent);
}

KinematicState Peer::truth(ObjectId object, SimTime t) const { return impl_->parts.replica.truth(object, t); }
KinematicState Peer::ghost(ObjectId object, SimTime t) const { return impl_->parts.replica.ghost(object, t); }
bool Peer::receives(ObjectId object) const { return impl_->parts.replica.receives(object); }

const UpdateRecord* Peer::last_update_of(ObjectId object) const { return impl_->parts.replica.last_update_of(object); }

const Interest& Peer::interest() const { return impl_->parts.regions.interest(); }

void Peer::advance_ghosts(SimTime t) {
  PeerParts& p = impl_->parts;
  if (!p.replica.begun()) return;
  p.scripted.extend(t, p.world_time.zero(), p.owners, p.scene, p.replica);
  p.replica.advance_ghosts(t);
}

void Peer::look(std::vector<View> views) { impl_->parts.sight.look(std::move(views)); }
void Peer::look_from(const std::optional<Viewpoint>& viewpoint) {
  impl_->parts.config.decisions.viewpoint = viewpoint;
  impl_->keeper.reintroduce();
}

std::optional<double> Peer::ghost_difference_m(ObjectId object, HostTime now) const {
  return impl_->parts.ghost_check.difference_m(object, impl_->parts.to_session(now));
}

void Peer::displace_ghost(ObjectId object, SimTime t, const Vec3& by_m) {
  Replica& replica = impl_->parts.replica;
  assert(replica.begun() && replica.ghosts().has(object));
  MotionModel law = replica.ghosts().model_at(object, t);
  law.state.position += by_m;
  replica.ghosts().set_base(object, t, law);
}

Pose Peer::shown(ObjectId object, SimTime t) { return impl_->parts.display.shown(object, t); }

std::optional<Duration> Peer::bound(SimTime t) {
  Display& display = impl_->parts.display;
  return display.is_bounded() ? std::optional(display.bound(t)) : std::nullopt;
}

const Peer::Counters& Peer::counters() const { return impl_->parts.counters; }
const OperationLogs& Peer::logs() const { return impl_->parts.logs; }
OperationExchange::Counters Peer::exchange_counters() const { return impl_->parts.exchange.counters(); }

MotionWorld::Counters Peer::motion_counters() const {
  MotionWorld::Counters sum;
  const Replica& replica = impl_->parts.replica;
  if (replica.begun()) (sum += replica.truth().counters()) += replica.ghosts().counters();
  return sum;
}

}  // namespace peerd::replication
