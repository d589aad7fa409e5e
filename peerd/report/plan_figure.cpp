#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "peerd/measure/agreement.hpp"
#include "peerd/measure/lookup.hpp"
#include "peerd/measure/sweep.hpp"
#include "peerd/report/figure_parts.hpp"
#include "peerd/report/figures.hpp"
#include "peerd/report/table.hpp"

namespace peerd::report {
namespace {

struct PlanLayout {  // [px]
  static constexpr double kLeft = 70.0;
  static constexpr double kTop = 86.0;
  static constexpr double kLongest = 1040.0;  // length of the longer side
  static constexpr double kLeast = 60.0;      // least length of the shorter side, for paths that are nearly straight
};

// Maps world axes to the page. The longer extent is horizontal, so that a road fits. The view is from +y; where z is
// horizontal, -z points right.
struct PlanAxes {
  int across = 0;
  int up = 2;
  double across_sign = 1.0;
  double up_sign = -1.0;  // x right, -z up: as on a map
  [[nodiscard]] Point of(const Vec3& p) const { return {across_sign * p[across], up_sign * p[up]}; }
};

struct PlanPaths {
  std::vector<Vec3> truth;
  std::vector<std::vector<Vec3>> ghosts;  // one for each observer
  std::vector<Vec3> others;               // the first places of all other objects that are replicated
};

// A PlanFrame holds the place and the scale of the plan on the page.
struct PlanFrame {
  PlanAxes axes;
  Range across, up;  // [m]
  Box box;           // [px]
};

std::size_t worst_run(const nlohmann::ordered_json& summary, const std::string& path) {
  std::size_t worst = 0;
  double worst_m = -1.0;
  const auto& runs = summary.at("runs");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    double sum_m = 0.0;
    for (const auto& row : runs[i].at("objects")) {
      if (row.at("path") == path) sum_m += row.at("ghost_error_m").at("mean").get<double>();
    }
    if (sum_m > worst_m) {
      worst_m = sum_m;
      worst = i;
    }
  }
  return worst;
}

std::vector<Point> on_page(const std::vector<Vec3>& path, const PlanAxes& axes) {
  std::vector<Point> points;
  for (const Vec3& p : path) points.push_back(axes.of(p));
  return points;
}

std::vector<Point> in_pixels(const std::vector<Point>& points, const Panel& panel) {
  std::vector<Point> pixels;
  for (const Point& p : points) pixels.push_back(panel.at(p.x, p.y));
  return pixels;
}

std::string axis_name(int axis, double sign) {
  return std::string(sign < 0.0 ? "−" : "") + (axis == 0 ? "x" : "z") + " [m]";
}

PlanPaths paths_of(const RunRecord& run, const ObjectInfo& object, std::span<const PeerInfo> observers) {
  PlanPaths paths;
  for (const TruthSample& s : truth_of(run, object)) paths.truth.push_back(s.position);
  for (const PeerInfo& observer : observers) {
    paths.ghosts.emplace_back();
    for (const GhostSample& s : ghost_samples_of(run, observer.peer, object.object)) {
      paths.ghosts.back().push_back(s.ghost.position);
    }
  }
  for (const ObjectInfo& other : run.objects) {
    if (other.object == object.object) continue;
    const std::vector<PeerInfo> by = observers_of(run, other);
    if (!by.empty()) {
      paths.others.push_back(ghost_samples_of(run, by.front().peer, other.object).front().truth.position);
    }
  }
  return paths;
}

// All paths with a margin, at one scale for both axes.
PlanFrame frame_of(const PlanPaths& paths) {
  Range x, z;
  const auto add = [&](const std::vector<Vec3>& points) {
    for (const Vec3& p : points) (x.add(p.x()), z.add(p.z()));
  };
  add(paths.truth);
  for (const auto& ghost : paths.ghosts) add(ghost);
  add(paths.others);
  x = drawable(x);
  z = drawable(z);

  PlanFrame frame;
  auto& [axes, across, up, box] = frame;
  if (z.hi - z.lo > x.hi - x.lo) axes = {2, 0, -1.0, -1.0};
  for (const double px : {x.lo, x.hi}) {
    for (const double pz : {z.lo, z.hi}) {
      const Point p = axes.of({px, 0.0, pz});
      across.add(p.x);
      up.add(p.y);
    }
  }
  const double room = 0.02 * (across.hi - across.lo);
  across = {across.lo - room, across.hi + room};
  up = {up.lo - room, up.hi + room};
  const double scale = PlanLayout::kLongest / (across.hi - across.lo);  // pixels per metre
  const double least_m = PlanLayout::kLeast / scale;
  if (up.hi - up.lo < least_m) {
    const double middle = 0.5 * (up.lo + up.hi);
    up = {middle - 0.5 * least_m, middle + 0.5 * least_m};
  }
  box = {PlanLayout::kLeft, PlanLayout::kTop, PlanLayout::kLongest, (up.hi - up.lo) * scale};
  return frame;
}

void draw_paths(Svg& svg, const PlanPaths& paths, std::span<const PeerInfo> observers, const PlanAxes& axes,
                const Panel& panel) {
  using Mark = LegendEntry::Mark;
  const Stroke truth{.colour = kTruthColour, .width = 5.0};
  std::vector<LegendEntry> legend{{Mark::kLine, truth, "truth"}};
  svg.polyline(in_pixels(on_page(paths.truth, axes), panel), truth);
  for (std::size_t i = 0; i < observers.size(); ++i) {
    svg.polyline(in_pixels(on_page(paths.ghosts[i], axes), panel), observer_stroke(i));
    legend.push_back({Mark::kLine, observer_stroke(i), "ghost at " + observers[i].name});
  }
  if (!paths.others.empty()) {
    for (const Point& at : in_pixels(on_page(paths.others, axes), panel)) {
      if (std::isfinite(at.x) && std::isfinite(at.y)) svg.rect({at.x - 3.5, at.y - 3.5, 7.0, 7.0}, "#444");
    }
    legend.push_back({Mark::kSquare, {.colour = "#444"}, "other objects at the start"});
  }
  draw_legend(svg, {PlanLayout::kLeft, PlanLayout::kTop - 10.0}, PlanLayout::kLongest, legend);
}

}  // namespace

