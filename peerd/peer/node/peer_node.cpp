#include "peerd/peer/node/peer_node.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/motion/viewpoint_nodes.hpp"
#include "replication/objects/contacts/decision.hpp"

namespace peerd {
namespace {

// The highest speed that a key may give an object [m/s]. A faster one would soon leave the range of an update (1e12 m),
// and receivers drop updates beyond that range.
constexpr double kKeySpeedMax_m_s = 1e6;
// A Viewpoint node does not say how wide its picture is: width / height.
constexpr double kUsualAspect = 4.0 / 3.0;
constexpr Duration kStartIsAnnouncedWithin = std::chrono::seconds(5);

const char* to_string(replication::ContactKind kind) {
  switch (kind) {
    case replication::ContactKind::kOwner:
      return "owner";
    case replication::ContactKind::kDecided:
      return "decided";
    case replication::ContactKind::kPredicted:
      return "predicted";
    case replication::ContactKind::kApplied:
      return "applied";
    case replication::ContactKind::kScene:
      return "scene";
  }
  return "?";
}

replication::Viewpoint viewpoint_of(const config::ViewpointSettings& v, std::optional<ObjectId> object) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  const Vec3 axis = Vec3(v.axis[0], v.axis[1], v.axis[2]).normalized();
  return {object,
          {Vec3(v.position[0], v.position[1], v.position[2]), Quat(Eigen::AngleAxisd(v.angle_deg * kRadians, axis))},
          v.field_of_view_deg * kRadians,
          v.aspect};
}

// The Viewpoint node that is bound when the world is loaded, in the frame of the node that it stands in.
std::optional<replication::View> view_of_file(const Scene& scene) {
  const auto node = bound_viewpoint(scene);
  if (!node) return std::nullopt;
  const Pose frame = node->parent ? scene.rigid_pose(*node->parent) : Pose{};
  const Quat back = frame.orientation.conjugate();
  const Pose in_frame{back * (node->in_world.position - frame.position),
                      (back * node->in_world.orientation).normalized()};
  return replication::View{{node->parent, in_frame, node->field_of_view, kUsualAspect}};
}

// What the peer sees by its configuration; where that names nothing, what the world's Viewpoint node shows.
replication::SightSettings sight_of(const config::PeerSettings& settings, const config::PeerObjects& objects,
                                    const Scene& scene) {
  replication::SightSettings sight{settings.skip_unseen, {}};
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  const auto add = [&](const config::ViewpointSettings& v, std::optional<ObjectId> object) {
    sight.views.push_back({viewpoint_of(v, object), v.far_m.value_or(kEndless)});
  };
  if (settings.viewpoint) add(*settings.viewpoint, objects.viewpoint);
  for (std::size_t i = 0; i < settings.views.size(); ++i) add(settings.views[i], objects.views[i]);
  if (!sight.views.empty()) return sight;
  if (const auto view = view_of_file(scene)) sight.views.push_back(*view);
  return sight;
}

void count_rest(const replication::MotionWorld::Counters& m, std::map<std::string, std::uint64_t>& n) {
  n["came_to_rest"] = m.came_to_rest;
  n["jammed"] = m.jammed;
  n["islands"] = m.islands;
  n["island_objects_max"] = m.largest_island;
  n["rest_energy_nj"] = static_cast<std::uint64_t>(std::llround(1e9 * m.rest_energy_j));
}

void count_ghost_checks(const replication::PeerCounters& c, std::map<std::string, std::uint64_t>& counters) {
  counters["ghost_checks"] = c.ghost_checks;
  counters["ghost_questions"] = c.ghost_questions;
  counters["ghost_answers"] = c.ghost_answers;
  counters["ghosts_differ"] = c.ghosts_differ;
  counters["ghosts_differ_explained"] = c.ghosts_differ_explained;
  counters["ghosts_reported"] = c.ghosts_reported;
}

void count_late(const replication::PeerCounters& c, std::map<std::string, std::uint64_t>& counters) {
  counters["updates_late"] = c.updates_late;
  counters["updates_missing"] = c.updates_missing;
  counters["decisions_late"] = c.decisions_late;
}

}  // namespace

