#include "peerd/lab/measure/pareto.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "peerd/lab/measure/sweep.hpp"

namespace peerd::measure {
namespace {

using Json = nlohmann::ordered_json;

// An object that stands still is known everywhere and would only dilute the error.
std::set<std::string> objects_that_err(const Json& summary) {
  std::set<std::string> paths;
  for (const Json& run : summary.at("runs")) {
    for (const Json& row : run.at("objects")) {
      if (row.at("ghost_error_m").at("max").get<double>() > 0.0) paths.insert(row.at("path").get<std::string>());
    }
  }
  return paths;
}

std::optional<double> mean_error_m(const Json& run, const std::set<std::string>& paths) {
  double sum_m = 0.0;
  std::size_t rows = 0;
  for (const Json& row : run.at("objects")) {
    if (row.at("samples") == 0 || !paths.contains(row.at("path").get<std::string>())) continue;
    sum_m += row.at("ghost_error_m").at("mean").get<double>();
    ++rows;
  }
  if (rows == 0) return std::nullopt;
  return sum_m / static_cast<double>(rows);
}

bool beats(const RunCost& a, const RunCost& b) {
  return a.error_m <= b.error_m && a.bytes_per_s <= b.bytes_per_s &&
         (a.error_m < b.error_m || a.bytes_per_s < b.bytes_per_s);
}

}  // namespace

std::vector<Situation> pareto_fronts(const Json& summary) {
  const std::set<std::string> paths = objects_that_err(summary);
  std::vector<Params> params;
  for (const Json& run : summary.at("runs")) params.push_back(run.at("params"));
  std::vector<std::string> given = varying_keys(params);
  std::erase_if(given, [](const std::string& key) { return !key.starts_with("network.") && key != "seed"; });

  std::vector<Situation> situations;
  for (std::size_t i = 0; i < params.size(); ++i) {
    const Json& run = summary.at("runs")[i];
    const std::optional<double> error_m = mean_error_m(run, paths);
    if (!error_m) continue;
    const std::string label = describe(params[i], given);
    auto it = std::ranges::find(situations, label, &Situation::label);
    if (it == situations.end()) it = situations.insert(it, Situation{label, {}});
    it->runs.push_back({i, *error_m, run.at("traffic").at("bytes_per_s").get<double>()});
  }
  for (Situation& s : situations) {
    for (RunCost& run : s.runs) {
      run.on_front = std::ranges::none_of(s.runs, [&](const RunCost& other) { return beats(other, run); });
    }
  }
  return situations;
}

}  // namespace peerd::measure
