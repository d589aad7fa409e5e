#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/table.hpp"

namespace peerd::report {
namespace {

constexpr std::size_t kMostBars = 60;  // thinner bars cannot be read

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

// The panels of a single run: its observers side by side, and the updates of each object.
Json single_panels(const Json& run, const std::string& path) {
  Json errors = Json::array(), bars = Json::array();
  std::vector<std::pair<std::string, double>> updates;
  std::set<std::string> seen;
  std::size_t observer = 0;
  for (const Json& row : run.at("objects")) {
    const auto object = row.at("path").get<std::string>();
    if (seen.insert(object).second) updates.emplace_back(object, row.at("updates_sent").get<double>());
    if (object != path) continue;
    for (const char* name : {"mean", "p99", "max"}) {
      errors.push_back({{"label", row.at("observer").get<std::string>() + ", " + name},
                        {"value", row.at("ghost_error_m").at(name)},
                        {"colour", observer}});
    }
    ++observer;
  }
  std::string title = "updates sent";
  if (updates.size() > kMostBars) {
    std::ranges::stable_sort(updates, std::ranges::greater{}, &std::pair<std::string, double>::second);
    title += ", the " + std::to_string(kMostBars) + " most updated of " + std::to_string(updates.size()) + " objects";
    updates.resize(kMostBars);
  }
  for (const auto& [object, count] : updates) bars.push_back({{"label", object}, {"value", count}, {"colour", "bar"}});
  return Json::array(
      {{{"title", "ghost error of " + path + " [m]"}, {"bars", errors}}, {{"title", title}, {"bars", bars}}});
}

// The points of several runs. Those with one `label` are a line over x, whose colour is that of the last key but x, and
// whose dashes are those of the keys before it.
Json points_of(const std::vector<RunPoint>& points, const std::vector<std::string>& keys,
               const std::optional<std::string>& x) {
  std::vector<std::string> others = keys;
  if (x) std::erase(others, *x);
  Json rows = Json::array();
  for (const RunPoint& p : points) {
    if (!p.seen) continue;
    Json dash = Json::array();
    for (std::size_t k = 0; k + 1 < others.size(); ++k) dash.push_back(measure::value_text(p.params, others[k]));
    rows.push_back({{"label", measure::describe(p.params, others)},
                    {"whole", measure::describe(p.params, keys)},
                    {"x", x ? p.params.at(*x) : Json(nullptr)},
                    {"colour", others.empty() ? "" : measure::value_text(p.params, others.back())},
                    {"dash", dash.dump(-1, ' ', false, Json::error_handler_t::replace)},
                    {"error_m", p.error_m},
                    {"updates", p.updates}});
  }
  return rows;
}

}  // namespace

Json overview_figure(const Json& summary) {
  const std::string path = principal_object(summary);
  std::vector<RunPoint> points;
  std::vector<measure::Params> params;
  for (const Json& run : summary.at("runs")) points.push_back(run_point(run, path));
  points = mean_points(points, summary.value("repeat", 1u));
  for (const RunPoint& point : points) params.push_back(point.params);
  const std::vector<std::string> keys = measure::varying_keys(params);
  const std::optional<std::string> x = x_key(points, keys);
  std::string subtitle = summary.at("mode").get<std::string>() + ", seed " + summary.at("seed").dump() + ", " +
                         std::to_string(points.size()) + (points.size() == 1 ? " run" : " runs");
  if (summary.contains("repeat")) {
    subtitle +=
        (points.size() == 1 ? ", the first of " : ", each the mean over ") + summary.at("repeat").dump() + " seeds";
  }
  if (path.empty()) subtitle += ": no object that another peer observes";
  const std::string title = summary.at("scenario").get<std::string>() + (path.empty() ? "" : ": " + path);
  Json figure =
      figure_of(title, subtitle,
                !path.empty() && points.size() == 1 ? single_panels(summary.at("runs").front(), path) : Json::array());
  figure["width"] = 470;
  if (path.empty() || points.size() < 2) return figure;
  figure["kind"] = "overview";
  figure["axis"] = x ? Json(measure::axis_label(*x, keys)) : Json(nullptr);
  figure["points"] = points_of(points, keys, x);
  return figure;
}

}  // namespace peerd::report
