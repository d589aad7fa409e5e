#include "engine.hpp"

#include <cmath>

namespace engine {
namespace {

constexpr double kGravity = 9.81;     // [m/s^2]
constexpr double kRestitution = 0.9;  // of the floor and of balls
constexpr double kRestsBelow = 0.2;   // [m/s]: slower than this a ball does not bounce any more

void stand_on_floor(Body& body) {
  double& height = body.position[1];
  if (height > body.radius_m || body.velocity[1] > 0.0) return;
  height = body.radius_m;
  const double speed = -body.velocity[1];
  body.velocity[1] = speed < kRestsBelow ? 0.0 : kRestitution * speed;
}

// Balls of this engine bounce off each other. Those of others do not take part: what happens between an own ball and
// one of another peer both peers have to agree on, so the bridge asks peerd.
void bounce(Body& a, Body& b) {
  if (a.kinematic || b.kinematic) return;
  Vector normal{};
  double distance = 0.0, closing = 0.0;
  for (int i = 0; i < 3; ++i) normal[i] = a.position[i] - b.position[i];
  for (const double n : normal) distance += n * n;
  distance = std::sqrt(distance);
  if (distance == 0.0 || distance > a.radius_m + b.radius_m) return;
  for (double& n : normal) n /= distance;
  for (int i = 0; i < 3; ++i) closing -= normal[i] * (a.velocity[i] - b.velocity[i]);
  if (closing <= 0.0) return;
  const double impulse = (1.0 + kRestitution) * closing / (1.0 / a.mass_kg + 1.0 / b.mass_kg);
  for (int i = 0; i < 3; ++i) {
    a.velocity[i] += impulse / a.mass_kg * normal[i];
    b.velocity[i] -= impulse / b.mass_kg * normal[i];
  }
}

}  // namespace

void World::step() {
  for (Body& body : bodies_) {
    body.before = body.position;
    if (!body.kinematic) body.velocity[1] -= kGravity * kStep_s;
    for (int i = 0; i < 3; ++i) body.position[i] += body.velocity[i] * kStep_s;
    if (!body.kinematic) stand_on_floor(body);
  }
  for (auto a = bodies_.begin(); a != bodies_.end(); ++a) {
    for (auto b = std::next(a); b != bodies_.end(); ++b) bounce(*a, *b);
  }
}

}  // namespace engine
