#include "core/animation/segment.hpp"

#include "core/animation/spherical_interpolation.hpp"

namespace peerd::animation {

Vec3 Segment::position_at(double t) const { return is_constant ? position : position + (t - begin_s) * velocity; }

Quat Segment::orientation_at(double t) const {
  return is_constant ? orientation : rotated_in_body_frame(orientation, (t - begin_s) * angular_velocity_body);
}

}  // namespace peerd::animation
