#include "peerd/peer/motion/waypoints.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::motion {
namespace {

// Solves lower[i] x[i-1] + diagonal[i] x[i] + upper[i] x[i+1] = right[i] by Thomas's algorithm; the diagonal dominates.
std::vector<Vec3> solve_tridiagonal(const std::vector<double>& lower, std::vector<double> diagonal,
                                    const std::vector<double>& upper, std::vector<Vec3> right) {
  const std::size_t n = diagonal.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = lower[i] / diagonal[i - 1];
    diagonal[i] -= factor * upper[i - 1];
    right[i] -= factor * right[i - 1];
  }
  for (std::size_t i = n; i-- > 0;) {
    if (i + 1 < n) right[i] -= upper[i] * right[i + 1];
    right[i] /= diagonal[i];
  }
  return right;
}

// Solves the same system with lower[0] in the last column and upper[n-1] in the first (Sherman and Morrison).
std::vector<Vec3> solve_cyclic(const std::vector<double>& lower, std::vector<double> diagonal,
                               const std::vector<double>& upper, const std::vector<Vec3>& right) {
  const std::size_t n = diagonal.size();
  const double gamma = -diagonal.front(), ratio = lower.front() / gamma;
  diagonal.back() -= upper.back() * ratio;
  diagonal.front() -= gamma;
  std::vector<Vec3> corner(n, Vec3::Zero());
  corner.front().setConstant(gamma);
  corner.back().setConstant(upper.back());
  std::vector<Vec3> x = solve_tridiagonal(lower, diagonal, upper, right);
  const std::vector<Vec3> z = solve_tridiagonal(lower, diagonal, upper, corner);
  const Vec3 factor = (x.front() + ratio * x.back()) / (1.0 + z.front().x() + ratio * z.back().x());
  for (std::size_t i = 0; i < n; ++i) x[i] -= factor.cwiseProduct(z[i]);
  return x;
}

// Accelerations of the C2 cubic spline at its points, by its "moments": h M(i-1) + 2 (h + h') M(i) + h' M(i+1) is six
// times the change of slope at i. They are zero at both ends, or periodic with the last point being the first.
std::vector<Vec3> spline_accelerations(const std::vector<Knot>& knots, bool loop) {
  const std::size_t pieces = knots.size() - 1;
  std::vector<Vec3> accelerations(knots.size(), Vec3::Zero());
  const auto h = [&](std::size_t i) { return knots[i + 1].t_s - knots[i].t_s; };
  const auto slope = [&](std::size_t i) {
    return Vec3((knots[i + 1].state.position - knots[i].state.position) / h(i));
  };
  const std::size_t first = loop ? 0 : 1, unknowns = pieces - first;
  if (unknowns == 0) return accelerations;
  std::vector<double> lower, diagonal, upper;
  std::vector<Vec3> right;
  for (std::size_t i = first; i < pieces; ++i) {
    const std::size_t before = i == 0 ? pieces - 1 : i - 1;
    lower.push_back(h(before));
    upper.push_back(h(i));
    diagonal.push_back(2.0 * (h(before) + h(i)));
    right.push_back(6.0 * (slope(i) - slope(before)));
  }
  const std::vector<Vec3> solved =
      loop ? solve_cyclic(lower, diagonal, upper, right) : solve_tridiagonal(lower, diagonal, upper, right);
  std::ranges::copy(solved, accelerations.begin() + static_cast<std::ptrdiff_t>(first));
  if (loop) accelerations.back() = accelerations.front();
  return accelerations;
}

void bend(std::vector<Knot>& knots, bool loop) {
  const std::vector<Vec3> a = spline_accelerations(knots, loop);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const std::size_t piece = std::min(i, knots.size() - 2);
    const double h = knots[piece + 1].t_s - knots[piece].t_s;
    const Vec3 slope = (knots[piece + 1].state.position - knots[piece].state.position) / h;
    const Vec3 bend = i == piece ? Vec3(-(2.0 * a[i] + a[i + 1])) : Vec3(a[piece] + 2.0 * a[i]);
    knots[i].state.velocity = slope + h / 6.0 * bend;
    knots[i].state.acceleration = a[i];
  }
}

