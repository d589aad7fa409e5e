#include "peerd/daemon/embed/embedded_peer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <boost/asio/post.hpp>

#include "peerd/peer/node/edit_operation.hpp"

namespace peerd::embed {
namespace {

// A thread that nobody polls looks after its peer at least so often.
constexpr Duration kThreadWaits = std::chrono::milliseconds(100);

void put(const Vec3& v, double (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

StoredEvent event_of(peerd_event_kind kind, std::optional<SimTime> at = {}) {
  StoredEvent stored;
  stored.event.kind = kind;
  if (at) stored.event.time = to_seconds(at->time_since_epoch());
  return stored;
}

struct EventOf {
  using Event = std::optional<StoredEvent>;
  const Scene& scene;

  Event operator()(const replication::PeerJoined& joined) const {
    StoredEvent stored = event_of(PEERD_PEER_JOINED);
    stored.event.peer = joined.peer.value;
    stored.name = joined.name;
    return stored;
  }
  Event operator()(const replication::PeerLost& lost) const {
    StoredEvent stored = event_of(PEERD_PEER_LEFT);
    stored.event.peer = lost.peer.value;
    stored.name = lost.name;
    return stored;
  }
  Event operator()(const replication::ContactSeen& seen) const {
    if (seen.kind == replication::ContactKind::kPredicted) return std::nullopt;  // it may not come to that
    const replication::ContactEvent& contact = seen.contact;
    StoredEvent stored = event_of(PEERD_CONTACT, contact.at);
    peerd_event& event = stored.event;
    event.peer = seen.decider.value;
    event.object = contact.collider.packed();
    event.other = contact.collidee.packed();
    event.pose = pose_of(contact.collider_before.pose());
    event.other_pose = pose_of(contact.collidee_before.pose());
    put(contact.collider_before.velocity, event.velocity_before);
    put(contact.collider_after.velocity, event.velocity_after);
    put(contact.collidee_before.velocity, event.other_velocity_before);
    put(contact.collidee_after.velocity, event.other_velocity_after);
    put(contact.normal, event.normal);
    return stored;
  }
  Event operator()(const replication::Overruled& overruled) const {
    StoredEvent stored = event_of(PEERD_CONTACT_OVERRULED, overruled.contact);
    stored.event.object = overruled.collider.packed();
    stored.event.other = overruled.collidee.packed();
    return stored;
  }
  Event operator()(const replication::ObjectGiven& given) const {
    StoredEvent stored = event_of(PEERD_OBJECT_GIVEN, given.at);
    stored.event.peer = given.owner.value;
    stored.event.object = given.object.packed();
    return stored;
  }
  Event operator()(const replication::MessageReceived& message) const {
    StoredEvent stored = event_of(PEERD_MESSAGE, message.at);
    stored.event.peer = message.by.value;
    stored.name = message.topic;
    stored.text = message.text;
    return stored;
  }
  Event operator()(const replication::DataChanged& data) const {
    StoredEvent stored = event_of(PEERD_DATA, data.at);
    stored.path = path_or_id(scene, data.node);
    stored.name = data.key;
    stored.text = data.value;
    return stored;
  }
  Event operator()(const replication::SceneEdited& edited) const {
    StoredEvent stored = event_of(PEERD_EDIT, edited.at);
    stored.event.operation = {edited.operation.author.value, edited.operation.number};
    if (!edited.refused.empty()) stored.text = edited.refused;
    return stored;
  }
  template <class Other>
  Event operator()(const Other&) const {
    return std::nullopt;
  }
};

}  // namespace

peerd_pose pose_of(const Pose& pose) {
  peerd_pose out{};
  put(pose.position, out.position);
  for (int i = 0; i < 4; ++i) out.orientation[i] = pose.orientation.coeffs()[i];  // x, y, z, w
  return out;
}

Result<std::unique_ptr<EmbeddedPeer>> EmbeddedPeer::open(const PeerOptions& options) {
  const WarnPerson warn = [&options](const std::string& warning) {
    if (options.log_to) options.log_to({LogLevel::kWarning, warning});
  };
  auto peer = OpenedPeer::open(options, warn);
  if (!peer) return std::unexpected(peer.error());
  auto signal = EventSignal::open();
  if (!signal) return std::unexpected(InputError{"error: no signal for events: " + signal.error(), kSystemFailed});
  return std::unique_ptr<EmbeddedPeer>(new EmbeddedPeer(*std::move(peer), *std::move(signal)));
}

EmbeddedPeer::EmbeddedPeer(std::unique_ptr<OpenedPeer> peer, EventSignal signal)
    : peer_(std::move(peer)), signal_(std::move(signal)) {
  peer_->daemon().on_event([this](const replication::Output& output) { note(output); });
  peer_->daemon().begin();
}

EmbeddedPeer::~EmbeddedPeer() {
  hold();
  leave();
  release();
  if (thread_.joinable()) thread_.join();
  [[maybe_unused]] const auto closed = peer_->close();
  assert(closed);  // it has nothing to write
}

// The thread waits in a handler of its own loop until whoever wants the peer has released it. A thread that calls from
// such a handler, as for a line of the log, would wait for itself.
void EmbeddedPeer::hold() {
  door_.lock();
  if (depth_++ > 0 || !thread_.joinable()) return;
  assert(std::this_thread::get_id() != thread_.get_id());
  std::unique_lock lock(mutex_);
  if (has_ended_) return;
  is_wanted_ = true;
  boost::asio::post(peer_->io(), [this] {
    std::unique_lock inside(mutex_);
    waits_ = true;
    changed_.notify_all();
    changed_.wait(inside, [this] { return !is_wanted_; });
    waits_ = false;
    changed_.notify_all();
  });
  changed_.wait(lock, [this] { return waits_ || has_ended_; });
}

void EmbeddedPeer::release() {
  assert(depth_ > 0);
  if (--depth_ == 0 && thread_.joinable()) {
    std::unique_lock lock(mutex_);
    is_wanted_ = false;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !waits_ || has_ended_; });
  }
  door_.unlock();
}

bool EmbeddedPeer::poll(Duration at_most) {
  const bool goes_on = peer_->daemon().poll(at_most);
  if (!goes_on) signal_.raise();
  return goes_on;
}

bool EmbeddedPeer::start() {
  const std::lock_guard inside(door_);
  if (thread_.joinable()) return false;
  thread_ = std::thread([this] {
    while (peer_->daemon().poll(kThreadWaits)) {
    }
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    signal_.raise();
    changed_.notify_all();
  });
  return true;
}

void EmbeddedPeer::leave() {
  peer_->daemon().leave();
  signal_.raise();
}

std::optional<SimTime> EmbeddedPeer::session_now() {
  const auto& clock = node().peer().clock();
  if (!clock.synchronised()) return std::nullopt;
  return clock.to_session(peer_->daemon().now());
}

std::optional<SimTime> EmbeddedPeer::look() {
  const auto now = peer_->node().advance_view(peer_->daemon().now(), looked_at_);
  if (now) looked_at_ = now;
  return now;
}

const std::string& EmbeddedPeer::path_of(ObjectId object) {
  const std::uint64_t changes = node().peer().counters().scene_changes;
  if (std::exchange(paths_of_, changes) != changes) paths_.clear();
  const auto [at, is_new] = paths_.try_emplace(object);
  if (is_new && node().scene().contains(object)) at->second = node().scene().path_of(object);
  return at->second;
}

std::size_t EmbeddedPeer::move(std::span<const peerd_motion> motions) {
  fed_.clear();
  for (const peerd_motion& motion : motions) {
    feed::FedPose& fed = fed_.emplace_back();
    fed.object = path_of(ObjectId::unpacked(motion.object));
    const auto& [position, orientation] = motion.pose;
    fed.pose.position = Vec3(position[0], position[1], position[2]);
    fed.pose.orientation = Quat(orientation[3], orientation[0], orientation[1], orientation[2]);
    const Vec3 velocity(motion.velocity[0], motion.velocity[1], motion.velocity[2]);
    if (!velocity.array().isNaN().any()) fed.pose.velocity = velocity;
    fed.pose.jump = motion.jumps != 0;
  }
  const feed::Outcome outcome = peer_->daemon().on_poses(fed_);
  if (!outcome.refused.empty()) {
    const auto& [object, why] = outcome.refused.back();
    error = "a pose of \"" + object + "\" was refused: " + feed::to_string(why);
  } else if (outcome.taken < motions.size()) {
    error = "this peer has not begun, or has left";
  }
  return outcome.taken;
}

void EmbeddedPeer::note(const replication::Output& output) {
  auto seen = std::visit(EventOf{node().scene()}, output);
  if (!seen) return;
  if (events_.size() >= kEventsMax) {
    events_.pop_front();
    ++lost_;
  }
  if (events_.empty()) signal_.raise();
  events_.push_back(*std::move(seen));
}

std::optional<StoredEvent> EmbeddedPeer::next_event() {
  if (lost_ > 0) {
    StoredEvent lost = event_of(PEERD_EVENTS_LOST);
    lost.event.count = std::exchange(lost_, 0);
    return lost;
  }
  if (events_.empty()) {
    if (!has_left()) signal_.clear();
    return std::nullopt;
  }
  StoredEvent next = std::move(events_.front());
  events_.pop_front();
  return next;
}

}  // namespace peerd::embed
