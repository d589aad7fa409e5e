#pragma once
#include <random>

#include "tests/replication/peer/messages.hpp"

// A town's traffic as one peer publishes it: half walkers, half vehicles, within 500 m of its centre, on hilly ground.
namespace peerd::replication::test {

class Traffic {
 public:
  explicit Traffic(std::uint64_t seed) : rng_(seed) {}

  UpdateRecord update(SimTime at) {
    const bool walks = draw(0, 1) < 0.5;
    const double heading = draw(-3.14, 3.14), slope = draw(-0.1, 0.1);
    const Vec3 forward(std::sin(heading) * std::cos(slope), std::sin(slope), std::cos(heading) * std::cos(slope));
    const Vec3 left(forward.z(), 0.0, -forward.x());
    const double speed = walks ? draw(0, 2) : draw(0, 16), turns = walks ? draw(-1, 1) : draw(-0.4, 0.4);
    UpdateRecord u{ObjectId{number(1, 2000)}, number(1, 4000), at, {}};
    KinematicState& s = u.model.state;
    s.position = {draw(-500, 500), draw(0, 30), draw(-500, 500)};
    s.velocity = speed * forward;
    s.acceleration = (walks ? draw(-0.5, 0.5) : draw(-2, 2)) * forward + speed * turns * left;
    s.orientation = quat_exp({0, heading, 0});
    s.angular_velocity_body = {0, turns, 0};
    if (!walks) {  // stands on the ground as it is; walkers stand upright
      s.orientation = (s.orientation * quat_exp({-slope, 0, 0}) * quat_exp({0, 0, draw(-0.05, 0.05)})).normalized();
      s.angular_velocity_body += Vec3(draw(-0.05, 0.05), 0, draw(-0.05, 0.05));
    }
    return u;
  }

 private:
  double draw(double from, double to) {
    return from + (to - from) * std::ldexp(static_cast<double>(rng_() >> 11), -53);
  }
  std::uint32_t number(std::uint32_t from, std::uint32_t to) {
    return from + static_cast<std::uint32_t>(rng_() % (to - from + 1));
  }

  std::mt19937_64 rng_;
};

}  // namespace peerd::replication::test
