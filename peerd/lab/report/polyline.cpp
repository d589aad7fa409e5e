#include "peerd/lab/report/polyline.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <utility>

namespace peerd::report {
namespace {

// The distance of p from the segment from a to b.
double distance_from(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double along = length2 > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

Point between(const Point& a, const Point& b, double s) { return {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)}; }

// One side of a box: inside(p) >= 0 holds on the box's side of it.
struct Side {
  double nx, ny, offset;
  [[nodiscard]] double inside(const Point& p) const { return nx * p.x + ny * p.y - offset; }
};

std::array<Side, 4> sides_of(const Box& box) {
  return {Side{1.0, 0.0, box.x}, Side{-1.0, 0.0, -(box.x + box.width)}, Side{0.0, 1.0, box.y},
          Side{0.0, -1.0, -(box.y + box.height)}};
}

// The part of a segment that is in the box, from 0 at a to 1 at b (Liang and Barsky, ACM TOG 3(1), 1984).
std::optional<std::pair<double, double>> part_inside(const Point& a, const Point& b, const Box& box) {
  double begin = 0.0, end = 1.0;
  for (const Side& side : sides_of(box)) {
    const double at_a = side.inside(a), at_b = side.inside(b);
    if (at_a < 0.0 && at_b < 0.0) return std::nullopt;
    if (at_a < 0.0) begin = std::max(begin, at_a / (at_a - at_b));
    if (at_b < 0.0) end = std::min(end, at_a / (at_a - at_b));
  }
  if (begin > end) return std::nullopt;
  return std::pair(begin, end);
}

}  // namespace

std::vector<Point> simplified(std::span<const Point> line, double tolerance) {
  assert(tolerance >= 0.0);
  if (line.size() < 3) return {line.begin(), line.end()};
  std::vector<bool> kept(line.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> pending{{0, line.size() - 1}};
  while (!pending.empty()) {
    const auto [first, last] = pending.back();
    pending.pop_back();
    double farthest = tolerance;
    std::size_t at = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = distance_from(line[i], line[first], line[last]);
      if (distance > farthest) farthest = distance, at = i;
    }
    if (at == first) continue;
    kept[at] = true;
    pending.emplace_back(first, at);
    pending.emplace_back(at, last);
  }
  std::vector<Point> points;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (kept[i]) points.push_back(line[i]);
  }
  return points;
}

std::vector<std::vector<Point>> clipped_line(std::span<const Point> line, const Box& box) {
  std::vector<std::vector<Point>> parts;
  bool goes_on = false;  // the last part ends at the point before
  for (std::size_t i = 1; i < line.size(); ++i) {
    const auto inside = part_inside(line[i - 1], line[i], box);
    if (inside) {
      if (!goes_on || inside->first > 0.0) parts.push_back({between(line[i - 1], line[i], inside->first)});
      parts.back().push_back(between(line[i - 1], line[i], inside->second));
    }
    goes_on = inside && inside->second == 1.0;
  }
  return parts;
}

std::vector<Point> clipped_polygon(std::span<const Point> polygon, const Box& box) {
  std::vector<Point> points(polygon.begin(), polygon.end());
  for (const Side& side : sides_of(box)) {
    std::vector<Point> rest;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point &a = points[i], &b = points[(i + 1) % points.size()];
      const double at_a = side.inside(a), at_b = side.inside(b);
      if (at_a >= 0.0) rest.push_back(a);
      if ((at_a < 0.0) != (at_b < 0.0)) rest.push_back(between(a, b, at_a / (at_a - at_b)));
    }
    points = std::move(rest);
  }
  return points;
}

}  // namespace peerd::report
