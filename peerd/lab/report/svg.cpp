#include "peerd/lab/report/svg.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "peerd/lab/report/markup.hpp"

namespace peerd::report {

Svg::Svg(double width, double height) {
  out_ = R"(<svg xmlns="http://www.w3.org/2000/svg" width=")";
  number(width);
  out_ += R"(" height=")";
  number(height);
  out_ += R"(" viewBox="0 0 )";
  number(width);
  out_ += ' ';
  number(height);
  out_ += R"(" font-family="'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif">)";
  out_ += '\n';
  rect({0.0, 0.0, width, height}, "#fff");
}

// Numbers are rounded to a tenth of a pixel: finer ones cannot be seen, and pictures stay small.
void Svg::number(double value) {
  assert(std::isfinite(value));
  const auto tenths = static_cast<std::int64_t>(std::llround(std::clamp(value, -1e6, 1e6) * 10.0));
  std::array<char, 32> digits;
  char* p = digits.data();
  if (tenths < 0) *p++ = '-';
  p = std::to_chars(p, digits.data() + digits.size(), std::abs(tenths) / 10).ptr;
  if (tenths % 10 != 0) {
    *p++ = '.';
    *p++ = static_cast<char>('0' + std::abs(tenths) % 10);
  }
  out_.append(digits.data(), p);
}

void Svg::pairs(std::span<const Point> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) out_ += ' ';
    number(points[i].x);
    out_ += ',';
    number(points[i].y);
  }
}

void Svg::attribute(std::string_view name, double value) {
  out_ += ' ';
  out_ += name;
  out_ += "=\"";
  number(value);
  out_ += '"';
}

void Svg::stroke_attributes(const Stroke& stroke) {
  out_ += " stroke=\"";
  out_ += stroke.colour;
  out_ += '"';
  attribute("stroke-width", stroke.width);
  if (!stroke.dashes.empty()) {
    out_ += " stroke-dasharray=\"";
    out_ += stroke.dashes;
    out_ += '"';
  }
  if (stroke.opacity < 1.0) attribute("stroke-opacity", stroke.opacity);
}

void Svg::rect(const Box& box, std::string_view fill, const Stroke* outline) {
  out_ += "<rect";
  attribute("x", box.x);
  attribute("y", box.y);
  attribute("width", box.width);
  attribute("height", box.height);
  out_ += " fill=\"";
  out_ += fill;
  out_ += '"';
  if (outline != nullptr) stroke_attributes(*outline);
  out_ += "/>\n";
}

void Svg::line(Point a, Point b, const Stroke& stroke) {
  out_ += "<line";
  attribute("x1", a.x);
  attribute("y1", a.y);
  attribute("x2", b.x);
  attribute("y2", b.y);
  stroke_attributes(stroke);
  out_ += "/>\n";
}

void Svg::polyline(std::span<const Point> points, const Stroke& stroke) {
  const auto finite = [](const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y); };
  auto first = std::ranges::find_if(points, finite);
  while (first != points.end()) {
    const auto last = std::find_if_not(first, points.end(), finite);
    out_ += "<polyline fill=\"none\" stroke-linejoin=\"round\"";
    stroke_attributes(stroke);
    out_ += " points=\"";
    pairs({first, last});
    out_ += "\"/>\n";
    first = std::find_if(last, points.end(), finite);
  }
}

void Svg::lines(std::span<const std::vector<Point>> lines, const Stroke& stroke) {
  out_ += "<path fill=\"none\" stroke-linejoin=\"round\"";
  stroke_attributes(stroke);
  out_ += " d=\"";
  for (const std::vector<Point>& line : lines) {
    if (line.empty()) continue;
    out_ += 'M';
    pairs(line);
  }
  out_ += "\"/>\n";
}

void Svg::polygon(std::span<const Point> points, std::string_view fill, double opacity) {
  out_ += "<polygon fill=\"";
  out_ += fill;
  out_ += '"';
  // Shares of a hundredth: a tenth is too coarse for what lies over each other.
  out_ += " fill-opacity=\"" + tick_label(opacity, 2) + "\" points=\"";
  pairs(points);
  out_ += "\"/>\n";
}

