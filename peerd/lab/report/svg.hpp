#pragma once
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace peerd::report {

// A small SVG writer for plots. Units are pixels, y points down, and the origin is at the top left. The text is
// self-contained (no scripts, style sheets or outside fonts) and well-formed whatever the strings hold.

struct Point {
  double x = 0.0;
  double y = 0.0;
};

struct Box {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

struct Stroke {
  std::string_view colour = "#222";
  double width = 1.0;
  std::string_view dashes = {};  // as SVG has them: "6 3"
  double opacity = 1.0;
};

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  double size = 12.0;
  std::string_view colour = "#222";
  Anchor anchor = Anchor::kStart;
  bool bold = false;
  double turned_deg = 0.0;  // clockwise, about the anchor
};

class Svg {
 public:
  Svg(double width, double height);

  void rect(const Box& box, std::string_view fill, const Stroke* outline = nullptr);
  void line(Point a, Point b, const Stroke& stroke);
  // Draws a line through points; points that are not finite break it.
  void polyline(std::span<const Point> points, const Stroke& stroke);
  // Draws any number of lines through finite points as one element, which is far smaller than one for each line.
  void lines(std::span<const std::vector<Point>> lines, const Stroke& stroke);
  // Fills a polygon of finite points.
  void polygon(std::span<const Point> points, std::string_view fill, double opacity);
  void circle(Point centre, double radius, std::string_view fill, const Stroke& stroke);
  void cross(Point centre, double radius, const Stroke& stroke);
  void text(Point at, std::string_view text, const TextStyle& style = {});
  [[nodiscard]] std::string finish() &&;

 private:
  void number(double value);
  void pairs(std::span<const Point> points);
  void attribute(std::string_view name, double value);
  void stroke_attributes(const Stroke& stroke);

  std::string out_;
};

inline constexpr std::string_view kGridColour = "#e4e4e4";
inline constexpr std::string_view kFrameColour = "#555";

// The approximate width of a text in DejaVu Sans [px]; other fonts are narrower.
[[nodiscard]] double text_width(std::string_view text, double size);

// A closed interval of data, empty at first. It ignores values that are not finite, and values that no scene has and
// whose differences might overflow.
struct Range {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();
  void add(double value) {
    if (!(std::fabs(value) < 1e100)) return;
    lo = std::fmin(lo, value);
    hi = std::fmax(hi, value);
  }
  [[nodiscard]] bool empty() const { return !(lo <= hi); }
};

// Makes a range that can be an axis: an empty range becomes [0, 1], and a single value gets room on both sides.
[[nodiscard]] Range drawable(Range range);

// The range of quantities that start at zero: [0, hi] with a little room, or [0, 1] if all are zero.
[[nodiscard]] inline Range from_zero(double hi) { return {0.0, hi > 0.0 ? 1.06 * hi : 1.0}; }

struct Ticks {
  std::vector<double> at;
  int decimals = 0;  // decimals that the labels need
};

// Multiples of 1, 2 or 5 times a power of ten inside the range, as many as possible but at most `most` (>= 2).
[[nodiscard]] Ticks nice_ticks(Range range, int most);
// The powers of ten times 1, 2 and 5 inside a range of positive numbers, or the powers alone where those are too many.
[[nodiscard]] std::vector<double> log_ticks(Range range, int most);
[[nodiscard]] std::string tick_label(double value, int decimals);
// A number with as few digits as it needs and at most `digits`: "0.0005", "20", "5.61e-05".
[[nodiscard]] std::string short_label(double value, int digits = 4);

// Axes around a box: maps data to pixels and draws frame, grid and labels.
class Panel {
 public:
  Panel(const Box& box, Range x, Range y) : box_(box), x_(drawable(x)), y_(drawable(y)) {}
  // A panel whose y axis shows the logarithm; y holds positive numbers.
  static Panel log_y(const Box& box, Range x, Range y);

  [[nodiscard]] double px(double x) const { return box_.x + (x - x_.lo) / (x_.hi - x_.lo) * box_.width; }
  [[nodiscard]] double py(double y) const {
    const double value = log_y_ ? std::log10(y) : y;
    return box_.y + box_.height - (value - y_.lo) / (y_.hi - y_.lo) * box_.height;
  }
  [[nodiscard]] Point at(double x, double y) const { return {px(x), py(y)}; }
  [[nodiscard]] const Box& box() const { return box_; }

  struct Labels {
    std::string_view x = {};  // empty: neither label nor numbers
    std::string_view y = {};
    int x_ticks = 11;
    int y_ticks = 6;  // 0: none
  };
  void draw_axes(Svg& svg, const Labels& labels) const;

  // Draws a curve through data points that are sorted by x. More points than pixels can tell apart are thinned to the
  // first, lowest, highest and last of each pixel column, which draws the same line (Jugel et al., M4, VLDB 2014).
  void draw_curve(Svg& svg, std::span<const Point> data, const Stroke& stroke) const;

 private:
  Box box_;
  Range x_, y_;  // logarithms in y where log_y_
  bool log_y_ = false;
};

}  // namespace peerd::report
