#pragma once
#include <span>
#include <vector>

#include "peerd/lab/report/svg.hpp"

namespace peerd::report {

// Functions on lines and polygons in the plane, in pixels. Points are finite.

// The points of a line of which no point is farther than `tolerance` from the line through the points that are kept
// (Douglas and Peucker, The Canadian Cartographer 10(2), 1973). The first and the last point are kept.
[[nodiscard]] std::vector<Point> simplified(std::span<const Point> line, double tolerance);

// The parts of a line that are in the box, each with at least two points.
[[nodiscard]] std::vector<std::vector<Point>> clipped_line(std::span<const Point> line, const Box& box);

// The part of a convex polygon that is in the box (Sutherland and Hodgman, CACM 17(1), 1974); empty where there is
// none.
[[nodiscard]] std::vector<Point> clipped_polygon(std::span<const Point> polygon, const Box& box);

}  // namespace peerd::report