std::vector<std::string> SharedWorld::findings() const {
  std::vector<std::string> all = world.warnings;
  for (const std::string& line : model->unsupported) all.push_back("unsupported: " + line);
  return all;
}

Result<std::unique_ptr<const SharedWorld>> share_world(const std::filesystem::path& path, const WorldReading& reading,
                                                       std::span<const config::RunSettings> runs) {
  auto world = config::load_world(path, reading);
  if (!world) return std::unexpected(world.error());
  return share_world(*std::move(world), runs);
}

std::unique_ptr<const SharedWorld> share_world(config::LoadedWorld world, std::span<const config::RunSettings> runs) {
  auto shared = std::make_unique<SharedWorld>();
  shared->world = std::move(world);
  const Scene& scene = shared->world.scene;
  shared->model = replication::make_world_model(scene, config::owned_in(runs, scene));
  return shared;
}

std::unique_ptr<PeerNode> PeerNode::make(const config::PeerSettings& settings,
                                         const config::ReplicationSettings& replication, const SharedWorld& shared,
                                         config::PeerObjects objects, Options options) {
  replication::PeerConfig config;
  config.id = PeerId{settings.id};
  config.name = settings.name;
  config.incarnation = options.incarnation;
  config.author = options.author;
  config.rare = options.rare;
  config.log = {std::move(options.log), options.line, options.joins};
  config.signer = options.signer;
  config.world_hash = replication.session_hash(shared.world.hash);
  config.policy = replication.policy;
  config.convergence = replication.convergence;
  config.remote_convergence = replication.remote_convergence;
  config.relay = replication.relay;
  config.display_delay = replication.display_delay;
  config.bounded_latency = replication.bounded_latency;
  config.regions = replication.regions;
  config.large = replication.large;
  config.interest_radius_m = settings.interest_radius_m;
  config.tick_hz = settings.tick_hz.value_or(replication.tick_hz);
  config.detection = replication.collision.make_detection(replication.tick_hz);
  config.settled_hello_period = from_seconds(replication.settled_hello_period_s);
  config.clock_ahead_max = from_seconds(replication.clock_ahead_s);
  config.may_steal = replication.steal;
  config.wait_for_start = true;
  config.decisions = replication.decisions;
  if (settings.viewpoint) config.decisions.viewpoint = viewpoint_of(*settings.viewpoint, objects.viewpoint);
  config.sight = sight_of(settings, objects, shared.world.scene);
  const auto as_owned = [&](ObjectId object) {
    const bool outside =
        std::ranges::any_of(objects.outside, [&](const auto& named) { return named.second == object; });
    const auto launch = objects.launches.find(object);
    return replication::OwnedObject{object, outside || objects.motions.contains(object),
                                    launch == objects.launches.end() ? replication::Launch{} : launch->second};
  };
  for (const ObjectId object : objects.owned) config.owned.push_back(as_owned(object));
  for (const ObjectId object : objects.owned_by_founder) config.owned_by_founder.push_back(as_owned(object));
  feed::PoseFeeds feeds({std::move(objects.outside), from_seconds(settings.feed.stale_s)}, shared.world.scene);
  return std::unique_ptr<PeerNode>(new PeerNode(std::move(config), shared, std::move(objects.motions), std::move(feeds),
                                                settings.keys, settings.edits, std::move(options)));
}

PeerNode::PeerNode(replication::PeerConfig config, const SharedWorld& shared, config::Motions motions,
                   feed::PoseFeeds feeds, std::vector<config::ScriptedKey> keys,
                   std::vector<config::ScriptedEdit> edits, Options options)
    : shared_(shared),
      motions_(std::move(motions)),
      feeds_(std::move(feeds)),
      options_(std::move(options)),
      config_(std::move(config)),
      peer_(config_, *shared.model),
      key_sensors_(shared.world.scene),
      keys_(std::move(keys)),
      edits_(std::move(edits)) {
  config_.log = {};  // the peer has it
  log_.peer = config_.id;
  log_.name = config_.name;
}

void PeerNode::on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram) {
  (void)peer_.on_packet(now, region, datagram);  // the peer's counters have the reason of a drop
}

