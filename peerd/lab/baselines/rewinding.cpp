#include "peerd/lab/baselines/rewinding.hpp"

#include <algorithm>

#include "collision/contact/contact_time.hpp"
#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::baselines {
namespace {

constexpr Duration kRemembered = std::chrono::seconds(10);

}  // namespace

void Rewinding::note(ObjectId object, SimTime t, const Pose& pose) {
  auto& poses = history_[object];
  poses.insert_or_assign(t, pose);
  poses.erase(poses.begin(), poses.lower_bound(t - kRemembered));
}

Pose Rewinding::pose(ObjectId object, SimTime t) const {
  const auto& poses = history_.at(object);
  const auto after = poses.upper_bound(t);
  if (after == poses.begin()) return after->second;
  const auto before = std::prev(after);
  if (after == poses.end()) return before->second;
  const double s = to_seconds(t - before->first) / to_seconds(after->first - before->first);
  return {before->second.position + s * (after->second.position - before->second.position),
          before->second.orientation.slerp(s, after->second.orientation)};
}

std::vector<replication::ContactEvent> Rewinding::contacts(ObjectId object, const KinematicState& state, SimTime at,
                                                           double dt_s, SimTime seen) {
  std::vector<replication::ContactEvent> found;
  const collision::Body* const body = model_.body(object);
  for (const std::uint32_t number : model_.pairs_of(object)) {
    const replication::CollisionPair& pair = model_.pairs[number];
    const bool is_collider = pair.collider == object;
    const ObjectId other = is_collider ? pair.collidee : pair.collider;
    const collision::Body* const other_body = model_.body(other);
    if (body == nullptr || other_body == nullptr || !history_.contains(other)) continue;
    const Pose from = pose(other, seen), to = pose(other, seen + from_seconds(dt_s));
    KinematicState other_state = at_rest(from);
    other_state.velocity = (to.position - from.position) / dt_s;
    other_state.angular_velocity_body = motion::turn_between(from.orientation, to.orientation) / dt_s;
    const collision::MovingBody mine{*body, state}, theirs{*other_body, other_state};
    const auto key = std::minmax(object, other);
    if (const auto touching = touching_.find(key); touching != touching_.end()) {
      if (touching->second != object || collision::touching(mine, theirs, pair.type)) continue;
      touching_.erase(touching);
    }
    const collision::Contact contact = is_collider ? collision::first_contact(mine, theirs, pair.type, dt_s)
                                                   : collision::first_contact(theirs, mine, pair.type, dt_s);
    const bool meets =
        contact.state == collision::ContactState::kContact || contact.state == collision::ContactState::kOverlapped;
    if (meets) touching_.emplace(key, object);
    if (contact.state != collision::ContactState::kContact) continue;
    replication::ContactEvent event;
    event.at = at + from_seconds(contact.time_s);
    event.collider = pair.collider;
    event.collidee = pair.collidee;
    event.normal = contact.normal_world;
    event.type = pair.type;
    event.collider_before = event.collider_after = advance(is_collider ? state : other_state, contact.time_s);
    event.collidee_before = event.collidee_after = advance(is_collider ? other_state : state, contact.time_s);
    found.push_back(event);
  }
  return found;
}

}  // namespace peerd::baselines
