#pragma once
#include <cmath>
#include <cstdint>

#include "tests/replication/peer/worlds.hpp"

// Bodies that bounce without loss, a great many times.
namespace peerd::stress {

// Each bounce may round the energy once or twice, either way: a million add up to far less.
inline constexpr double kEnergyBound = 1e-12;

struct ManyBounces {
  std::uint64_t bounces = 0, came_to_rest = 0, jammed = 0, overlapped = 0;
  double energy_error = 0.0;  // the most that the energy was from what it was at first; relative
  double lowest_m = 0.0;      // the most that the body was below what it bounces off
  double simulated_s = 0.0;
};

// A body of that geometry falls 1 m onto a floor and is sent back, until it has bounced so often.
inline ManyBounces bounce(const std::string& geometry, double low_m, const std::string& response,
                          std::uint64_t bounces) {
  using namespace replication;
  using namespace replication::test;
  constexpr double kGravity = 9.81, kHeight_m = 1.0;
  const World world("DEF BALL Transform { collisionResponse CollisionResponse { " + response +
                    " } children Shape { geometry " + geometry + " } }\n" +
                    box("FLOOR", "10 1 10", "0 -0.5 0", "collisionResponse CollisionResponse { " + response + " } ") +
                    interest("BALL", "\"FLOOR\""));
  MotionWorld motions(*world.model, sim(0s));
  const ObjectId ball = world["BALL"];
  motions.declare(ball, Role::kAuthoritative);
  motions.set_base(ball, sim(0s), moving({0, low_m + kHeight_m, 0}, Vec3::Zero(), {0, -kGravity, 0}));
  ManyBounces out;
  const double energy = kGravity * kHeight_m;
  Duration t = 0s;
  while (out.bounces < bounces && motions.counters().came_to_rest + motions.counters().jammed == 0) {
    t += 10s;
    motions.advance(sim(t));
    while (motions.poll_event()) {
    }
    out.bounces = motions.counters().contacts;
    const KinematicState s = motions.at(ball, sim(t));
    const double height_m = s.position.y() - low_m;
    out.lowest_m = std::max(out.lowest_m, -height_m);
    out.energy_error =
        std::max(out.energy_error, std::abs((0.5 * s.velocity.squaredNorm() + kGravity * height_m) / energy - 1.0));
  }
  const MotionWorld::Counters& counters = motions.counters();
  out.came_to_rest = counters.came_to_rest;
  out.jammed = counters.jammed;
  out.overlapped = counters.overlapped;
  out.simulated_s = to_seconds(t);
  return out;
}

}  // namespace peerd::stress