std::string plan_figure(const ScenarioInfo& info, std::span<const RunRecord> runs,
                        const nlohmann::ordered_json& summary) {
  const std::string path = principal_object(summary);
  const std::size_t number = worst_run(summary, path);
  const ObjectInfo* object = number < runs.size() ? find_object(runs[number], path) : nullptr;
  const std::vector<PeerInfo> observers = object ? observers_of(runs[number], *object) : std::vector<PeerInfo>{};
  if (observers.empty()) {
    Svg svg(800.0, 80.0);
    draw_title(svg, {PlanLayout::kLeft, 28.0}, 700.0, info.name, "no object that another peer observes");
    return std::move(svg).finish();
  }
  const RunRecord& run = runs[number];
  const PlanPaths paths = paths_of(run, *object, observers);
  const PlanFrame frame = frame_of(paths);

  Svg svg(PlanLayout::kLongest + PlanLayout::kLeft + 20.0, frame.box.height + PlanLayout::kTop + 52.0);
  std::vector<std::string> keys;
  for (const auto& item : run.params.items()) keys.push_back(item.key());
  draw_title(svg, {PlanLayout::kLeft, 28.0}, PlanLayout::kLongest,
             info.name + " from above" + (keys.empty() ? "" : ": " + describe(run.params, keys)),
             object->path + ", run " + std::to_string(number + 1) +
                 (runs.size() > 1 ? ", the one with the greatest mean ghost error" : ""));
  const Panel panel(frame.box, frame.across, frame.up);
  panel.draw_axes(svg, {.x = axis_name(frame.axes.across, frame.axes.across_sign),
                        .y = axis_name(frame.axes.up, frame.axes.up_sign),
                        .x_ticks = 16,
                        .y_ticks = std::clamp(static_cast<int>(frame.box.height / 28.0), 3, 16)});
  draw_paths(svg, paths, observers, frame.axes, panel);
  return std::move(svg).finish();
}

}  // namespace peerd::report
