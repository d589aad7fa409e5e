#pragma once
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

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
  // Whether what it knows of pairs is of the model in force.
  [[nodiscard]] bool is_up_to_date() const { return replica_.begun() && followed_ == model_.revision(); }
  // A remote object of which this peer looks for contacts with others, own ones or as the server, or that rests against
  // an own one.
  [[nodiscard]] bool is_partner(ObjectId object) const;
  // Whether it has become a partner, or is none any more, since all its pairs were followed.
  bool note_partner(ObjectId object);
  // Notes which of these pairs this peer looks for contacts of now.
  void note_sought(const PairNumbers& pairs);
  void follow(const PairNumbers& pairs);

  const PeerConfig& config_;
  const ModelInForce& model_;
  const Owners& owners_;
  const SceneObjects& scene_;
  const OwnObjects& own_;
  Replica& replica_;
  std::set<std::pair<ObjectId, ObjectId>> resting_;  // the lower and the higher object of each two
  std::optional<std::uint64_t> followed_;            // the model of which all pairs were followed
  std::vector<bool> is_sought_;                      // by pair: this peer looks for contacts of the two, or they rest
  std::unordered_map<ObjectId, std::uint32_t> sought_of_;  // how many of an object's pairs are sought
  std::set<ObjectId> partners_;                            // when all their pairs were followed last
};

}  // namespace peerd::replication