// The peer that sets the start: the lowest id of those that are waited for or, for a peer that waits for nobody, of
// those that run an object.
PeerId PeerNode::starter() const {
  PeerId lowest = config_.id;
  for (const AwaitedPeer& peer : options_.wait_for) lowest = std::min(lowest, peer.id);
  if (!options_.wait_for.empty()) return lowest;
  for (const auto& [object, owner] : peer_.owners()) {
    if (owner != kNobody) lowest = std::min(lowest, owner);
  }
  return lowest;
}

// One peer sets the start, and the others follow its hellos. Whoever knows it announces it where nobody else does: the
// one who set it may have left, or be another life that has forgotten.
void PeerNode::agree_on_start(HostTime now) {
  if (!peer_.clock().synchronised()) return;
  const std::optional<SimTime> announced = peer_.members().announced_start();
  if (options_.late && announced) {
    follow_start(now, *announced);
    return;
  }
  if (options_.watches && !peer_.owns_any() && !announced) return;
  if (const PeerId other = starter(); other != config_.id) {
    const replication::OtherPeer* const starting = peer_.members().find_any(other);
    if (starting != nullptr && starting->start) log_.start = starting->start;
  } else if (!missing().empty()) {
    complete_since_.reset();
  } else if (!log_.start) {
    if (!complete_since_) complete_since_ = now;
    // One that comes late sets the start where all have come late, so that nobody announces one.
    const bool others_may_know = options_.late && !options_.wait_for.empty();
    if (others_may_know && now - *complete_since_ < kStartIsAnnouncedWithin) return;
    log_.start = std::chrono::ceil<std::chrono::seconds>(peer_.clock().to_session(now) + options_.start_lead);
  }
  if (log_.start && !announces_start_ && !announced) {
    announces_start_ = true;
    peer_.announce_start(*log_.start);
  }
}

std::vector<AwaitedPeer> PeerNode::missing() const {
  std::vector<AwaitedPeer> missing;
  if (log_.start) return missing;
  for (const AwaitedPeer& peer : options_.wait_for) {
    const replication::OtherPeer* const other = peer_.members().find_any(peer.id);
    const bool is_here = peer.id == config_.id || (other != nullptr && other->synchronised);
    if (!is_here) missing.push_back(peer);
  }
  return missing;
}

// A late peer takes the start that any member announces, and skips scripted keys and edits that precede its own
// joining.
void PeerNode::follow_start(HostTime now, SimTime start) {
  const bool first = !log_.start;
  log_.start = start;
  const SimTime session_now = peer_.clock().to_session(now);
  while (first && next_key_ < keys_.size() && key_time(next_key_) < session_now) ++next_key_;
  while (first && next_edit_at() < session_now) (void)edits_.take_next();
}

void PeerNode::leave(HostTime now) {
  peer_.leave(now);
  log_.ended_at = now - options_.clock_offset;
}

void PeerNode::on_tick(HostTime now) {
  agree_on_start(now);
  if (log_.start != started_for_) {
    // The start shifts where two sessions meet; motions that have begun are not affected.
    const bool begun = started_for_ && *log_.start <= peer_.clock().to_session(now);
    started_for_ = log_.start;
    if (!begun) peer_.start_motions(now, *log_.start);
  }
  const std::optional<SimTime> due = peer_.due_tick(now);
  samples_.clear();
  if (due) {
    for (const auto& [object, motion] : motions_) {
      if (!scene().contains(object)) continue;  // an edit has removed it
      // Until the start is known, the object stands where the world's file places it.
      samples_.push_back({object, log_.start ? motion.sample(to_seconds(*due - *log_.start))
                                             : at_rest(shared_.world.scene.rigid_pose(object))});
    }
    for (const ObjectId object : feeds_.objects()) {
      if (!scene().contains(object)) continue;
      samples_.push_back({object, feeds_.sample(object, peer_.clock().to_host(*due))});
    }
  }
  const std::uint64_t ticks = peer_.counters().ticks;
  peer_.on_tick(now, samples_);
  const bool ticked = due && peer_.counters().ticks > ticks;  // no tick where the session time has just changed
  if (ticked) logged_at_ = *due;
  let_go_of_lost(now);
  press_keys(now);
  make_edits(now);
  edits_.give_up(now);
  for (const auto& asked : edits_.take_requests()) on_request(now, asked);
  if (!options_.keep_log || !log_.start) return;
  if (ticked) record_truths(*due);
  record_ghosts(now);
}

