#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/ids.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/objects/replica/scene_objects.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::replication {

// Which contacts this peer looks for, by who owns and receives their objects. The truth watches what this peer finds.
// Ghosts are watched wherever they may meet something, own ones included: the sender must know what every receiver
// predicts, or a predicted collision would cost an update. Objects that this peer does not receive meet nothing.
class ContactWatch {
 public:
  // All arguments outlive this object.
  ContactWatch(const PeerConfig& config, const ModelInForce& model, const Owners& owners, const SceneObjects& scene,
               const OwnObjects& own, Replica& replica)
      : config_(config), model_(model), owners_(owners), scene_(scene), own_(own), replica_(replica) {}

  // These do nothing before the replica has begun. Each says which pairs may be watched otherwise now: all of them,
  // those of an object, or what follows from other owners of these objects.
  void follow_all();
  void follow(ObjectId object);
  void follow_owners_of(std::span<const ObjectId> objects);

  // Whether this peer looks for contacts of the two.
  [[nodiscard]] bool searches(ObjectId a, ObjectId b) const;
  // Whether one of the two is this peer's, and the other one's owner alone looks for their contacts.
  [[nodiscard]] bool leaves(ObjectId a, ObjectId b) const;
  // Whether two whose contacts this peer leaves to the other owner rest against each other, by that owner's last
  // decision. A resting contact is solved here all the same.
  [[nodiscard]] bool rests(ObjectId a, ObjectId b) const { return resting_.contains(std::minmax(a, b)); }
  void set_rests(ObjectId a, ObjectId b, bool on);
  void forget_rests_of(ObjectId object);
  void forget_rests() { resting_.clear(); }

 private:
  // All that decides who looks for an object's contacts.
  struct Standing {
    bool is_own = false;
    PeerId owner = kNobody;
    friend auto operator<=>(const Standing&, const Standing&) = default;
  };
  // How many ends of a group have a standing, on each side.
  struct GroupSides {
    std::map<Standing, std::uint32_t> colliders, collidees;
  };

  // Whether what it knows of pairs is of the model in force.
  [[nodiscard]] bool is_up_to_date() const { return replica_.begun() && followed_ == model_.revision(); }
  [[nodiscard]] Standing standing_of(ObjectId object) const { return {own_.contains(object), owners_.of(object)}; }
  [[nodiscard]] bool searches(const Standing& a, const Standing& b) const;
  // A remote object of which this peer looks for contacts with others, own ones or as the server, or that rests against
  // an own one.
  [[nodiscard]] bool is_partner(ObjectId object) const;
  // Whether it has become a partner, or is none any more, since it was asked last.
  bool note_partner(ObjectId object);
  // Notes for which of the object's listed pairs this peer looks for contacts now.
  void note_sought(ObjectId object);
  void note_sought(std::uint32_t number, const CollisionPair& pair);
  // Notes the object's standing in its groups. Returns whether others may be partners because of it, or no more.
  bool note_standing(ObjectId object);
  void forget_ended_rests();
  [[nodiscard]] bool is_watched_in_truth(const CollisionPair& pair) const;
  [[nodiscard]] bool is_watched_in_ghosts(const CollisionPair& pair) const;
  // Both worlds ask again which pairs of the object are watched.
  void watch_anew(ObjectId object);

  const PeerConfig& config_;
  const ModelInForce& model_;
  const Owners& owners_;
  const SceneObjects& scene_;
  const OwnObjects& own_;
  Replica& replica_;
  std::set<std::pair<ObjectId, ObjectId>> resting_;  // the lower and the higher object of each two
  std::optional<std::uint64_t> followed_;            // the model of which all pairs were followed
  std::unordered_set<std::uint32_t>
      sought_;  // the pairs of no group of which this peer looks for contacts, or that rest
  std::unordered_map<ObjectId, std::uint32_t> sought_of_;  // how many of those an object has
  std::unordered_map<ObjectId, Standing> standings_;       // of the ends of groups, as `sides_` counts them
  std::unordered_map<const PairGroup*, GroupSides> sides_;
  std::set<ObjectId> partners_;
};

}  // namespace peerd::replication
