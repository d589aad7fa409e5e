#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/lab/measure/pareto.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"

namespace peerd::report {
namespace {

struct ParetoLayout {  // [px]
  static constexpr double kWidth = 800.0;
  static constexpr double kLeft = 70.0;
  static constexpr double kPlotWidth = 710.0;
  static constexpr double kPlotHeight = 320.0;
  static constexpr double kLegendTop = 74.0;
  static constexpr double kLegendLine = 18.0;
};
constexpr std::size_t kMostFronts = kColours.size() * kDashes.size();

Stroke front_stroke(std::size_t i) {
  return {.colour = colour_of(i), .width = 2.0, .dashes = dashes_of(i / kColours.size())};
}

// The front is drawn as stairs: each step is the least error for its bytes.
void draw_front(Svg& svg, const Panel& panel, const measure::Situation& situation, const Stroke& stroke) {
  std::vector<measure::RunCost> front;
  std::ranges::copy_if(situation.runs, std::back_inserter(front), &measure::RunCost::on_front);
  std::ranges::stable_sort(front, {}, &measure::RunCost::bytes_per_s);
  std::vector<Point> stairs;
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (i > 0) stairs.push_back(panel.at(front[i].bytes_per_s, front[i - 1].error_m));
    stairs.push_back(panel.at(front[i].bytes_per_s, front[i].error_m));
  }
  svg.polyline(stairs, stroke);
}

void draw_runs(Svg& svg, const Panel& panel, const measure::Situation& situation, const Stroke& stroke) {
  double label_y = -1.0;
  double label_x = -100.0;
  for (const measure::RunCost& run : situation.runs) {
    const Point at = panel.at(run.bytes_per_s, run.error_m);
    svg.circle(at, 4.0, run.on_front ? stroke.colour : "#fff", {.colour = stroke.colour, .width = 1.6});
    // A number that would cover the one before it is left out; the table has it.
    if (!run.on_front || (std::fabs(at.y - label_y) < 11.0 && std::fabs(at.x - label_x) < 24.0)) continue;
    svg.text({at.x + 6.0, at.y - 5.0}, std::to_string(run.run + 1), {.size = 10.0, .colour = "#444"});
    label_x = at.x;
    label_y = at.y;
  }
}

}  // namespace

std::string pareto_figure(const nlohmann::ordered_json& summary) {
  const std::vector<measure::Situation> situations = measure::pareto_fronts(summary);
  if (std::ranges::none_of(situations, [](const measure::Situation& s) { return s.runs.size() > 1; })) return "";
  Range bytes, errors;
  for (const measure::Situation& s : situations) {
    for (const measure::RunCost& run : s.runs) (bytes.add(run.bytes_per_s), errors.add(run.error_m));
  }
  const double room = 0.05 * (bytes.hi - bytes.lo);
  bytes = {bytes.lo - room, bytes.hi + room};
  const std::size_t drawn = std::min(situations.size(), kMostFronts);
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < drawn; ++i) {
    const std::string& label = situations[i].label;
    legend.push_back({LegendEntry::Mark::kLine, front_stroke(i), label.empty() ? "the front" : label});
  }
  legend.push_back({LegendEntry::Mark::kCircle, {.colour = "#222", .width = 1.6}, "beaten by another"});
  const auto rows = legend_rows(legend, ParetoLayout::kPlotWidth);

  const Box box{ParetoLayout::kLeft,
                ParetoLayout::kLegendTop + ParetoLayout::kLegendLine * static_cast<double>(rows.size()),
                ParetoLayout::kPlotWidth, ParetoLayout::kPlotHeight};
  const bool logarithmic = errors.lo > 0.0;
  const Panel panel = logarithmic ? Panel::log_y(box, bytes, {errors.lo / 1.3, errors.hi * 1.3})
                                  : Panel(box, bytes, from_zero(errors.hi));
  Svg svg(ParetoLayout::kWidth, box.y + box.height + 52.0);
  std::string subtitle =
      "filled, with the run's number: no other run of the same network has less error for no more bytes";
  if (drawn < situations.size())
    subtitle += "; " + std::to_string(situations.size() - drawn) + " networks are left out";
  draw_title(svg, {ParetoLayout::kLeft, 28.0}, ParetoLayout::kPlotWidth,
             summary.at("scenario").get<std::string>() + ": error against bytes", subtitle);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    draw_legend(
        svg,
        {ParetoLayout::kLeft, ParetoLayout::kLegendTop + ParetoLayout::kLegendLine * static_cast<double>(row) + 6.0},
        ParetoLayout::kPlotWidth, rows[row]);
  }
  panel.draw_axes(svg, {.x = "sent by all peers [bytes/s]",
                        .y = logarithmic ? "mean ghost error [m], logarithmic" : "mean ghost error [m]",
                        .x_ticks = 11,
                        .y_ticks = 12});
  for (std::size_t i = 0; i < drawn; ++i) draw_front(svg, panel, situations[i], front_stroke(i));
  for (std::size_t i = 0; i < drawn; ++i) draw_runs(svg, panel, situations[i], front_stroke(i));
  return std::move(svg).finish();
}

}  // namespace peerd::report
