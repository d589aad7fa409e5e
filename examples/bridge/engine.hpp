// A small physics engine that knows nothing of peers, in the place of Jolt, Box2D, Bullet or Unity: balls, gravity, a
// floor, fixed steps.
#pragma once
#include <array>
#include <list>

namespace engine {

using Vector = std::array<double, 3>;

constexpr double kStep_s = 1.0 / 120.0;

struct Body {
  Vector position{}, velocity{};
  double radius_m = 0.5, mass_kg = 1.0;
  bool kinematic = false;  // it moves as somebody else says, and nothing pushes it
  Vector before{};         // its position before the last step
};

class World {
 public:
  Body& add(const Body& body) { return bodies_.emplace_back(body); }
  void step();

 private:
  std::list<Body> bodies_;  // whose places stay
};

}  // namespace engine
