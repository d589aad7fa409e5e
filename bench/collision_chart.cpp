#include "collision_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace peerd::bench {
namespace {

using report::Anchor;
using report::Point;

// Okabe and Ito's colours, which colour-blind readers can tell apart; without yellow, which is lost on white.
constexpr std::array<std::string_view, 7> kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                      "#e69f00", "#56b4e9", "#222222"};
constexpr std::array<std::string_view, 2> kDashes = {"", "6 3"};
constexpr double kWidth = 474, kPlotHeight = 250, kLeft = 80, kTop = 34, kBelow = 46, kLegendLine = 17;

std::string_view colour(std::size_t i) { return kColours[i % kColours.size()]; }
report::Stroke stroke(std::size_t i) {
  return {.colour = colour(i), .width = 1.5, .dashes = kDashes[i / kColours.size() % kDashes.size()]};
}

// Maps data to pixels.
class Scale {
 public:
  Scale(const Axis& axis, double begin, double end) : log_(axis.logarithmic), begin_(begin), end_(end) {
    if (axis.from_zero) range_.add(0);
  }
  void add(double value) {
    if (log_ && value <= 0) zero_ = true;
    if (!log_ || value > 0) range_.add(log_ ? std::log10(value) : value);
  }
  void close() {
    if (log_ && range_.empty()) range_ = {0, 1};
    if (log_) {
      fine_ = !zero_ && range_.hi - range_.lo < 2;
      range_ = fine_ ? report::Range{snap(range_.lo - 0.02, false), snap(range_.hi + 0.02, true)}
                     : report::Range{std::floor(range_.lo), std::ceil(range_.hi + 0.05)};
    }
    if (zero_) range_.lo -= 1;
    range_ = report::drawable(range_);
    if (!log_) range_.hi += 0.07 * (range_.hi - range_.lo);
  }
  [[nodiscard]] double pixel(double value) const {
    const double v = !log_ ? value : value > 0 ? std::log10(value) : range_.lo;
    return begin_ + (v - range_.lo) / (range_.hi - range_.lo) * (end_ - begin_);
  }
  struct Tick {
    double pixel;
    std::string label;
  };
  [[nodiscard]] std::vector<Tick> ticks(int most) const {
    std::vector<Tick> out;
    if (!log_) {
      const report::Ticks nice = report::nice_ticks(range_, most);
      for (const double at : nice.at) out.push_back({pixel(at), report::tick_label(at, nice.decimals)});
      return out;
    }
    if (zero_) out.push_back({begin_, "0"});
    const double step = fine_ ? 1 : std::ceil((range_.hi - range_.lo) / most);
    for (double d = std::floor(range_.lo) + (zero_ ? 1 : 0); d <= range_.hi + 1e-9; d += step) {
      for (const double m : {1.0, 2.0, 5.0}) {
        const double at = d + std::log10(m);
        if ((m > 1 && !fine_) || at < range_.lo - 1e-9 || at > range_.hi + 1e-9) continue;
        const double value = m * std::pow(10.0, d);
        out.push_back({pixel(value), report::tick_label(value, d < 0 ? static_cast<int>(-d) : 0)});
      }
    }
    return out;
  }

 private:
  // Rounds up to the next of 1, 2 and 5 times a power of ten.
  static double snap(double log_value, bool up) {
    const double decade = std::floor(log_value);
    double below = decade;
    for (const double step : {std::log10(2.0), std::log10(5.0), 1.0}) {
      if (log_value <= decade + step) return up ? decade + step : below;
      below = decade + step;
    }
    return decade + 1;
  }

  bool log_, zero_ = false, fine_ = false;  // fine: less than two decades, with ticks between them
  double begin_, end_;
  report::Range range_;
};

std::size_t legend_lines(const Chart& chart) {
  double x = 0;
  std::size_t lines = 1;
  for (const Series& s : chart.series) {
    const double width = 34 + report::text_width(s.name, 11);
    if (x > 0 && x + width > kWidth - 30) ++lines, x = 0;
    x += width;
  }
  return lines;
}

