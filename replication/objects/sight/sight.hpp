#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "collision/query/view_query.hpp"
#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/objects/replica/scene_objects.hpp"
#include "replication/objects/sight/unseen_pairs.hpp"
#include "replication/physics/world/model_in_force.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::replication {

// The views of this peer, and what it leaves uncomputed because none of them shows it (Ohlenburg 2003, section 5.2):
// the contacts of other peers' objects that cannot reach an own one. It advances the two worlds of the replica: what
// comes into sight has been searched since it was put off before advance() returns. The truth is not shown, so views do
// not matter to it.
//
// Besides own objects it keeps right what carries a view of this peer, and what carries a view of another by which
// contacts are decided or updates are ordered here. The server of decisions (DecisionPolicy::kServer) puts nothing off:
// it looks for contacts of all; nor does a peer that shows the past (DisplayDelay, BoundedLatency).
//
// What scene objects do in the truth all peers compute alike, and so does this one; their ghosts answer what remote
// ghosts do, and are treated as these.
class Sight : private Replica::Advancer {
 public:
  // All arguments but `forget` outlive this object. `forget` is called for objects that are shown at once where they
  // are: their ghosts were not computed.
  Sight(const PeerConfig& config, const ModelInForce& model, const Membership& members, const Owners& owners,
        const OwnObjects& own, const SceneObjects& scene, Replica& replica, std::function<void(ObjectId)> forget);
  Sight(const Sight&) = delete;
  Sight& operator=(const Sight&) = delete;

  void look(std::vector<View> views) { views_ = std::move(views); }
  // Part pairs of the ghosts that are put off.
  [[nodiscard]] std::size_t pairs_put_off() const { return ghosts_.pairs.pairs_put_off(); }

 private:
  // One of the worlds.
  struct Half {
    explicit Half(const WorldModel& model) : pairs(model) {}
    UnseenPairs pairs;
    SimTime advanced{};
  };

  [[nodiscard]] Half& half_of(const MotionWorld& world) { return &world == &replica_.truth() ? truth_ : ghosts_; }
  void follow_life();
  [[nodiscard]] UnseenPairs::Standing standing(ObjectId object, bool in_ghosts) const;
  [[nodiscard]] bool is_decided(ObjectId a, ObjectId b) const;
  void place_frusta(SimTime t);
  [[nodiscard]] std::optional<Pose> camera_of(const Viewpoint& viewpoint, SimTime t);
  [[nodiscard]] bool in_sight(const Vec3& center, double radius_m) const;
  bool update(MotionWorld& world, SimTime to, std::optional<ObjectId> awake = {});
  void advance(MotionWorld& world, SimTime to) override;
  void catch_up(MotionWorld& world) override;
  void before_change(ObjectId object) override;
  void compute_ghost(ObjectId object) override;
  void compute_all() override;
  // What the object may have met is found, until the last advance().
  void take_up(MotionWorld& world, ObjectId object);
  void forget_woken(const MotionWorld& world);

  const PeerConfig& config_;
  const ModelInForce& model_;
  const Membership& members_;
  const Owners& owners_;
  const OwnObjects& own_;
  const SceneObjects& scene_;
  Replica& replica_;
  std::function<void(ObjectId)> forget_;
  std::vector<View> views_;
  std::vector<collision::Frustum> frusta_;
  bool sees_all_ = false;          // where some view is nobody knows here
  std::vector<ObjectId> viewing_;  // what carries views, sorted
  Half truth_, ghosts_;
  std::uint64_t life_ = 0, model_revision_ = 0;
};

}  // namespace peerd::replication
