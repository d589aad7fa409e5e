#include "peerd/peer/motion/street_route.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace peerd::motion {
namespace {

constexpr double kRightRadius_m = 7.0, kLeftRadius_m = 10.0;
constexpr double kClear_m = kLeftRadius_m + 5.0;  // least distance of a car to the next crossing when it starts

struct Way {
  int columns, rows;
  [[nodiscard]] Vec2 direction() const { return {columns, rows}; }
};
constexpr std::array<Way, 4> kWays{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

Vec2 right_of(const Vec2& direction) { return {-direction.y(), direction.x()}; }

}  // namespace

StreetRoute::StreetRoute(const DriveSettings& settings, const Vec2& start, Random& random)
    : s_(settings), random_(random) {
  const Vec2 grid = (start - Vec2(s_.origin_x_m, s_.origin_z_m)) / s_.block_m;  // in blocks
  const double last = s_.blocks;
  const Vec2 nearest(std::clamp(std::round(grid.x()), 0.0, last), std::clamp(std::round(grid.y()), 0.0, last));
  const bool along_x = std::abs(grid.y() - nearest.y()) <= std::abs(grid.x() - nearest.x());
  const double aside = along_x ? grid.y() - nearest.y() : nearest.x() - grid.x();
  way_ = (along_x ? 0u : 1u) + (aside < 0.0 ? 2u : 0u);
  ahead_ = kWays[way_].direction();
  const bool forward = ahead_.sum() > 0.0;
  // The distance that the car has come along its street, in blocks, in its own direction.
  const double along = along_x ? grid.x() : grid.y(), clear = kClear_m / s_.block_m;
  const double come = std::clamp(forward ? along : last - along, 0.0, last - clear);
  const double next = std::ceil(come + clear);
  const int crossing = static_cast<int>(forward ? next : last - next);
  const double place = forward ? come : last - come;
  column_ = along_x ? crossing : static_cast<int>(nearest.x());
  row_ = along_x ? static_cast<int>(nearest.y()) : crossing;
  end_ = Vec2(s_.origin_x_m, s_.origin_z_m) +
         s_.block_m * (along_x ? Vec2(place, nearest.y()) : Vec2(nearest.x(), place)) + s_.lane_m * right_of(ahead_);
}

bool StreetRoute::leads_on(int column, int row, std::size_t way) const {
  const int last = static_cast<int>(s_.blocks);
  const int c = column + kWays[way].columns, r = row + kWays[way].rows;
  return c >= 0 && c <= last && r >= 0 && r <= last;
}

void StreetRoute::add(double length_m, double curvature) {
  pieces_.push_back({end_m_, length_m, end_, ahead_, curvature});
  const Place end = at(end_m_ + length_m);
  end_m_ += length_m;
  end_ = end.position;
  ahead_ = end.direction;
}

// Adds the way to the next crossing, and round its corner if the car turns there.
void StreetRoute::extend() {
  std::array<std::size_t, 3> choices{};  // straight, right, left
  std::size_t count = 0;
  for (const std::size_t turn : {0u, 1u, 3u}) {
    if (leads_on(column_, row_, (way_ + turn) % 4)) choices[count++] = turn;
  }
  const std::size_t turn = choices[random_.below(count)];
  const Vec2 crossing = Vec2(s_.origin_x_m, s_.origin_z_m) + s_.block_m * Vec2(column_, row_);
  const double to_crossing = (crossing - end_).dot(ahead_);
  if (turn == 0) {
    add(to_crossing, 0.0);
  } else {
    const bool right = turn == 1;
    const double radius = right ? kRightRadius_m : kLeftRadius_m;
    // The lanes meet `lane_m` before the crossing's middle or behind it, and the circle begins a radius before that.
    add(to_crossing + (right ? -s_.lane_m : s_.lane_m) - radius, 0.0);
    add(0.5 * std::numbers::pi * radius, (right ? 1.0 : -1.0) / radius);
    ahead_ = kWays[(way_ + turn) % 4].direction();
  }
  way_ = (way_ + turn) % 4;
  column_ += kWays[way_].columns;
  row_ += kWays[way_].rows;
}

const StreetRoute::Piece& StreetRoute::piece(double s_m) {
  while (s_m > end_m_) extend();
  const auto next = std::ranges::upper_bound(pieces_, s_m, {}, &Piece::begin_m);
  return next == pieces_.begin() ? *next : *(next - 1);
}

StreetRoute::Place StreetRoute::at(double s_m) {
  if (pieces_.empty()) extend();
  const Piece& p = pieces_.back().begin_m <= s_m && s_m <= pieces_.back().begin_m + pieces_.back().length_m
                       ? pieces_.back()
                       : piece(s_m);
  const double along = s_m - p.begin_m;
  if (p.curvature == 0.0) return {p.position + along * p.direction, p.direction};
  const double angle = along * p.curvature;
  const Vec2 right = right_of(p.direction);
  return {p.position + (std::sin(angle) * p.direction + (1.0 - std::cos(angle)) * right) / p.curvature,
          std::cos(angle) * p.direction + std::sin(angle) * right};
}

double StreetRoute::safe_speed(double s_m, double braking, double sideways, double speed_max) {
  double speed = speed_max;
  const double horizon_m = speed_max * speed_max / (2.0 * braking);
  (void)piece(s_m + horizon_m);  // extends the route that far
  for (const Piece& p : pieces_) {
    if (p.curvature == 0.0 || p.begin_m + p.length_m < s_m) continue;
    const double before = std::max(0.0, p.begin_m - s_m);
    speed = std::min(speed, std::sqrt(sideways / std::abs(p.curvature) + 2.0 * braking * before));
  }
  return speed;
}

}  // namespace peerd::motion