SimTime PeerNode::sample_time(std::int64_t number) const {
  const std::int64_t hz = options_.sample_hz;
  return *log_.start + std::chrono::seconds(number / hz) + Duration{number % hz * 1'000'000'000 / hz};
}

std::optional<SimTime> PeerNode::advance_view(HostTime now, std::optional<SimTime> last) {
  if (!peer_.clock().synchronised()) return std::nullopt;
  SimTime t = peer_.clock().to_session(now);
  if (const auto due = peer_.due_tick(now)) t = std::min(t, *due);
  if (options_.keep_log && log_.start) t = std::min(t, sample_time(next_sample_));
  if (last) t = std::max(t, *last);
  peer_.advance_ghosts(t);
  return t;
}

HostTime PeerNode::next_deadline() const {
  HostTime next = peer_.next_deadline();
  if (!log_.start) return next;
  if (next_key_ < keys_.size()) next = std::min(next, peer_.clock().to_host(key_time(next_key_)));
  if (edits_.next_at_s()) next = std::min(next, peer_.clock().to_host(next_edit_at()));
  if (options_.keep_log) next = std::min(next, peer_.clock().to_host(sample_time(next_sample_)));
  return next;
}

// Scripted keys are pressed after the tick of the same time, because that tick publishes states from before the press.
void PeerNode::press_keys(HostTime now) {
  if (!log_.start) return;
  const SimTime session_now = peer_.clock().to_session(now);
  while (next_key_ < keys_.size() && key_time(next_key_) <= session_now) {
    key_reports_.push_back(press(now, keys_[next_key_++].key));
  }
}

SimTime PeerNode::next_edit_at() const {
  const auto at_s = edits_.next_at_s();
  return at_s && log_.start ? *log_.start + from_seconds(*at_s) : SimTime::max();
}

void PeerNode::make_edits(HostTime now) {
  if (!log_.start) return;
  const SimTime session_now = peer_.clock().to_session(now);
  while (next_edit_at() <= session_now) (void)edit(now, edits_.take_next());
}

EditReport PeerNode::edit(HostTime now, const config::SceneEdit& edit) {
  if (is_about_ownership(edit)) return change_owner(now, edit);
  if (is_undo(edit)) return undo(now, edit);
  EditReport report{edit, std::nullopt, {}};
  auto body = operation_of(edit, scene(), config_.id);
  if (!body) {
    report.refused = body.error();
  } else if (const auto operation = peer_.edit(now, *std::move(body))) {
    report.operation = *operation;
  } else {
    report.refused = operation.error();
  }
  edits_.note(report);
  return report;
}

// The report names the edit that is undone, or redone.
EditReport PeerNode::undo(HostTime now, const config::SceneEdit& edit) {
  EditReport report{edit, std::nullopt, {}};
  if (const auto undone = peer_.undo(now, edit.kind == config::SceneEdit::Kind::kRedo)) {
    report.operation = undone->operation;
    report.edit.path = name_of(*undone);
  } else {
    report.refused = undone.error();
  }
  edits_.note(report);
  return report;
}

EditReport PeerNode::change_owner(HostTime now, const config::SceneEdit& edit) {
  EditReport report{edit, std::nullopt, {}};
  const auto object = scene().find(edit.path);
  const auto done = [&]() -> std::expected<replication::Taking, std::string> {
    if (!object) return std::unexpected("the scene has no " + edit.path);
    if (edit.kind != config::SceneEdit::Kind::kRelease) {
      return peer_.own(now, *object, edit.kind == config::SceneEdit::Kind::kSteal);
    }
    if (fed_while_held_.contains(*object)) on_tick(now);  // a due tick is of an earlier instant
    if (peer_.owner(*object) != config_.id) return std::unexpected("this peer does not own it");
    let_go(now, *object);
    const auto released = peer_.give(now, *object, kNobody);
    if (!released) return std::unexpected(released.error());
    return replication::Taking{*released};
  }();
  if (!done) {
    report.refused = done.error();
    edits_.note(report);
  } else {
    report.operation = done->operation;
    edits_.note(report, *object, done->asks ? std::optional(now + replication::kAskedFor) : std::nullopt);
  }
  return report;
}

// Another peer asks for an object of this one, which keeps what something drives here, what it holds, and what it
// cannot give, because an edit has removed it, or somebody has locked it.
void PeerNode::on_request(HostTime now, const replication::ObjectRequested& asked) {
  const char* const why_not = peer_.owner(asked.object) != config_.id ? "its owner has it no more"
                              : drives(asked.object)                  ? "its owner drives it"
                              : edits_.holds(asked.object)            ? "its owner holds it"
                                                                      : nullptr;
  if (why_not != nullptr) {
    (void)peer_.edit(now, replication::RefuseRequest{asked.request, why_not});
  } else if (const auto given = peer_.give(now, asked.object, asked.by); !given) {
    (void)peer_.edit(now, replication::RefuseRequest{asked.request, given.error()});
  }
}

void PeerNode::note_path(ObjectId object) {
  if (object.origin != 0) log_.paths.try_emplace(object, path_or_id(scene(), object));
}

feed::Outcome PeerNode::on_poses(HostTime now, Duration host_minus_wall, std::span<const feed::FedPose> poses) {
  for (const feed::FedPose& fed : poses) feed_grabbed(now, fed.object);
  feed::Outcome outcome = feeds_.push(now, host_minus_wall, poses);
  drive_fed(now);
  if (outcome.taken == 0) return outcome;
  if (peer_.due_tick(now)) on_tick(now);  // a due tick is of an earlier instant and must not see a jump of now
  samples_.clear();
  for (const feed::FedPose& fed : poses) {
    if (const auto object = feeds_.find(fed.object)) samples_.push_back({*object, feeds_.sample(*object, now)});
  }
  peer_.publish_now(now, samples_);
  return outcome;
}

// Poses may move what a client of this peer has grabbed.
void PeerNode::feed_grabbed(HostTime now, const std::string& path) {
  if (feeds_.find(path)) return;
  const auto object = scene().find(path);
  const auto is_grabbed = [&] {
    return object && scene().contains(*object) && edits_.holds(*object) && peer_.owner(*object) == config_.id &&
           !drives(*object) && peer_.clock().synchronised();
  };
  if (!is_grabbed()) return;
  if (peer_.due_tick(now)) on_tick(now);  // which is of an earlier instant
  if (!is_grabbed()) return;
  feeds_.add(path, *object, peer_.truth(*object, peer_.clock().to_session(now)).pose());
  fed_while_held_.insert(*object);
}

// The hand has what its first good pose has reached.
void PeerNode::drive_fed(HostTime now) {
  for (const ObjectId object : std::vector(fed_while_held_.begin(), fed_while_held_.end())) {
    if (feeds_.begun(object) && peer_.begin_driving(now, object)) continue;
    feeds_.remove(object);
    fed_while_held_.erase(object);
  }
}

std::expected<void, std::string> PeerNode::let_go(HostTime now, const std::string& path) {
  const auto object = scene().find(path);
  if (!object) return std::unexpected("the scene has no " + path);
  on_tick(now);  // a due tick is of an earlier instant
  if (!fed_while_held_.contains(*object)) return std::unexpected("no poses move it that this peer has grabbed");
  let_go(now, *object);
  return {};
}

std::expected<void, std::string> PeerNode::look_from(const std::string& path,
                                                     std::optional<replication::Viewpoint> viewpoint) {
  if (!viewpoint) {
    peer_.look_from(config_.decisions.viewpoint);
    return {};
  }
  if (!path.empty()) viewpoint->object = scene().find(path);
  if (!path.empty() && !viewpoint->object) return std::unexpected("the scene has no " + path);
  peer_.look_from(viewpoint);
  return {};
}

// The object goes on as its last poses moved it.
void PeerNode::let_go(HostTime now, ObjectId object) {
  if (fed_while_held_.erase(object) == 0) return;
  if (scene().contains(object)) {
    peer_.end_driving(now, object, feeds_.sample(object, now));
    peer_.publish_now(now, {});
  }
  feeds_.remove(object);
}

void PeerNode::let_go_of_lost(HostTime now) {
  for (const ObjectId object : std::vector(fed_while_held_.begin(), fed_while_held_.end())) {
    const bool is_held = scene().contains(object) && peer_.owner(object) == config_.id && edits_.holds(object);
    if (!is_held) let_go(now, object);
  }
}

KeyReport PeerNode::on_key(HostTime now, const KeyEvent& key) {
  on_tick(now);  // a due tick publishes the motion from before the key, so it comes first
  KeyReport report = press(now, key);
  key_reports_.push_back(report);
  peer_.publish_now(now, {});
  return report;
}

// Edits change which KeySensors there are. Those that were there stay enabled or disabled as they are.
void PeerNode::follow_scene() {
  if (std::exchange(keys_of_scene_, peer_.counters().scene_changes) == peer_.counters().scene_changes) return;
  key_sensors_ = KeySensors(scene(), &key_sensors_);
}

KeyReport PeerNode::press(HostTime now, const KeyEvent& key) {
  KeyReport report;
  report.key = key;
  ++key_counters_.pressed;
  if (!log_.start || peer_.clock().to_session(now) < *log_.start) {
    report.refused = "the objects have not begun to move yet";
    return report;
  }
  follow_scene();
  const KeySensors::Outcome outcome = key_sensors_.press(key);
  report.hits = outcome.hits.size();
  report.consumed = outcome.consumed;
  key_counters_.unhandled += report.hits == 0;
  for (const std::size_t hit : outcome.hits) {
    const KeySensor& sensor = scene().key_sensors[hit];
    if (!sensor.recipient) continue;
    KeyReport::Change& change = report.changes.emplace_back();
    change.sensor = hit;
    change.recipient = *sensor.recipient;
    change.velocity_world = peer_.to_world(peer_.clock().to_session(now), *sensor.recipient, sensor.value);
    change.absolute = sensor.absolute;
    change.refused = why_not(now, change);
    if (change.refused.empty() &&
        !peer_.change_velocity(now, change.recipient, change.velocity_world, change.absolute)) {
      change.refused = "this peer does not run it in this session";
    }
    ++(change.refused.empty() ? key_counters_.changes : key_counters_.changes_refused);
  }
  return report;
}

// Returns the reason why this peer may not make the change; empty where it may.
std::string PeerNode::why_not(HostTime now, const KeyReport::Change& change) const {
  const ObjectId object = change.recipient;
  const PeerId owner = peer_.owner(object);
  if (owner == kNobody) return "no peer runs it";
  if (owner != config_.id) {
    const auto member = peer_.members().all().find(owner);
    const std::string id = std::to_string(owner.value);
    return member == peer_.members().all().end() ? "peer " + id + " runs it"
                                                 : "peer " + member->second.name + " (id " + id + ") runs it";
  }
  if (feeds(object)) return "a program outside moves it";
  if (drives(object)) return "a motion of the configuration moves it";
  Vec3 velocity = change.velocity_world;
  if (!change.absolute) velocity += peer_.truth(object, peer_.clock().to_session(now)).velocity;
  // The comparison is written so that a NaN is refused too.
  return velocity.norm() <= kKeySpeedMax_m_s ? "" : "it would be faster than 1e6 m/s, more than updates can tell of";
}

std::optional<KeyReport> PeerNode::poll_key_report() {
  if (key_reports_.empty()) return std::nullopt;
  KeyReport report = std::move(key_reports_.front());
  key_reports_.pop_front();
  return report;
}

void PeerNode::record_truths(SimTime t) {
  for (const auto& [object, owner] : peer_.owners()) {
    if (owner != config_.id) continue;
    record(t, object, owner, peer_.truth(object, t), peer_.shown(object, t));
  }
}

// Ghosts are sampled on a time grid of their own: on the grid of ticks, peers with the same ghosts but different tick
// rates would show different errors. Samples that fell into a suspension are left out, for later knowledge must not
// fill them.
void PeerNode::record_ghosts(HostTime now) {
  const SimTime session_now = peer_.clock().to_session(now);
  if (session_now < sample_time(next_sample_)) return;
  while (sample_time(next_sample_ + 1) <= session_now) ++next_sample_;
  const SimTime t = sample_time(next_sample_++);
  peer_.advance_ghosts(t);
  // With a bound, what others see is compared with what the owner sees at the same session time.
  const auto bound = peer_.bound(t);
  if (bound) note_bound(*bound);
  const bool records_own = bound && t >= logged_at_;
  for (const auto& [object, owner] : peer_.owners()) {
    if (owner == config_.id && records_own) record(t, object, owner, peer_.truth(object, t), peer_.shown(object, t));
    if (owner != config_.id && peer_.receives(object))
      record(t, object, owner, peer_.ghost(object, t), peer_.shown(object, t));
  }
}

void PeerNode::note_bound(Duration bound) {
  PeerLog::Bound& seen = log_.bound ? *log_.bound : log_.bound.emplace(PeerLog::Bound{bound, bound, Duration{0}});
  seen.least = std::min(seen.least, bound);
  seen.most = std::max(seen.most, bound);
  seen.latest_by = peer_.counters().latest_by;
}

void PeerNode::record(SimTime t, ObjectId object, PeerId owner, const KinematicState& state, const Pose& shown) {
  note_path(object);
  PeerLog::ObjectSample sample{t, peer_.clock().to_host(t) - options_.clock_offset, object, owner, state, shown};
  if (options_.rows != nullptr) return options_.rows->add(log_, sample);
  log_.object_samples.push_back(std::move(sample));
}

std::optional<replication::Output> PeerNode::poll_output() {
  auto out = peer_.poll_output();
  if (!out) return out;
  using namespace replication;
  edits_.note(*out, config_.id);
  if (std::holds_alternative<Join>(*out)) log_.groups_joined = std::max(log_.groups_joined, ++groups_);
  if (std::holds_alternative<Leave>(*out)) --groups_;
  if (std::holds_alternative<OtherWorld>(*out)) ++log_.other_worlds;
  if (const auto* const taken = std::get_if<LineTaken>(&*out)) options_.line = taken->line;
  if (const auto* const other = std::get_if<OtherLine>(&*out); other != nullptr && other->goes_over) {
    goes_over_ = other->line;
  }
  // Motions continue from where they are. Where the other session has begun its motions, its start is adopted later.
  const auto* stepped = std::get_if<ClockStepped>(&*out);
  if (stepped != nullptr && log_.start && !stepped->same_session) *log_.start += stepped->step;
  // A suspension discards the planned start, so a peer that was suspended across its start plans it again.
  const bool suspended = std::holds_alternative<HostSuspended>(*out) || (stepped != nullptr && stepped->same_session);
  if (suspended && log_.start && logged_at_ < *log_.start) started_for_.reset();
  if (!options_.keep_log) return out;
  if (const auto* send = std::get_if<Send>(&*out)) {
    const PeerLog::Datagram row{logged_at_, static_cast<std::uint32_t>(send->datagram.size())};
    options_.rows != nullptr ? options_.rows->add(log_, row) : log_.datagrams.push_back(row);
  } else if (const auto* p = std::get_if<Published>(&*out)) {
    PeerLog::Update row{p->at, p->object, static_cast<std::uint32_t>(p->size_bytes), p->threshold_m,
                        to_string(p->reason)};
    options_.rows != nullptr ? options_.rows->add(log_, std::move(row)) : log_.updates.push_back(std::move(row));
  } else if (const auto* c = std::get_if<ContactSeen>(&*out)) {
    for (const ObjectId object : {c->contact.collider, c->contact.collidee}) note_path(object);
    for (const auto& [a, b] : c->contact.polygons.pairs) {
      note_path(a.shape);
      note_path(b.shape);
    }
    log_.contacts.push_back({c->contact.at, peerd::to_string(c->kind), c->contact.collider, c->contact.collidee,
                             c->contact.normal, c->known_at, c->contact.type, c->contact.polygons});
  } else if (const auto* o = std::get_if<Overruled>(&*out)) {
    std::erase_if(log_.contacts, [&](const PeerLog::Contact& row) {
      return (row.kind == "decided" || row.kind == "applied") && row.at == o->contact && row.collider == o->collider &&
             row.collidee == o->collidee;
    });
  } else if (const auto* b = std::get_if<ContactsRetracted>(&*out)) {
    std::erase_if(log_.contacts, [&](const PeerLog::Contact& row) {
      if (!b->retracts(row.at, row.collider, row.collidee)) return false;
      const bool is_own = row.kind == "owner" && !b->of_ghosts_alone;
      return row.kind == "predicted" || row.kind == "scene" || is_own;
    });
  }
  return out;
}

const PeerLog& PeerNode::log() {
  const auto& c = peer_.counters();
  const auto m = peer_.motion_counters();
  auto& n = log_.counters;
  n = {{"datagrams_in", c.datagrams_in},
       {"datagrams_out", c.datagrams_out},
       {"bytes_in", c.bytes_in},
       {"bytes_out", c.bytes_out},
       {"ticks", c.ticks},
       {"ticks_missed", c.ticks_missed},
       {"updates_in", c.updates_in},
       {"updates_out", c.updates_out},
       {"updates_at_once", c.updates_at_once},
       {"update_bytes_out", c.update_bytes_out},
       {"updates_repeated", c.updates_repeated},
       {"operations", c.operations},
       {"operations_in", c.operations_in},
       {"objects_given", c.objects_given},
       {"scene_changes", c.scene_changes},
       {"models_changed", c.models_changed},
       {"updates_duplicate", c.updates_duplicate},
       {"records_early", c.records_early},
       {"updates_relayed", c.updates_relayed},
       {"updates_withheld", c.updates_withheld},
       {"states_out_of_range", c.states_out_of_range},
       {"convergence_blocked", c.convergence_blocked},
       {"convergence_detours", c.convergence_detours},
       {"objects_looked_at", c.objects_looked_at},
       {"proximity_tests", c.proximity_tests},
       {"proximity_refined", c.proximity_refined},
       {"decisions", c.decisions},
       {"decisions_fallback", c.decisions_fallback},
       {"decisions_repeated", c.decisions_repeated},
       {"decisions_overruled", c.decisions_overruled},
       {"contacts_held", c.contacts_held},
       {"contacts_refuted", c.contacts_refuted},
       {"contacts_too_late", c.contacts_too_late},
       {"contact_searches", m.contact_searches},
       {"contact_searches_far", m.searches_far},
       {"contact_searches_skipped", m.searches_skipped},
       {"contact_searches_unseen", m.searches_put_off},
       {"contacts", m.contacts},
       {"contacts_undone", m.contacts_undone},
       {"contact_searches_overlapped", m.overlapped},
       {"contact_searches_unsupported", m.unsupported},
       {"contact_searches_failed", m.failed},
       {"contacts_capped", m.capped},
       {"clock_steps", c.clock_steps},
       {"clock_contradictions", c.clock_contradictions},
       {"os_clocks_doubted", c.os_clocks_doubted}};
  count_ghost_checks(c, n);
  count_rest(m, n);
  for (std::size_t i = 0; i < c.update_sizes_out.size(); ++i) {
    const bool longer = i == replication::kRecordSizes.size();
    const std::size_t size_bytes = replication::kRecordSizes[longer ? i - 1 : i];
    n[(longer ? "updates_out_longer_than_" : "updates_out_up_to_") + std::to_string(size_bytes) + "_bytes"] =
        c.update_sizes_out[i];
  }
  if (key_counters_.pressed > 0) {
    n["keys"] = key_counters_.pressed;
    n["keys_unheard"] = key_counters_.unhandled;
    n["key_changes"] = key_counters_.changes;
    n["key_changes_refused"] = key_counters_.changes_refused;
  }
  if (store_failures_ > 0) n["store_failures"] = store_failures_;
  feeds_.count(n);
  if (config_.regions.cell_m > 0.0) {
    n["regions_joined"] = c.regions_joined;
    n["regions_left"] = c.regions_left;
    n["handovers"] = c.handovers;
    n["sights_lost"] = c.sights_lost;
    n["predictions_skipped"] = c.predictions_skipped;
  }
  if (config_.sight.skip_unseen) n["predictions_unseen"] = c.predictions_unseen;
  if (config_.bounded_latency.is_on()) count_late(c, n);
  if (peer_.time_sensors_limited_at()) n["time_sensors_stopped"] = 1;
  for (const auto& [reason, count] : c.drops) n["dropped_" + reason] = count;
  return log_;
}

}  // namespace peerd
