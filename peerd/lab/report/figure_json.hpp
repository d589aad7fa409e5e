#pragma once
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace peerd::report {

using Json = nlohmann::ordered_json;

// Figures are data in the page, which the page's script (report.js) draws. Its head describes the members of a figure.

struct Point {
  double x = 0.0;
  double y = 0.0;
};

// Whether a figure can show the value. Values as large as 1e100 occur in no scene, and their differences might
// overflow.
[[nodiscard]] inline bool drawable(double value) { return std::fabs(value) < 1e100; }

// A closed interval of data, empty at first. It ignores values that no figure can show.
struct Range {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();
  void add(double value) {
    if (!drawable(value)) return;
    lo = std::fmin(lo, value);
    hi = std::fmax(hi, value);
  }
  [[nodiscard]] double width() const { return lo <= hi ? hi - lo : 0.0; }
};

// A line that is sorted by x, with at most two points for each of the `buckets` parts of its length: the lowest and the
// highest, so that no spike disappears. Points that are no numbers are left out, and a place whose y is no number
// stands for each row of them: the line is interrupted there.
[[nodiscard]] std::vector<Point> thinned(std::span<const Point> line, std::size_t buckets);

// The number with as few digits as it needs and at most `digits`: "0.0005", "20", "5.61e-05".
[[nodiscard]] std::string digits_text(double value, int digits);

// The values as JSON, rounded to a ten-thousandth of their range, which is finer than a screen. What is no number is
// null.
[[nodiscard]] Json numbers(std::span<const double> values);
// The coordinates of points, as members x and y of `look`.
[[nodiscard]] Json curve(std::span<const Point> points, Json look = Json::object());

// A figure with a cell for each panel, side by side.
[[nodiscard]] Json figure_of(std::string_view title, std::string_view subtitle, const Json& panels);

}  // namespace peerd::report
