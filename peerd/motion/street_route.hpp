#pragma once
#include <cstddef>
#include <vector>

#include "core/math.hpp"
#include "peerd/motion/drive_settings.hpp"
#include "peerd/motion/random.hpp"

namespace peerd::config {

using Vec2 = Eigen::Vector2d;  // x, z

// The way that a car is meant to go: straight pieces along a lane's middle and quarter circles, drawn as it is asked
// for.
class StreetRoute {
 public:
  struct Place {
    Vec2 position, direction;
  };
  // From the lane that is nearest to `start`.
  StreetRoute(const DriveSettings& settings, const Vec2& start, Random& random);

  // At a distance along it [m].
  [[nodiscard]] Place at(double s_m);
  // The greatest speed [m/s] at `s_m` for which there is still time to brake, by `braking` [m/s^2], for the turns that
  // come, each taken with `sideways` [m/s^2].
  [[nodiscard]] double safe_speed(double s_m, double braking, double sideways, double speed_max);

 private:
  struct Piece {
    double begin_m, length_m;
    Vec2 position, direction;  // where it begins
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
  Vec2 end_, ahead_;          // of what is drawn
  int column_ = 0, row_ = 0;  // the crossing that comes next
  std::size_t way_ = 0;       // to there: +x, +z, -x, -z, each right of the one before
};

}  // namespace peerd::config
