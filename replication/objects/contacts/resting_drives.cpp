#include "replication/objects/contacts/resting_drives.hpp"

#include <cassert>
#include <ranges>

namespace peerd::replication {

std::optional<Drive> RestingDrives::in(const UpdateRecord& u) const {
  if (u.drive) return Drive{*replica_.base_of(u).free, u.drive->since};
  if (u.position_step_log2) return std::nullopt;
  if (u.model.kind == MotionKind::kSliding) return Drive{Vec3::Zero(), u.at};
  if (u.model.kind != MotionKind::kSecond) return std::nullopt;
  const Vec3& a = u.model.state.acceleration;
  return Drive{u.carrier ? Vec3(replica_.ghost(*u.carrier, u.at).orientation * a) : a, u.at};
}

std::optional<Vec3> RestingDrives::published(ObjectId object, SimTime t,
                                             std::optional<std::uint32_t> before_sequence) const {
  for (const UpdateRecord& u : std::views::reverse(replica_.kept_updates(object))) {
    assert(u.object == object);
    if (before_sequence && u.sequence >= *before_sequence) continue;
    const std::optional<Drive> drive = in(u);
    if (drive && drive->since <= t) return drive->acceleration;
  }
  return std::nullopt;
}

Vec3 RestingDrives::after(const DecisionRecord& d, PeerId author, ObjectId object,
                          std::optional<std::uint32_t> before_sequence) const {
  assert(d.rests);
  assert(object == d.collider || object == d.collidee);
  if (owners_.of(object) != author) {
    if (const auto by_owner = published(object, d.contact, before_sequence)) return *by_owner;
  }
  return object == d.collider ? d.collider_free.value_or(d.collider_before.acceleration)
                              : d.collidee_free.value_or(d.collidee_before.acceleration);
}

std::optional<Rest> RestingDrives::rest_of(const DecisionLog::Entry& e, ObjectId object) const {
  const DecisionRecord& d = e.record;
  if (!d.rests) return std::nullopt;
  const bool is_collider = object == d.collider;
  const ObjectId partner = is_collider ? d.collidee : d.collider;
  return Rest{partner, is_collider ? d.normal : Vec3(-d.normal), after(d, e.author, object),
              after(d, e.author, partner)};
}

}  // namespace peerd::replication
