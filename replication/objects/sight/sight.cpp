#include "replication/objects/sight/sight.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "replication/physics/laws/composed_motion.hpp"

namespace peerd::replication {

Sight::Sight(const PeerConfig& config, const ModelInForce& model, const Membership& members, const Owners& owners,
             const OwnObjects& own, const SceneObjects& scene, Replica& replica, std::function<void(ObjectId)> forget)
    : config_(config),
      model_(model),
      members_(members),
      owners_(owners),
      own_(own),
      scene_(scene),
      replica_(replica),
      forget_(std::move(forget)),
      views_(config.sight.views),
      truth_(*model),
      ghosts_(*model) {
  const DisplayDelay& delay = config.display_delay;
  const bool shows_the_past = delay.measured || delay.fixed > Duration{0} || config.bounded_latency.is_on();
  if (!config.sight.skip_unseen || config.is_decision_server() || shows_the_past) return;
  replica.advance_by(*this);
}

// The worlds may have begun anew, or go on by another model, of which nothing is put off.
void Sight::follow_life() {
  const bool has_begun = std::exchange(life_, replica_.lives()) != replica_.lives();
  const bool has_changed = std::exchange(model_revision_, model_.revision()) != model_.revision();
  for (Half* const half : {&truth_, &ghosts_}) {
    if (has_changed) half->pairs = UnseenPairs(*model_);
    if (has_begun) half->advanced = replica_.begun_at();
    if (has_begun || has_changed) half->pairs.restart(half->advanced);
  }
}

UnseenPairs::Standing Sight::standing(ObjectId object, bool in_ghosts) const {
  using enum UnseenPairs::Standing;
  if (own_.contains(object) || std::ranges::binary_search(viewing_, object)) return kKept;
  if (owners_.of(object) != kNobody) return kRemote;
  return in_ghosts && scene_.contains(object) ? kFree : kScene;
}

bool Sight::is_decided(ObjectId a, ObjectId b) const {
  const bool a_is_owned = owners_.of(a) != kNobody, b_is_owned = owners_.of(b) != kNobody;
  if (a_is_owned == b_is_owned) return owners_.have_two(a, b);
  return scene_.contains(a_is_owned ? b : a);  // the owner decides
}

// The ghosts of what carries the views of others decide which contacts they see, and what is urgent to them.
void Sight::place_frusta(SimTime t) {
  viewing_.clear();
  frusta_.clear();
  sees_all_ = false;
  const bool others_matter =
      config_.decisions.policy == DecisionPolicy::kFieldOfView || config_.policy.bytes_per_s.has_value();
  if (others_matter) {
    for (const auto& [peer, member] : members_.all()) {
      if (member.viewpoint && member.viewpoint->object) viewing_.push_back(*member.viewpoint->object);
    }
  }
  if (config_.decisions.viewpoint && config_.decisions.viewpoint->object) {
    viewing_.push_back(*config_.decisions.viewpoint->object);
  }
  for (const auto& [viewpoint, far_m] : views_) {
    const std::optional<Pose> from = camera_of(viewpoint, t);
    if (!from) {
      sees_all_ = true;
      continue;
    }
    auto frustum = collision::make_frustum({*from, viewpoint.field_of_view, viewpoint.aspect, 0.0, far_m});
    if (frustum) {
      frusta_.push_back(*std::move(frustum));
    } else {
      sees_all_ = true;
    }
  }
  std::ranges::sort(viewing_);
}

// Where the viewpoint's camera is: its object goes with the nearest node above that moves here. None: nobody knows
// where that is. What carries the camera is noted.
std::optional<Pose> Sight::camera_of(const Viewpoint& viewpoint, SimTime t) {
  const Scene& scene = *model_->scene;
  if (viewpoint.object && !scene.contains(*viewpoint.object)) return std::nullopt;
  std::optional<ObjectId> mover = viewpoint.object;
  while (mover && !replica_.ghosts().has(*mover)) {
    mover = scene.parent_of(*mover);
  }
  const auto in = [](const Pose& frame, const Pose& pose) {
    return Pose{frame * pose.position, (frame.orientation * pose.orientation).normalized()};
  };
  Pose camera = viewpoint.pose;
  if (mover != viewpoint.object) {  // the file says how the object stands in what moves it
    camera = in(scene.rigid_pose(*viewpoint.object), camera);
    if (mover) camera = relative_to(at_rest(scene.rigid_pose(*mover)), at_rest(camera)).pose();
  }
  if (!mover) return camera;
  assert(scene.is_within(*viewpoint.object, *mover));
  viewing_.push_back(*mover);
  if (!replica_.receives(*mover)) return std::nullopt;
  const MotionWorld& drawn = own_.contains(*mover) ? replica_.truth() : replica_.ghosts();
  return in(drawn.at(*mover, t).pose(), camera);
}

bool Sight::in_sight(const Vec3& center, double radius_m) const {
  if (sees_all_) return true;
  const WorldBox box{center.array() - radius_m, center.array() + radius_m};
  return std::ranges::any_of(frusta_, [&](const collision::Frustum& frustum) {
    collision::PlaneMask active = frustum.all();
    if (collision::in_view(frustum, box, active) == collision::InView::kOutside) return false;
    for (std::size_t i = 0; i < frustum.count(); ++i) {  // a box reaches farther than the ball in it
      const double size = center.norm() + std::abs(frustum[i].offset_m);
      if (frustum[i].normal.dot(center) + frustum[i].offset_m < -radius_m - 0x1p-48 * size) return false;
    }
    return true;
  });
}

bool Sight::update(MotionWorld& world, SimTime to, std::optional<ObjectId> awake) {
  const bool shown = &world == &replica_.ghosts();
  place_frusta(to);
  UnseenPairs::Peer peer{[this, shown](ObjectId object) { return standing(object, shown); },
                         [this](ObjectId a, ObjectId b) { return is_decided(a, b); }, nullptr, 0.0};
  if (shown) {
    peer.in_sight = [this](const Vec3& center, double radius_m) { return in_sight(center, radius_m); };
  } else if (config_.policy.track_proximity) {
    peer.ahead_s = config_.policy.close_proximity_s;
  }
  assert(shown || &world == &replica_.truth());
  const bool taken_up = half_of(world).pairs.update(world, to, peer, awake);
  forget_woken(world);
  return taken_up;
}

void Sight::forget_woken(const MotionWorld& world) {
  const bool shown = &world == &replica_.ghosts();
  half_of(world).pairs.take_woken([&](ObjectId object) {
    if (shown && world.has(object)) forget_(object);
  });
}

void Sight::advance(MotionWorld& world, SimTime to) {
  assert(replica_.begun());
  follow_life();
  Half& half = half_of(world);
  if (to > half.advanced) static_cast<void>(update(world, to));
  half.advanced = std::max(half.advanced, to);
  do {
    world.advance(half.advanced);
  } while (update(world, to));
}

// A base in the past may have put own objects on another way: what they may have met there is searched first.
void Sight::catch_up(MotionWorld& world) {
  follow_life();
  const SimTime until = half_of(world).advanced;
  static_cast<void>(update(world, until));
  do {
    world.catch_up();
  } while (update(world, until));
}

void Sight::before_change(ObjectId object) {
  if (!replica_.begun()) return;
  follow_life();
  for (MotionWorld* const world : {&replica_.truth(), &replica_.ghosts()}) {
    if (world->has(object) && half_of(*world).pairs.others_depend_on(*world, object)) take_up(*world, object);
  }
}

void Sight::take_up(MotionWorld& world, ObjectId object) {
  const SimTime until = half_of(world).advanced;
  assert(replica_.begun() && world.has(object));
  while (update(world, until, object)) world.advance(until);
}

void Sight::compute_ghost(ObjectId object) {
  if (!replica_.begun()) return;
  follow_life();
  if (ghosts_.pairs.is_in_doubt(object)) take_up(replica_.ghosts(), object);
}

void Sight::compute_all() {
  if (!replica_.begun()) return;
  follow_life();
  for (MotionWorld* const world : {&replica_.truth(), &replica_.ghosts()}) {
    Half& half = half_of(*world);
    if (half.pairs.take_up_all(*world)) world->advance(half.advanced);
    forget_woken(*world);
  }
}

}  // namespace peerd::replication
