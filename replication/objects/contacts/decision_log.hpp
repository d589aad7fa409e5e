#pragma once
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "core/scene/scene.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The decisions that a peer knows, its own and those of other peers. Which of them are in force is a function of the
// set of them, whatever order they came in and however often: peers with the same decisions have the same outcomes.
//
// Two decisions on one pair conflict if they are of different peers, their contacts lie within kSameCollision, and
// neither peer knew of the other's; on one instant they always do, as that has one outcome. Then the one by the policy
// overrules the one by fallback; otherwise that of the lower id is in force.
class DecisionLog {
 public:
  static constexpr Duration kSameCollision = std::chrono::seconds(1);

  struct Entry {
    DecisionRecord record;
    PeerId author;
    bool in_force = false;
    // For decisions of this peer: the interest's type, the copies still to be sent, the numbers of the datagrams that
    // carried it (since a member last forgot all), and the members that have acknowledged one of them.
    std::optional<CollisionType> type{};
    int copies = 0;
    std::vector<std::uint32_t> sent_in;
    std::set<PeerId> acknowledged_by;
  };
  struct Change {
    DecisionRecord record;
    PeerId author;
    bool in_force;  // false: it was in force until now
  };

  // Adds a decision and returns the changes, those that are no longer in force first. None: the decision is known
  // already.
  std::optional<std::vector<Change>> add(const DecisionRecord& record, PeerId author);
  // The decision of that peer on exactly that contact of the two; null where none is known.
  [[nodiscard]] const Entry* find(SimTime contact, PeerId author, ObjectId a, ObjectId b) const;
  [[nodiscard]] Entry* find(SimTime contact, PeerId author, ObjectId a, ObjectId b);
  // Whether the decision of another peer on exactly that contact of the two, by that rule, is in force.
  [[nodiscard]] bool is_decided_by_another(SimTime contact, PeerId author, ObjectId a, ObjectId b,
                                           DecisionRule rule) const;
  // Whether that peer has decided a contact of one of the two with something else at that instant.
  [[nodiscard]] bool has_another(SimTime contact, PeerId author, ObjectId a, ObjectId b) const;
  // The contact time of the last decision in force on the object from before that time; SimTime{}: none.
  [[nodiscard]] SimTime last_before(ObjectId object, SimTime contact) const;
  // The number of decisions of that peer on the two.
  [[nodiscard]] std::size_t count(PeerId author, ObjectId a, ObjectId b) const;
  void forget_before(SimTime contact);
  void forget(ObjectId object);
  void clear() { entries_.clear(); }

  // The contact time of the last decision in force on an object, or on a pair; SimTime{} where there is none.
  [[nodiscard]] SimTime last(ObjectId object) const;
  [[nodiscard]] SimTime last(ObjectId a, ObjectId b) const;
  // The last decision in force that moves the object; null where there is none.
  [[nodiscard]] const Entry* last_entry(ObjectId object) const;
  // Whether a decision on the object at that contact time is known and overruled.
  [[nodiscard]] bool overruled(ObjectId object, SimTime contact) const;

  [[nodiscard]] const std::vector<Entry>& entries() const {
    return entries_;
  }  // in order of contact time, author, pair
  [[nodiscard]] std::vector<Entry>& entries() { return entries_; }

 private:
  std::vector<Entry> entries_;
};

[[nodiscard]] bool of_pair(const DecisionRecord& record, ObjectId a, ObjectId b);

}  // namespace peerd::replication
