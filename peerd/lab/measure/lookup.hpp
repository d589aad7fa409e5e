#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "peerd/lab/measure/run_record.hpp"

namespace peerd::measure {

// A peer's name; "#7" for a number that the record does not name.
[[nodiscard]] std::string peer_name(const RunRecord& run, PeerId peer);

// An object's path; "#17" for one that the record does not name.
[[nodiscard]] std::string object_path(const RunRecord& run, ObjectId object);

// The samples of one observer's ghost of one object, in order of time.
[[nodiscard]] std::span<const GhostSample> ghost_samples_of(const RunRecord& run, PeerId observer, ObjectId object);

// Whether the peer was in the session at that time.
[[nodiscard]] bool was_present(const PeerInfo& peer, double t_s);

// Whether two contacts of one pair let the collider out on the same side. The response reflects the velocity at the
// normal, so the side is the outcome: normals agree where their dot product is positive. A row that names the pair the
// other way round has its normal turned round. Contacts without a normal (BOX) agree with each other.
[[nodiscard]] bool same_side(const ContactRow& a, const ContactRow& b);

// The distance from the truth to the ghost [m].
[[nodiscard]] inline double ghost_error_m(const GhostSample& s) { return (s.ghost.position - s.truth.position).norm(); }
// The distance between what is displayed at the observer and at the owner [m].
[[nodiscard]] inline double view_difference_m(const GhostSample& s) {
  return (s.shown.position - s.seen.position).norm();
}
[[nodiscard]] inline double shown_error_m(const GhostSample& s) { return (s.shown.position - s.truth.position).norm(); }

}  // namespace peerd::measure
