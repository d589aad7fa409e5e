#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "peerd/input/console/columns.hpp"
#include "peerd/lab/baselines/comparison.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/svg.hpp"

namespace peerd::baselines {
namespace {

using report::Anchor;
using report::Box;
using report::Panel;
using report::Range;
using report::Svg;

constexpr double kWidth = 900.0, kTop = 84.0, kRow_px = 22.0, kNames_px = 130.0, kBar_px = 190.0, kGap_px = 60.0;

struct Measure {
  const char* title;
  std::optional<double> (*value)(const Compared&);  // none: it is not known
  int decimals;                                     // of its label
};
// Each has bars from its least to its greatest value; a logarithm tells orders of magnitude apart.
const std::array kMeasures{
    Measure{"bytes/s, logarithmic", [](const Compared& s) { return std::optional(s.bytes_per_s); }, 0},
    Measure{"shown error [m], logarithmic", [](const Compared& s) { return std::optional(s.shown_error_m); }, 3},
    Measure{"shown later than true [ms]", [](const Compared& s) { return s.others_delay_ms; }, 0},
};

// The part of a bar's width: of the logarithm, or of the number where some are 0.
double part_of(double value, const Range& all, bool logarithmic) {
  if (!logarithmic) return all.hi > 0.0 ? value / all.hi : 0.0;
  const double room = 0.25, span = std::log10(all.hi / all.lo) + room;
  return span > 0.0 ? (std::log10(value / all.lo) + room) / span : 1.0;
}

}  // namespace

std::string picture(const std::string& title, std::span<const Compared> systems) {
  Svg svg(kWidth, kTop + kRow_px * static_cast<double>(systems.size()) + 20.0);
  report::draw_title(svg, {20.0, 28.0}, kWidth - 40.0, title, "by one scenario, network and seed; shorter is better");
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    const Measure& measure = kMeasures[m];
    const double left = 20.0 + kNames_px + static_cast<double>(m) * (kBar_px + kGap_px);
    svg.text({left, kTop - 10.0}, measure.title, {.size = 12.0, .colour = "#444"});
    Range all;
    for (const Compared& s : systems) {
      if (const auto value = measure.value(s)) all.add(*value);
    }
    const bool logarithmic = m < 2 && all.lo > 0.0;
    for (std::size_t i = 0; i < systems.size(); ++i) {
      const double y = kTop + kRow_px * static_cast<double>(i);
      if (m == 0) svg.text({20.0, y + 13.0}, systems[i].system, {.size = 13.0, .bold = i == 0});
      const std::optional<double> value = measure.value(systems[i]);
      const double width = value ? std::max(1.0, kBar_px * part_of(*value, all, logarithmic)) : 0.0;
      if (value) svg.rect({left, y + 2.0, width, kRow_px - 7.0}, i == 0 ? "#0b6e4f" : "#9db4c0");
      svg.text({left + width + 5.0, y + 13.0}, value ? fixed(*value, measure.decimals) : "-",
               {.size = 11.0, .colour = "#444"});
    }
  }
  return std::move(svg).finish();
}

}  // namespace peerd::baselines
