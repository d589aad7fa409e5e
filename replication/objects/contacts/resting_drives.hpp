#pragma once
#include <cstdint>
#include <optional>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/time.hpp"
#include "replication/objects/contacts/decision_log.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// What drives two objects that rest against each other, from the contact on.
//
// A decision says it by what its author knew, and the author may not have had the other owner's last update. What
// drives an object its owner alone says, in its updates, and no decision changes it. So of an object that is not the
// author's, the last update counts that says what drove it at the contact, whenever that update comes: then all peers
// solve the contact by the same two accelerations. All accelerations here are in the world frame [m/s^2].
class RestingDrives {
 public:
  // Both outlive this object.
  RestingDrives(const Owners& owners, Replica& replica) : owners_(owners), replica_(replica) {}

  // What an update says of it; none: nothing. What physics moves is published exactly, by its law where nothing bears
  // it.
  [[nodiscard]] std::optional<Drive> in(const UpdateRecord& update) const;
  // What drives the object at t, by the last update that says so, or the last one before that number. None: no update
  // does.
  [[nodiscard]] std::optional<Vec3> published(ObjectId object, SimTime t,
                                              std::optional<std::uint32_t> before_sequence) const;
  // What drives the object at the contact, by the decision and those updates. The decision says that the two rest.
  [[nodiscard]] Vec3 after(const DecisionRecord& decision, PeerId author, ObjectId object,
                           std::optional<std::uint32_t> before_sequence = {}) const;
  // How the object rests against the other one after the decision; none: the two part, or go on as they are.
  [[nodiscard]] std::optional<Rest> rest_of(const DecisionLog::Entry& decision, ObjectId object) const;

 private:
  const Owners& owners_;
  Replica& replica_;
};

}  // namespace peerd::replication
