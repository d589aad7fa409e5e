#include "replication/response.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::replication {

KinematicState respond(ResponseType type, const KinematicState& self, const KinematicState& other, bool other_answers,
                       const Vec3& n) {
  assert(std::abs(n.norm() - 1.0) < 1e-9);
  KinematicState after = self;
  switch (type) {
    case ResponseType::kInverse: {
      const Vec3 seen_from = other_answers ? Vec3::Zero() : other.velocity;
      after.velocity -= 2.0 * std::min(0.0, n.dot(self.velocity - seen_from)) * n;
      break;
    }
    case ResponseType::kZero:
      after.velocity.setZero();
      after.acceleration.setZero();
      after.angular_velocity_body.setZero();
      break;
  }
  return after;
}

KinematicState rest_against(const KinematicState& self, const KinematicState& other, const Vec3& n) {
  KinematicState after = self;
  after.velocity -= std::min(0.0, n.dot(self.velocity - other.velocity)) * n;
  after.acceleration -= std::min(0.0, n.dot(self.acceleration - other.acceleration)) * n;
  return after;
}

}  // namespace peerd::replication
