#include <algorithm>
#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "peerd/input/json_text.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/table.hpp"

namespace peerd::report {
namespace {

constexpr std::size_t kMostBars = 60;  // thinner bars cannot be read

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

}  // namespace

Json sweep_data(const Json& summary) {
  const std::string path = principal_object(summary);
  std::vector<measure::Params> params;
  for (const Json& run : summary.at("runs")) params.push_back(run.at("params"));
  const std::vector<std::string> keys = measure::varying_keys(params);
  Json sweep{{"repeat", summary.value("repeat", 1u)}, {"keys", Json::array()}, {"runs", Json::array()}};
  for (const std::string& key : keys) sweep["keys"].push_back(measure::axis_label(key, keys));
  for (const Json& run : summary.at("runs")) {
    Json values = Json::array(), words = Json::array();
    for (const std::string& key : keys) {
      values.push_back(run.at("params").value(key, Json()));
      words.push_back(measure::describe(run.at("params"), key, keys));
    }
    double error_m = 0.0, updates = 0.0, observers = 0.0;
    for (const Json& row : run.at("objects")) {
      if (row.at("path") != path) continue;
      error_m += row.at("ghost_error_m").at("mean").get<double>();
      updates = row.at("updates_sent").get<double>();
      observers += 1.0;
    }
    sweep["runs"].push_back({{"values", values},
                             {"words", words},
                             {"error_m", observers > 0.0 ? Json(error_m / observers) : Json(nullptr)},
                             {"updates", updates}});
  }
  return sweep;
}

Json overview_figure(const Json& summary) {
  const std::string path = principal_object(summary);
  const std::size_t repeat = summary.value("repeat", 1u), points = summary.at("runs").size() / repeat;
  std::string subtitle = summary.at("mode").get<std::string>() + ", seed " + json_line(summary.at("seed")) + ", " +
                         std::to_string(points) + (points == 1 ? " run" : " runs");
  if (repeat > 1)
    subtitle += (points == 1 ? ", the first of " : ", each the mean over ") + std::to_string(repeat) + " seeds";
  if (path.empty()) subtitle += ": no object that another peer observes";
  const bool single = !path.empty() && points == 1;
  Json figure = figure_of(summary.at("scenario").get<std::string>() + (path.empty() ? "" : ": " + path), subtitle,
                          single ? single_panels(summary.at("runs").front(), path) : Json::array());
  figure["width"] = 470;
  if (!path.empty() && points > 1) figure["kind"] = "overview";
  return figure;
}

}  // namespace peerd::report
