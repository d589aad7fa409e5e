#pragma once
#include <optional>
#include <string>
#include <vector>

#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::motion {

// Places of an object over time: rows of t [s], x, y, z [m] in order of time.
struct Waypoints {
  std::vector<std::vector<double>> rows;
  bool loop = false;     // the path repeats; the last row is the first place again
  bool corners = false;  // straight from row to row, instead of a curve of continuous acceleration
};

// The first row that is wrong, and why.
struct WrongRow {
  std::size_t row = 0;
  std::string sentence;
};
[[nodiscard]] std::optional<WrongRow> check(const Waypoints& waypoints);

// Knots at the waypoints: those of the C2 cubic spline (natural, or periodic), or two at each corner. The object does
// not turn.
[[nodiscard]] std::vector<Knot> waypoint_knots(const Waypoints& waypoints);

// Gives waypoint_knots() of the same rows those orientations. Each knot has the mean spin of both sides, or at corners
// the spin of its own side.
void turn_through(const std::vector<Quat>& orientations, const Waypoints& waypoints, std::vector<Knot>& knots);

// The same path by knots at most `step_s` apart, at each of which the object looks along its way, level.
[[nodiscard]] std::vector<Knot> facing_forward(const std::vector<Knot>& knots, double step_s = 0.05);

}  // namespace peerd::motion
