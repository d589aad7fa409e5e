#include "replication/motion/response.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::replication {
namespace {

bool by_impulse(const CollisionResponse* response) {
  return response != nullptr && response->type == ResponseType::kImpulse;
}

// The part of this object in what the two have to change together, in [0, 1].
double share(const ContactSide& m) {
  if (!by_impulse(&m.response) || !m.other_responds || !by_impulse(m.other_response)) return 1.0;
  return m.other_response->mass_kg / (m.response.mass_kg + m.other_response->mass_kg);
}

double restitution(const ContactSide& m) {
  const double own = m.response.restitution;
  return by_impulse(m.other_response) ? std::min(own, m.other_response->restitution) : own;
}

// The speed along n at which the two part [m/s]; negative where they approach.
double parting_speed(const ContactSide& m) { return m.n.dot(m.self.velocity - m.other.velocity); }

double friction(const CollisionResponse* response) { return by_impulse(response) ? response->friction_m_s2 : 0.0; }

}  // namespace

KinematicState respond(const ContactSide& m) {
  assert(std::abs(m.n.norm() - 1.0) < 1e-9);
  KinematicState after = m.self;
  switch (m.response.type) {
    case ResponseType::kInverse: {
      const Vec3 seen_from = m.other_responds ? Vec3::Zero() : m.other.velocity;
      after.velocity -= 2.0 * std::min(0.0, m.n.dot(m.self.velocity - seen_from)) * m.n;
      break;
    }
    case ResponseType::kZero:
      after.velocity.setZero();
      after.acceleration.setZero();
      after.angular_velocity_body.setZero();
      break;
    case ResponseType::kImpulse:
      after.velocity -= (1.0 + restitution(m)) * share(m) * std::min(0.0, parting_speed(m)) * m.n;
      break;
  }
  return after;
}

KinematicState come_to_rest_against(const ContactSide& m, bool pressed) {
  assert(std::abs(m.n.norm() - 1.0) < 1e-9);
  KinematicState after = m.self;
  const bool turns = !m.self.angular_velocity_body.isZero(0.0) || !m.other.angular_velocity_body.isZero(0.0);
  // Two objects that do not respond by impulse don't share what they change, and where a body turns, the speed of its
  // centre is not that of the contact.
  const bool stops = pressed && !turns && (!m.other_responds || share(m) < 1.0);
  const double speed = parting_speed(m);
  after.velocity -= share(m) * (stops ? speed : std::min(0.0, speed)) * m.n;
  after.acceleration -= share(m) * std::min(0.0, m.n.dot(m.self.acceleration - m.other.acceleration)) * m.n;
  return after;
}

MotionModel law_after(const CollisionResponse* response, const MotionModel& law, const KinematicState& after) {
  const double by = friction(response);
  if (law.kind == MotionKind::kSliding) {
    MotionModel out = sliding_to_rest(after, by > 0.0 ? by : law.state.acceleration.norm());
    out.angular_acceleration_body = law.angular_acceleration_body;
    return out;
  }
  if (by > 0.0 && after.acceleration.isZero(0.0)) return sliding_to_rest(after, by);
  return after;
}

MotionModel law_of_outcome(const CollisionResponse* response, const KinematicState& after) {
  const double by = friction(response);
  if (by == 0.0) return after;
  const MotionModel slides = sliding_to_rest(after, by);
  return slides.state.acceleration == after.acceleration ? slides : MotionModel(after);
}

}  // namespace peerd::replication
