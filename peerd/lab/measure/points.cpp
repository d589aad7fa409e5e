#include "peerd/lab/measure/points.hpp"

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/lab/measure/statistics/interval.hpp"
#include "peerd/peer/config/measures.hpp"

namespace peerd::measure {
namespace {

using Json = nlohmann::ordered_json;

// "/ghost_error_m/mean" of "ghost_error_m.mean".
Json::json_pointer pointer_to(std::string_view name) {
  std::string path = "/" + std::string(name);
  for (char& c : path) {
    if (c == '.') c = '/';
  }
  return Json::json_pointer(path);
}

Json interval_json(const std::vector<double>& values) {
  const Interval i = interval_95(values);
  return {{"mean", i.mean}, {"half_width_95", i.half_width}};
}

// Puts into `point` those measures of `rows` that all rows have.
void add_measures(Json& point, const std::vector<const Json*>& rows, bool of_view) {
  for (const config::Measure& m : config::measures()) {
    if (m.of_view != of_view || m.yes_or_no) continue;
    const auto at = pointer_to(m.name);
    std::vector<double> values;
    for (const Json* row : rows) {
      if (m.error && row->at("samples") == 0) continue;
      if (row->contains(at)) values.push_back(row->at(at).get<double>());
    }
    if (!values.empty()) point[at] = interval_json(values);
  }
}

}  // namespace

Json points_json(const Json& runs, std::uint32_t repeat) {
  Json points = Json::array();
  for (std::size_t first = 0; first + repeat <= runs.size(); first += repeat) {
    std::vector<const Json*> same;
    Json numbers = Json::array();
    for (std::size_t i = first; i < first + repeat; ++i) {
      same.push_back(&runs[i]);
      numbers.push_back(i + 1);
    }
    Json point = {{"params", same.front()->at("params")}, {"runs", std::move(numbers)}, {"objects", Json::array()}};
    // All runs of a point have the same rows.
    for (std::size_t row = 0; row < same.front()->at("objects").size(); ++row) {
      std::vector<const Json*> views;
      for (const Json* run : same) views.push_back(&run->at("objects")[row]);
      Json view;
      for (const char* key : {"path", "owner", "observer"}) view[key] = views.front()->at(key);
      add_measures(view, views, true);
      point["objects"].push_back(std::move(view));
    }
    add_measures(point, same, false);
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace peerd::measure