void draw_legend(report::Svg& svg, const Chart& chart, Point at) {
  Point p = at;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& s = chart.series[i];
    const double width = 34 + report::text_width(s.name, 11);
    if (p.x > at.x && p.x + width > at.x + kWidth - 30) p = {at.x, p.y + kLegendLine};
    if (s.marks) {
      svg.circle({p.x + 8, p.y - 4}, 4, colour(i), stroke(i));
    } else {
      svg.line({p.x, p.y - 4}, {p.x + 18, p.y - 4}, stroke(i));
    }
    svg.text({p.x + 22, p.y}, s.name, {.size = 11});
    p.x += width;
  }
}

void draw_chart(report::Svg& svg, const Chart& chart, Point corner) {
  const double left = corner.x + kLeft, right = corner.x + kWidth - 16, top = corner.y + kTop;
  const double bottom = top + kPlotHeight;
  Scale x(chart.x, left, right), y(chart.y, bottom, top);
  for (const Series& s : chart.series) {
    for (const Point& p : s.points) x.add(p.x), y.add(p.y);
  }
  x.close(), y.close();
  svg.text({left, corner.y + 22}, chart.title, {.size = 13, .bold = true});
  const report::Stroke grid{.colour = "#e4e4e4"}, frame{.colour = "#888"};
  for (const auto& tick : x.ticks(8)) {
    svg.line({tick.pixel, top}, {tick.pixel, bottom}, grid);
    svg.text({tick.pixel, bottom + 15}, tick.label, {.size = 11, .anchor = Anchor::kMiddle});
  }
  for (const auto& tick : y.ticks(7)) {
    svg.line({left, tick.pixel}, {right, tick.pixel}, grid);
    svg.text({left - 6, tick.pixel + 4}, tick.label, {.size = 11, .anchor = Anchor::kEnd});
  }
  svg.rect({left, top, right - left, kPlotHeight}, "none", &frame);
  svg.text({(left + right) / 2, bottom + 33}, chart.x.label, {.anchor = Anchor::kMiddle});
  svg.text({corner.x + 14, (top + bottom) / 2}, chart.y.label, {.anchor = Anchor::kMiddle, .turned_deg = -90});
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& s = chart.series[i];
    std::vector<Point> pixels;
    for (const Point& p : s.points) pixels.push_back({x.pixel(p.x), y.pixel(p.y)});
    if (!s.marks) svg.polyline(pixels, stroke(i));
    for (std::size_t k = 0; s.marks && k < pixels.size(); ++k) {
      svg.circle(pixels[k], 3.5, colour(i), {.colour = "#fff", .width = 0.5});
      if (k >= s.labels.size()) continue;
      const double width = report::text_width(s.labels[k], 9);
      const bool fits = pixels[k].x + 6 + width < right;
      svg.text({pixels[k].x + (fits ? 6 : -6), pixels[k].y - 4}, s.labels[k],
               {.size = 9, .colour = colour(i), .anchor = fits ? Anchor::kStart : Anchor::kEnd});
    }
  }
  draw_legend(svg, chart, {corner.x + 20, bottom + kBelow + 8});
}

}  // namespace

std::string draw(std::span<const Chart> charts, std::size_t columns) {
  std::size_t lines = 1;
  for (const Chart& chart : charts) lines = std::max(lines, legend_lines(chart));
  const double height = kTop + kPlotHeight + kBelow + kLegendLine * static_cast<double>(lines) + 8;
  columns = std::min(columns, charts.size());
  const std::size_t rows = (charts.size() + columns - 1) / columns;
  report::Svg svg(kWidth * static_cast<double>(columns), height * static_cast<double>(rows));
  for (std::size_t i = 0; i < charts.size(); ++i) {
    draw_chart(svg, charts[i], {kWidth * static_cast<double>(i % columns), height * static_cast<double>(i / columns)});
  }
  return std::move(svg).finish();
}

}  // namespace peerd::bench