std::vector<Knot> with_corners(const std::vector<Knot>& knots) {
  std::vector<Knot> corners;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    Knot from = knots[i], to = knots[i + 1];
    from.state.velocity = to.state.velocity = (to.state.position - from.state.position) / (to.t_s - from.t_s);
    corners.push_back(from);
    corners.push_back(to);
  }
  return corners;
}

}  // namespace

std::optional<WrongRow> check(const Waypoints& waypoints) {
  const auto& rows = waypoints.rows;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i][0] <= rows[i - 1][0]) return WrongRow{i, "each time must be later than the one before"};
  }
  if (!waypoints.loop) return std::nullopt;
  if (rows.size() < 3 || !std::equal(rows.front().begin() + 1, rows.front().end(), rows.back().begin() + 1)) {
    return WrongRow{rows.size() - 1, "a loop ends where it begins: let the last row be the first place again"};
  }
  return std::nullopt;
}

std::vector<Knot> waypoint_knots(const Waypoints& waypoints) {
  std::vector<Knot> knots;
  for (const std::vector<double>& row : waypoints.rows) {
    Knot& knot = knots.emplace_back();
    knot.t_s = row[0];
    knot.state.position = Vec3(row[1], row[2], row[3]);
  }
  if (knots.size() < 2) return knots;
  if (waypoints.corners) return with_corners(knots);
  bend(knots, waypoints.loop);
  return knots;
}

void turn_through(const std::vector<Quat>& orientations, const Waypoints& waypoints, std::vector<Knot>& knots) {
  const std::size_t pieces = orientations.size() - 1;
  const auto h = [&](std::size_t i) { return waypoints.rows[i + 1][0] - waypoints.rows[i][0]; };
  const auto spin = [&](std::size_t i) { return Vec3(turn_between(orientations[i], orientations[i + 1]) / h(i)); };
  if (waypoints.corners && pieces > 0) {
    for (std::size_t i = 0; i < pieces; ++i) {
      for (const std::size_t end : {0u, 1u}) {
        knots[2 * i + end].state.orientation = orientations[i + end];
        knots[2 * i + end].state.angular_velocity_body = spin(i);
      }
    }
    return;
  }
  for (std::size_t i = 0; i <= pieces; ++i) {
    knots[i].state.orientation = orientations[i];
    if (pieces == 0) break;
    const bool inner = i > 0 && i < pieces;
    const std::size_t before = i > 0 ? i - 1 : waypoints.loop ? pieces - 1 : 0;
    const std::size_t after = i < pieces ? i : waypoints.loop ? 0 : pieces - 1;
    const double b = h(before), a = h(after);
    knots[i].state.angular_velocity_body =
        inner || waypoints.loop ? Vec3((a * spin(before) + b * spin(after)) / (a + b)) : spin(before);
  }
}

std::vector<Knot> facing_forward(const std::vector<Knot>& knots, double step_s) {
  const MotionPath path(knots);
  std::vector<Knot> facing;
  const auto add = [&](double t_s, const KinematicState& state) {
    const KinematicState before = facing.empty() ? state : facing.back().state;
    face_forward(facing.emplace_back(t_s, state).state, true, before);
  };
  for (std::size_t i = 0; i < knots.size(); ++i) {
    add(knots[i].t_s, knots[i].state);
    if (i + 1 == knots.size()) break;
    const double h = knots[i + 1].t_s - knots[i].t_s;
    const double parts = std::ceil(h / step_s);
    for (double part = 1.0; part < parts; part += 1.0) {
      const double t = knots[i].t_s + part * h / parts;
      add(t, path.sample(t));
    }
  }
  return facing;
}

}  // namespace peerd::motion