void Svg::circle(Point centre, double radius, std::string_view fill, const Stroke& stroke) {
  out_ += "<circle";
  attribute("cx", centre.x);
  attribute("cy", centre.y);
  attribute("r", radius);
  out_ += " fill=\"";
  out_ += fill;
  out_ += '"';
  stroke_attributes(stroke);
  out_ += "/>\n";
}

void Svg::cross(Point centre, double radius, const Stroke& stroke) {
  line({centre.x - radius, centre.y - radius}, {centre.x + radius, centre.y + radius}, stroke);
  line({centre.x - radius, centre.y + radius}, {centre.x + radius, centre.y - radius}, stroke);
}

void Svg::text(Point at, std::string_view text, const TextStyle& style) {
  out_ += "<text";
  attribute("x", at.x);
  attribute("y", at.y);
  attribute("font-size", style.size);
  out_ += " fill=\"";
  out_ += style.colour;
  out_ += '"';
  if (style.anchor != Anchor::kStart) {
    out_ += style.anchor == Anchor::kMiddle ? " text-anchor=\"middle\"" : " text-anchor=\"end\"";
  }
  if (style.bold) out_ += " font-weight=\"bold\"";
  if (style.turned_deg != 0.0) {
    out_ += " transform=\"rotate(";
    number(style.turned_deg);
    out_ += ' ';
    number(at.x);
    out_ += ' ';
    number(at.y);
    out_ += ")\"";
  }
  out_ += '>';
  out_ += markup_text(text);
  out_ += "</text>\n";
}

std::string Svg::finish() && {
  out_ += "</svg>\n";
  return std::move(out_);
}

double text_width(std::string_view text, double size) {
  const auto letters = std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; });
  return 0.6 * size * static_cast<double>(letters);
}

Range drawable(Range range) {
  if (range.empty()) return {0.0, 1.0};
  const double room = std::fmax(0.5, 1e-3 * std::fabs(range.lo));
  const double rounding = 1e-12 * std::fmax(std::fabs(range.lo), std::fabs(range.hi));
  if (range.hi - range.lo <= std::fmax(rounding, 1e-100)) return {range.lo - room, range.hi + room};
  return range;
}

Ticks nice_ticks(Range range, int most) {
  assert(most >= 2);
  range = drawable(range);
  const double width = range.hi - range.lo;
  // The least step that could do is width / most. The search starts a decade below it and goes up.
  for (int exponent = static_cast<int>(std::floor(std::log10(width / most)));; ++exponent) {
    for (const double mantissa : {1.0, 2.0, 5.0}) {
      // Ticks are multiples of an integer, divided for small steps: 3 / 10 is the 0.3 that a person would write, 3 *
      // 0.1 is not.
      const double power = std::pow(10.0, std::abs(exponent));
      const auto multiple = [&](double i) { return exponent < 0 ? i * mantissa / power : i * mantissa * power; };
      const double step = multiple(1.0);
      const double first = std::ceil(range.lo / step - 1e-9);  // an end that misses a tick by rounding has it
      const double last = std::floor(range.hi / step + 1e-9);
      if (last - first + 1.0 > most) continue;
      Ticks ticks{.at = {}, .decimals = std::max(0, -exponent)};
      for (double i = first; i <= last; i += 1.0) ticks.at.push_back(multiple(i) + 0.0);  // + 0.0: no "-0"
      return ticks;
    }
  }
}

std::vector<double> log_ticks(Range range, int most) {
  assert(range.lo > 0.0 && most >= 2);
  std::vector<double> all, powers;
  const int first = static_cast<int>(std::floor(std::log10(range.lo)));
  const int last = static_cast<int>(std::ceil(std::log10(range.hi)));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (const double mantissa : {1.0, 2.0, 5.0}) {
      const double power = std::pow(10.0, std::abs(exponent));
      const double t = exponent < 0 ? mantissa / power : mantissa * power;
      if (!(t >= range.lo && t <= range.hi)) continue;
      all.push_back(t);
      if (mantissa == 1.0) powers.push_back(t);
    }
  }
  return all.size() <= static_cast<std::size_t>(most) ? all : powers;
}

