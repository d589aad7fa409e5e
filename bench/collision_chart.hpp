#pragma once
#include <span>
#include <string>
#include <vector>

#include "peerd/lab/report/svg.hpp"

namespace peerd::bench {

struct Series {
  std::string name;
  std::vector<report::Point> points;
  bool marks = false;                    // a circle at each point in place of a line
  std::vector<std::string> labels = {};  // of the points; or none
};

struct Axis {
  std::string label;
  bool logarithmic = false;  // what is 0 stands a decade below the rest, as "0"
  bool from_zero = false;
};

struct Chart {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
};

// An SVG of charts in rows, with a legend below each.
[[nodiscard]] std::string draw(std::span<const Chart> charts, std::size_t columns);

}  // namespace peerd::bench
