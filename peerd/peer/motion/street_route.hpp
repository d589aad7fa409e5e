#pragma once
#include <cstddef>
#include <vector>

#include "core/math.hpp"
#include "peerd/peer/motion/drive_settings.hpp"
#include "peerd/peer/motion/random.hpp"

namespace peerd::motion {

using Vec2 = Eigen::Vector2d;  // x and z [m]

// The way that a car is meant to take: straight pieces along a lane's middle and quarter circles. It is drawn at random
// as far as it is asked for.
class StreetRoute {
 public:
  struct Place {
    Vec2 position, direction;
  };
  // The route begins on the lane that is nearest to `start`.
  StreetRoute(const DriveSettings& settings, const Vec2& start, Random& random);

  // The place at a distance along the route [m].
  [[nodiscard]] Place at(double s_m);
  // The greatest speed [m/s] at `s_m` that still leaves time to brake, by `braking` [m/s^2], for the turns ahead, each
  // taken with `sideways` [m/s^2].
  [[nodiscard]] double safe_speed(double s_m, double braking, double sideways, double speed_max);

 private:
  struct Piece {
    double begin_m, length_m;
    Vec2 position, direction;  // at its beginning
    double curvature;          // [1/m], positive to the right
  };
  void extend();
  void add(double length_m, double curvature);
  [[nodiscard]] bool leads_on(int column, int row, std::size_t way) const;
  [[nodiscard]] const Piece& piece(double s_m);

  const DriveSettings& s_;
  Random& random_;
  std::vector<Piece> pieces_;
  double end_m_ = 0.0;
  Vec2 end_, ahead_;          // end of the route so far
  int column_ = 0, row_ = 0;  // next crossing
  std::size_t way_ = 0;       // direction to it: 0: +x, 1: +z, 2: -x, 3: -z; each is right of the one before
};

}  // namespace peerd::motion
