#include "replication/physics/laws/response.hpp"

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
  if (!by_impulse(&m.response) || m.other_side != OtherSide::kAnswers || !by_impulse(m.other_response)) return 1.0;
  return m.other_response->mass_kg / (m.response.mass_kg + m.other_response->mass_kg);
}

double restitution(const ContactSide& m) {
  const double own = m.response.restitution;
  return by_impulse(m.other_response) ? std::min(own, m.other_response->restitution) : own;
}

double friction(const CollisionResponse* response) { return by_impulse(response) ? response->friction_m_s2 : 0.0; }

// The velocity of the other as this side's response sees it. One that responds in a way of its own turns itself.
Vec3 velocity_of_other(const ContactSide& m) {
  const bool shared = m.other_side == OtherSide::kAnswers && by_impulse(&m.response) && by_impulse(m.other_response);
  return m.other_side == OtherSide::kGoesOn || shared ? m.other.velocity : Vec3(Vec3::Zero());
}

// An object that would slide for less than kShortestFlight_s stands: the one that pushes it would meet it again without
// end.
MotionModel slide(const KinematicState& after, double friction_m_s2) {
  KinematicState state = after;
  if (state.velocity.norm() < friction_m_s2 * kShortestFlight_s) state.velocity.setZero();
  return sliding_to_rest(state, friction_m_s2);
}

}  // namespace

KinematicState respond(const ContactSide& m) {
  assert(std::abs(m.n.norm() - 1.0) < 1e-9);
  KinematicState after = m.self;
  const double approach = std::min(0.0, m.n.dot(m.self.velocity - velocity_of_other(m)));
  switch (m.response.type) {
    case ResponseType::kInverse:
      after.velocity -= 2.0 * approach * m.n;
      break;
    case ResponseType::kZero:
      after.velocity.setZero();
      after.acceleration.setZero();
      after.angular_velocity_body.setZero();
      break;
    case ResponseType::kImpulse:
      after.velocity -= (1.0 + restitution(m)) * share(m) * approach * m.n;
      break;
  }
  return after;
}

bool comes_to_rest(double parting_speed_m_s, double acceleration_m_s2, double shortest_flight_s) {
  return acceleration_m_s2 < 0.0 && 2.0 * parting_speed_m_s < -acceleration_m_s2 * shortest_flight_s;
}

MotionModel law_after(const CollisionResponse* response, const MotionModel& law, const KinematicState& after) {
  const double by = friction(response);
  if (law.kind == MotionKind::kSliding) {
    MotionModel out = slide(after, by > 0.0 ? by : law.state.acceleration.norm());
    out.angular_acceleration_body = law.angular_acceleration_body;
    return out;
  }
  if (by > 0.0 && after.acceleration.isZero(0.0)) return slide(after, by);
  return after;
}

MotionModel law_of_outcome(const CollisionResponse* response, const KinematicState& after) {
  const double by = friction(response);
  if (by == 0.0) return after;
  const MotionModel slides = sliding_to_rest(after, by);
  return slides.state.acceleration == after.acceleration ? slides : MotionModel(after);
}

}  // namespace peerd::replication
