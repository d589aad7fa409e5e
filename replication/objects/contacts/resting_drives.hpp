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

// RestingDrives knows the accelerations that drive two objects that rest against each other, from the contact on.
//
// A decision says it by what its author knew, and the author may not have had the other owner's last update. What
// drives an object its owner alone says, in its updates, and no decision changes it. So of an object that is not the
// author's, the last update counts that says what drove it at the contact, whenever that update comes: then all peers
// solve the contact by the same two accelerations. All accelerations here are in the world frame [m/s^2].
class RestingDrives {
 public:
  // Both outlive this object.
  RestingDrives(const Owners& owners, Replica& replica) : owners_(owners), replica_(replica) {}

  // Returns the drive that an update states; none: it states none. An exact update of an object that nothing bears
  // states it by its law.
  [[nodiscard]] std::optional<Drive> in(const UpdateRecord& update) const;
  // Returns the drive of the object at t by the last update that states one; with `before_sequence`, by the last one of
  // a lower number. None: no update does.
  [[nodiscard]] std::optional<Vec3> published(ObjectId object, SimTime t,
                                              std::optional<std::uint32_t> before_sequence) const;
  // Returns the drive of the object at the contact, by the decision, in which the two rest, and those updates.
  [[nodiscard]] Vec3 after(const DecisionRecord& decision, PeerId author, ObjectId object,
                           std::optional<std::uint32_t> before_sequence = {}) const;
  // How the object rests against the other one after the decision; none: the two part, or go on as they are.
  [[nodiscard]] std::optional<Rest> rest_of(const DecisionLog::Entry& decision, ObjectId object) const;

 private:
  const Owners& owners_;
  Replica& replica_;
};

}  // namespace peerd::replication
