#pragma once
#include "core/transform.hpp"

namespace peerd::collision {

// Takes points of B's rigid frame to A's. The vertices that exact queries are about are A's as they are, and B's as
// operator() rounds them: each operation an IEEE one of binary64, in the order written, none fused.
struct RelativeMotion {
  Mat3 rotation;     // of the quaternion conjugate(qa) * qb: exactly the identity where qa == qb
  Vec3 translation;  // transpose(matrix(qa)) * (pb - pa)

  RelativeMotion(const Pose& a, const Pose& b)
      : rotation(multiply(a.orientation.conjugate(), b.orientation).toRotationMatrix()),
        translation(multiply(Mat3(a.orientation.toRotationMatrix().transpose()), Vec3(b.position - a.position))) {}

  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return multiply(rotation, p) + translation; }
};

}  // namespace peerd::collision
