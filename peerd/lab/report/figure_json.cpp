#include "peerd/lab/report/figure_json.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>

namespace peerd::report {
namespace {

bool drawable_point(const Point& p) { return drawable(p.x) && drawable(p.y); }

// The double that is nearest to the decimal number, so that JSON has no more digits than that.
double rounded(double value, int decimals) {
  std::array<char, 128> digits;
  char* const end = digits.data() + digits.size();
  const auto written = std::to_chars(digits.data(), end, value, std::chars_format::fixed, decimals);
  double result = value;
  std::from_chars(digits.data(), written.ptr, result);
  return result + 0.0;  // no "-0"
}

}  // namespace

std::vector<Point> thinned(std::span<const Point> line, std::size_t buckets) {
  assert(buckets > 0);
  std::vector<Point> kept;
  if (line.empty()) return kept;
  const double bucket = (line.back().x - line.front().x) / static_cast<double>(buckets);
  const bool all = line.size() <= 2 * buckets || !(bucket > 0.0);
  const auto bucket_of = [&](std::size_t i) { return std::floor((line[i].x - line.front().x) / bucket); };
  for (std::size_t begin = 0; begin < line.size();) {
    std::size_t end = begin + 1;
    if (!drawable_point(line[begin])) {
      while (end < line.size() && !drawable_point(line[end])) ++end;
      if (!kept.empty() && end < line.size()) kept.push_back({line[end].x, std::nan("")});
    } else {
      std::size_t low = begin, high = begin;
      for (; !all && end < line.size() && drawable_point(line[end]) && bucket_of(end) == bucket_of(begin); ++end) {
        if (line[end].y < line[low].y) low = end;
        if (line[end].y > line[high].y) high = end;
      }
      kept.push_back(line[std::min(low, high)]);
      if (low != high) kept.push_back(line[std::max(low, high)]);
    }
    begin = end;
  }
  return kept;
}

std::string digits_text(double value, int digits) {
  std::array<char, 64> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return {text.data(), end.ptr};
}

Json numbers(std::span<const double> values) {
  Range range;
  for (const double v : values) range.add(v);
  const double width = range.width() > 0.0 ? range.width() : std::fabs(range.hi);
  const int decimals =
      drawable(width) && width > 0.0 ? std::clamp(4 - static_cast<int>(std::floor(std::log10(width))), 0, 18) : 0;
  Json out = Json::array();
  for (const double v : values) out.push_back(drawable(v) ? Json(rounded(v, decimals)) : Json(nullptr));
  return out;
}

Json curve(std::span<const Point> points, Json look) {
  std::vector<double> x, y;
  for (const Point& p : points) (x.push_back(p.x), y.push_back(p.y));
  look["x"] = numbers(x);
  look["y"] = numbers(y);
  return look;
}

Json figure_of(std::string_view title, std::string_view subtitle, const Json& panels) {
  Json figure{{"title", title}, {"subtitle", subtitle}, {"columns", panels.size()}, {"cells", Json::array()}};
  for (const Json& panel : panels) {
    figure["cells"].push_back(Json::object());
    figure["cells"].back()["panels"] = Json::array({panel});
  }
  return figure;
}

}  // namespace peerd::report
