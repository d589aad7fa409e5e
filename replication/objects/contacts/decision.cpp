#include "replication/objects/contacts/decision.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

constexpr Duration kDecisionGrid = std::chrono::milliseconds(125);
constexpr double kClocksDiffer_s = 1e-3;

// The owner with the greater claim; the lower id where neither is greater.
PeerId by_claim(const Contender& a, const Contender& b, double claim_a, double claim_b) {
  if (claim_a > claim_b) return a.owner;
  if (claim_b > claim_a) return b.owner;
  return decider_by_id(a.owner, b.owner);
}

}  // namespace

PeerId decider_by_id(PeerId owner_a, PeerId owner_b) {
  if (owner_a == kNobody) return owner_b;
  if (owner_b == kNobody) return owner_a;
  return std::min(owner_a, owner_b);
}

PeerId decider(DecisionPolicy policy, const Contender& a, const Contender& b, PeerId server) {
  if (a.owner == kNobody || b.owner == kNobody || a.owner == b.owner) return decider_by_id(a.owner, b.owner);
  if (policy == DecisionPolicy::kServer && server != kNobody) return server;
  if (!a.state || !b.state) return decider_by_id(a.owner, b.owner);
  switch (policy) {
    case DecisionPolicy::kVelocity:
      return by_claim(a, b, a.state->velocity.squaredNorm(), b.state->velocity.squaredNorm());
    case DecisionPolicy::kFieldOfView:
      return by_claim(a, b, a.sees, b.sees);
    case DecisionPolicy::kExpectedError:
      // Each owner knows its own object; its error is in the other's.
      return by_claim(a, b, -expected_error_m(*b.state, a.latency), -expected_error_m(*a.state, b.latency));
    case DecisionPolicy::kId:
    case DecisionPolicy::kServer:
      break;
  }
  return decider_by_id(a.owner, b.owner);
}

double expected_error_m(const KinematicState& other, Duration latency) {
  assert(latency >= Duration{0});
  const double late_s = to_seconds(latency);
  return other.velocity.norm() * kClocksDiffer_s + 0.5 * other.acceleration.norm() * late_s * late_s;
}

SimTime decided_as_of(SimTime contact, Duration lookback) {
  const Duration since = contact.time_since_epoch();
  Duration rest = since % kDecisionGrid;
  if (rest < Duration{0}) rest += kDecisionGrid;
  assert(rest >= Duration{0} && rest < kDecisionGrid);
  return contact - rest - lookback;
}

bool sees(const collision::Camera& camera, const WorldBox& box) {
  const auto frustum = collision::make_frustum(camera);
  if (!frustum) return false;
  collision::PlaneMask active = frustum->all();
  return collision::in_view(*frustum, box, active) != collision::InView::kOutside;
}

}  // namespace peerd::replication