std::string short_label(double value, int digits) {
  std::array<char, 64> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return {text.data(), end.ptr};
}

std::string tick_label(double value, int decimals) {
  std::array<char, 64> digits;
  const bool plain = decimals <= 6 && std::fabs(value) < 1e7;
  const auto end =
      plain ? std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals)
            : std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 6);
  return {digits.data(), end.ptr};
}

Panel Panel::log_y(const Box& box, Range x, Range y) {
  assert(y.empty() || y.lo > 0.0);
  Panel panel(box, x, y.empty() ? y : Range{std::log10(y.lo), std::log10(y.hi)});
  panel.log_y_ = true;
  return panel;
}

void Panel::draw_axes(Svg& svg, const Labels& labels) const {
  const double bottom = box_.y + box_.height;
  const Ticks x = nice_ticks(x_, labels.x_ticks);
  for (const double t : x.at) {
    svg.line({px(t), box_.y}, {px(t), bottom}, {.colour = kGridColour});
    svg.line({px(t), bottom}, {px(t), bottom + 4.0}, {.colour = kFrameColour});
    if (!labels.x.empty()) {
      svg.text({px(t), bottom + 17.0}, tick_label(t, x.decimals), {.size = 11.0, .anchor = Anchor::kMiddle});
    }
  }
  const auto mark_y = [&](double t, const std::string& label) {
    svg.line({box_.x, py(t)}, {box_.x + box_.width, py(t)}, {.colour = kGridColour});
    svg.line({box_.x - 4.0, py(t)}, {box_.x, py(t)}, {.colour = kFrameColour});
    svg.text({box_.x - 8.0, py(t) + 4.0}, label, {.size = 11.0, .anchor = Anchor::kEnd});
  };
  if (labels.y_ticks > 0 && log_y_) {
    for (const double t : log_ticks({std::pow(10.0, y_.lo), std::pow(10.0, y_.hi)}, labels.y_ticks))
      mark_y(t, short_label(t));
  } else if (labels.y_ticks > 0) {
    const Ticks y = nice_ticks(y_, labels.y_ticks);
    for (const double t : y.at) mark_y(t, tick_label(t, y.decimals));
  }
  const Stroke frame{.colour = kFrameColour};
  svg.rect(box_, "none", &frame);
  if (!labels.x.empty()) {
    svg.text({box_.x + 0.5 * box_.width, bottom + 36.0}, labels.x, {.size = 12.0, .anchor = Anchor::kMiddle});
  }
  if (!labels.y.empty()) {
    svg.text({box_.x - 50.0, box_.y + 0.5 * box_.height}, labels.y,
             {.size = 12.0, .anchor = Anchor::kMiddle, .turned_deg = -90.0});
  }
}

void Panel::draw_curve(Svg& svg, std::span<const Point> data, const Stroke& stroke) const {
  std::vector<Point> pixels;
  pixels.reserve(data.size());
  for (const Point& p : data) pixels.push_back(at(p.x, p.y));
  if (static_cast<double>(pixels.size()) > 4.0 * box_.width) {
    std::vector<Point> thinned;
    for (std::size_t begin = 0; begin < pixels.size();) {
      std::size_t end = begin + 1;
      std::size_t low = begin;
      std::size_t high = begin;
      while (end < pixels.size() && std::floor(pixels[end].x) == std::floor(pixels[begin].x)) {
        if (pixels[end].y < pixels[low].y) low = end;
        if (pixels[end].y > pixels[high].y) high = end;
        ++end;
      }
      std::array keep{begin, std::min(low, high), std::max(low, high), end - 1};
      const auto unique_end = std::unique(keep.begin(), keep.end());
      for (auto k = keep.begin(); k != unique_end; ++k) thinned.push_back(pixels[*k]);
      begin = end;
    }
    pixels = std::move(thinned);
  }
  svg.polyline(pixels, stroke);
}

}  // namespace peerd::report
