#pragma once
#include "replication/physics/laws/motion_model.hpp"
#include "replication/settings/policy/publish_policy.hpp"
#include "replication/wire/record.hpp"

namespace peerd::replication {

// The tolerances by which an update's position and orientation may be rounded, by the tightest threshold in force.
// `threshold_m`: in force for the object; `expected_error_m`: of the model before the next update;
// `bounding_radius_m`: of the object's farthest vertex, 0 where errors count by its origin.
[[nodiscard]] Tolerance rounding_tolerance(const PublishPolicy& policy, double threshold_m, double bounding_radius_m,
                                           MotionKind kind, double expected_error_m);

}  // namespace peerd::replication
