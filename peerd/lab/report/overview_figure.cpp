#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/table.hpp"

namespace peerd::report {
namespace {

using Json = nlohmann::ordered_json;

struct OverviewLayout {  // [px]
  static constexpr double kWidth = 1140.0;
  static constexpr double kHeight = 470.0;
  static constexpr Box kLeftBox{70.0, 92.0, 510.0, 310.0};
  static constexpr Box kRightBox{620.0, 92.0, 500.0, 310.0};
};

// The numbers of a run that the overview shows: means over the observers of the principal object.
struct RunPoint {
  measure::Params params;
  double error_m = 0.0;
  double updates = 0.0;
  bool seen = false;
};

RunPoint run_point(const Json& run, const std::string& path) {
  RunPoint point{.params = run.at("params")};
  double observers = 0.0;
  for (const Json& row : run.at("objects")) {
    if (row.at("path") != path) continue;
    point.error_m += row.at("ghost_error_m").at("mean").get<double>();
    point.updates = row.at("updates_sent").get<double>();
    observers += 1.0;
  }
  point.seen = observers > 0.0;
  if (point.seen) point.error_m /= observers;
  return point;
}

// Runs that differ in their seed alone are one point, which is their mean.
std::vector<RunPoint> mean_points(const std::vector<RunPoint>& runs, std::size_t repeat) {
  std::vector<RunPoint> points;
  for (std::size_t first = 0; first + repeat <= runs.size(); first += repeat) {
    RunPoint& point = points.emplace_back(runs[first]);
    for (std::size_t i = first + 1; i < first + repeat; ++i) {
      point.error_m += runs[i].error_m;
      point.updates += runs[i].updates;
    }
    point.error_m /= static_cast<double>(repeat);
    point.updates /= static_cast<double>(repeat);
  }
  return points;
}

// The swept key of the x axis: numeric in every run, with the most values, and the first among equals.
std::optional<std::string> x_key(const std::vector<RunPoint>& points, const std::vector<std::string>& keys) {
  std::optional<std::string> best;
  std::size_t most = 1;
  for (const std::string& key : keys) {
    std::set<double> values;
    bool numeric = true;
    for (const RunPoint& p : points) {
      const auto it = p.params.find(key);
      numeric = numeric && it != p.params.end() && it->is_number();
      if (numeric) values.insert(it->get<double>());
    }
    if (numeric && values.size() > most) {
      best = key;
      most = values.size();
    }
  }
  return best;
}

struct Combination {  // values of all keys except that of the x axis
  std::string label;
  std::vector<const RunPoint*> runs;
  std::size_t colour = 0;
  std::size_t dashes = 0;
};

std::size_t index_in(std::vector<std::string>& list, const std::string& value) {
  const auto it = std::ranges::find(list, value);
  const auto index = static_cast<std::size_t>(it - list.begin());
  if (it == list.end()) list.push_back(value);
  return index;
}

// Colours tell the values of the last key apart, and patterns of dashes those of the keys before it.
std::vector<Combination> combinations_of(const std::vector<RunPoint>& points, const std::vector<std::string>& all_keys,
                                         const std::optional<std::string>& x) {
  std::vector<std::string> keys = all_keys;
  if (x) std::erase(keys, *x);
  std::vector<Combination> combinations;
  std::vector<std::string> last_values;
  std::vector<std::string> other_values;
  for (const RunPoint& p : points) {
    if (!p.seen) continue;
    const std::string label = measure::describe(p.params, keys);
    auto it = std::ranges::find(combinations, label, &Combination::label);
    if (it == combinations.end()) {
      std::string others;
      for (std::size_t k = 0; k + 1 < keys.size(); ++k) others += measure::value_text(p.params, keys[k]) + '\n';
      const std::size_t colour = keys.empty() ? 0 : index_in(last_values, measure::value_text(p.params, keys.back()));
      it = combinations.insert(it, {label, {}, colour, index_in(other_values, others)});
    }
    it->runs.push_back(&p);
  }
  return combinations;
}

double mean_of(const Combination& c, double RunPoint::*what) {
  double sum = 0.0;
  for (const RunPoint* run : c.runs) sum += run->*what;
  return sum / static_cast<double>(c.runs.size());
}

Stroke line_stroke(const Combination& c) {
  return {.colour = colour_of(c.colour), .width = 2.0, .dashes = dashes_of(c.dashes)};
}

void draw_lines(Svg& svg, const std::vector<Combination>& combinations, const std::string& x, const std::string& axis) {
  Range xs;
  double most_m = 0.0;
  xs.add(0.0);
  bool negative = false;
  for (const Combination& c : combinations) {
    for (const RunPoint* run : c.runs) {
      xs.add(run->params.at(x).get<double>());
      most_m = std::max(most_m, run->error_m);
      negative = negative || run->params.at(x).get<double>() < 0.0;
    }
  }
  xs.hi += 0.03 * (xs.hi - xs.lo);
  if (negative) xs.lo -= 0.03 * (xs.hi - xs.lo);
  const Panel panel(OverviewLayout::kLeftBox, xs, from_zero(most_m));
  panel.draw_axes(svg, {.x = axis, .y = "mean ghost error [m]", .x_ticks = 9, .y_ticks = 9});
  for (const Combination& c : combinations) {
    std::vector<Point> data;
    for (const RunPoint* run : c.runs) data.push_back({run->params.at(x).get<double>(), run->error_m});
    std::ranges::stable_sort(data, {}, &Point::x);
    panel.draw_curve(svg, data, line_stroke(c));
    for (const Point& p : data) {
      svg.circle(panel.at(p.x, p.y), 3.2, c.dashes == 0 ? colour_of(c.colour) : "#fff",
                 {.colour = colour_of(c.colour), .width = 1.6});
    }
  }
}

// Bars with samples of the lines are also the lines' legend, which then never lies over the curves.
std::vector<BarEntry> combination_bars(const std::vector<Combination>& combinations, double RunPoint::*what,
                                       bool lines) {
  std::vector<BarEntry> bars;
  for (const Combination& c : combinations) {
    bars.push_back({c.label, mean_of(c, what), colour_of(c.colour), {}});
    if (lines) bars.back().line = line_stroke(c);
  }
  return bars;
}

struct BarPanel {
  std::string title;
  std::vector<BarEntry> bars;
  int decimals = 0;
};

constexpr std::size_t kMostBars = 60;  // thinner bars cannot be read

// The panels of a single run: its observers side by side, and the updates of each object.
std::array<BarPanel, 2> single_panels(const Json& run, const std::string& path) {
  BarPanel errors{"ghost error of " + path + " [m]", {}, 3};
  BarPanel updates{"updates sent", {}, 0};
  std::set<std::string> seen;
  std::size_t observer = 0;
  for (const Json& row : run.at("objects")) {
    const auto object = row.at("path").get<std::string>();
    if (seen.insert(object).second) {
      updates.bars.push_back({object, row.at("updates_sent").get<double>(), kBarColour, {}});
    }
    if (object != path) continue;
    for (const char* name : {"mean", "p99", "max"}) {
      errors.bars.push_back({row.at("observer").get<std::string>() + ", " + name,
                             row.at("ghost_error_m").at(name).get<double>(),
                             colour_of(observer),
                             {}});
    }
    ++observer;
  }
  if (updates.bars.size() > kMostBars) {
    std::ranges::stable_sort(updates.bars, std::ranges::greater{}, &BarEntry::value);
    updates.title +=
        ", the " + std::to_string(kMostBars) + " most updated of " + std::to_string(updates.bars.size()) + " objects";
    updates.bars.resize(kMostBars);
  }
  return {errors, updates};
}

// The panels of several runs: errors (where they are not lines over x) and updates by combination.
std::array<BarPanel, 2> sweep_panels(const std::vector<Combination>& combinations, const std::vector<std::string>& keys,
                                     bool lines) {
  BarPanel errors{"mean ghost error [m], mean over the observers", {}, 3};
  BarPanel updates{"updates sent", {}, 0};
  if (lines && keys.size() == 1 && !combinations.empty()) {  // the cost of a single line changes along it
    for (const RunPoint* run : combinations.front().runs) {
      updates.bars.push_back({measure::describe(run->params, keys), run->updates, colour_of(0), {}});
    }
    return {errors, updates};
  }
  if (lines) updates.title += ", mean over the runs of a line";
  updates.bars = combination_bars(combinations, &RunPoint::updates, lines);
  if (!lines) errors.bars = combination_bars(combinations, &RunPoint::error_m, lines);
  return {errors, updates};
}

}  // namespace

std::string overview_figure(const Json& summary) {
  const std::string path = principal_object(summary);
  std::vector<RunPoint> points;
  std::vector<measure::Params> params;
  for (const Json& run : summary.at("runs")) points.push_back(run_point(run, path));
  points = mean_points(points, summary.value("repeat", 1u));
  for (const RunPoint& point : points) params.push_back(point.params);
  const std::vector<std::string> keys = measure::varying_keys(params);
  const std::optional<std::string> x = x_key(points, keys);
  const std::vector<Combination> combinations = combinations_of(points, keys, x);
  std::array<BarPanel, 2> panels;
  if (!path.empty() && points.size() == 1) panels = single_panels(summary.at("runs").front(), path);
  if (points.size() > 1) panels = sweep_panels(combinations, keys, x.has_value());

  // Bars alone need less height than lines.
  const auto bars_height = kBarPitch * static_cast<double>(std::max(panels[0].bars.size(), panels[1].bars.size()));
  Svg svg(OverviewLayout::kWidth,
          x ? OverviewLayout::kHeight
            : OverviewLayout::kLeftBox.y + std::min(bars_height, OverviewLayout::kLeftBox.height) + 24.0);
  const std::string title = summary.at("scenario").get<std::string>() + (path.empty() ? "" : ": " + path);
  std::string subtitle = summary.at("mode").get<std::string>() + ", seed " + summary.at("seed").dump() + ", " +
                         std::to_string(points.size()) + (points.size() == 1 ? " run" : " runs");
  if (summary.contains("repeat")) {
    subtitle +=
        (points.size() == 1 ? ", the first of " : ", each the mean over ") + summary.at("repeat").dump() + " seeds";
  }
  if (path.empty()) subtitle += ": no object that another peer observes";
  draw_title(svg, {OverviewLayout::kLeftBox.x, 28.0}, OverviewLayout::kWidth - OverviewLayout::kLeftBox.x - 20.0, title,
             subtitle);
  if (path.empty()) return std::move(svg).finish();
  if (x) {
    svg.text({OverviewLayout::kLeftBox.x, OverviewLayout::kLeftBox.y - 10.0},
             "mean ghost error, mean over the observers", {.size = 12.0});
    draw_lines(svg, combinations, *x, measure::axis_label(*x, keys));
  } else {
    draw_bars(svg, OverviewLayout::kLeftBox, panels[0].title, panels[0].bars, panels[0].decimals);
  }
  draw_bars(svg, OverviewLayout::kRightBox, panels[1].title, panels[1].bars, panels[1].decimals);
  return std::move(svg).finish();
}

}  // namespace peerd::report
