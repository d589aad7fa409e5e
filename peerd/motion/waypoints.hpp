#pragma once
#include <optional>
#include <string>
#include <vector>

#include "peerd/motion/motion_path.hpp"

namespace peerd::config {

// Where an object is when: rows of t [s], x, y, z [m] in order of time.
struct Waypoints {
  std::vector<std::vector<double>> rows;
  bool loop = false;     // from the last row, which is the first place again, on as from the first
  bool corners = false;  // straight from one to the next, instead of a curve of continuous acceleration
};

// What is wrong with them, if anything.
struct WrongRow {
  std::size_t row = 0;
  std::string sentence;
};
[[nodiscard]] std::optional<WrongRow> check(const Waypoints& waypoints);

// Knots at the waypoints: those of the C2 cubic spline (natural, or periodic), or two at each corner. They don't turn.
[[nodiscard]] std::vector<Knot> waypoint_knots(const Waypoints& waypoints);

// Gives waypoint_knots() of the same rows those orientations, each with the mean spin of both sides, or at corners that
// of its own side.
void turn_through(const std::vector<Quat>& orientations, const Waypoints& waypoints, std::vector<Knot>& knots);

// The same path by knots at most `step_s` apart, each looking where it goes, level.
[[nodiscard]] std::vector<Knot> facing_forward(const std::vector<Knot>& knots, double step_s = 0.05);

}  // namespace peerd::config
