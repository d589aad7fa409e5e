#pragma once
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The decisions that a peer knows, its own and others'. What stands is a function of the set of them, whatever order
// they came in and however often: peers that have heard the same hold the same outcomes.
//
// Two decisions on one pair conflict if they are of different peers, their contacts lie within kSameCollision, and
// neither peer knew of the other's. Then the one by the policy stands against the one by fallback, else that of the
// lower id.
class DecisionLog {
 public:
  static constexpr Duration kSameCollision = std::chrono::seconds(1);

  struct Entry {
    DecisionRecord record;
    PeerId author;
    bool in_force = false;
    // Of our own: how often still to be sent, the numbers of the datagrams that carried it (since somebody last forgot
    // all), who has one of them.
    int copies = 0;
    std::vector<std::uint32_t> sent_in;
    std::set<PeerId> acknowledged_by;
  };
  struct Change {
    DecisionRecord record;
    PeerId author;
    bool in_force;  // false: it did, until now
  };

  // What is different now, those that no longer stand first. None: it is known already.
  std::optional<std::vector<Change>> add(const DecisionRecord& record, PeerId author);
  // That peer's decision on exactly that contact of the two; null where none is known.
  [[nodiscard]] const Entry* find(SimTime contact, PeerId author, ObjectId a, ObjectId b) const;
  [[nodiscard]] Entry* find(SimTime contact, PeerId author, ObjectId a, ObjectId b);
  // Of that peer's on the two.
  [[nodiscard]] std::size_t count(PeerId author, ObjectId a, ObjectId b) const;
  void forget_before(SimTime contact);
  void clear() { entries_.clear(); }

  // Contact time of the last decision that stands on an object, or on a pair; none: SimTime{}.
  [[nodiscard]] SimTime last(ObjectId object) const;
  [[nodiscard]] SimTime last(ObjectId a, ObjectId b) const;
  // Whether a decision on the object at that contact time is known and does not stand.
  [[nodiscard]] bool overruled(ObjectId object, SimTime contact) const;

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }  // by contact time, then author
  [[nodiscard]] std::vector<Entry>& entries() { return entries_; }

 private:
  std::vector<Entry> entries_;
};

[[nodiscard]] bool of_pair(const DecisionRecord& record, ObjectId a, ObjectId b);

}  // namespace peerd::replication
