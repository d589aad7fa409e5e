#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include "peerd/lab/measure/pareto.hpp"
#include "peerd/lab/report/figures.hpp"

namespace peerd::report {
namespace {

constexpr std::size_t kColours = 6;                // that the script tells peers apart by
constexpr std::size_t kMostFronts = kColours * 4;  // with four patterns of dashes

// The front as stairs: each step is the least error for its bytes.
std::vector<Point> stairs_of(const measure::Situation& situation) {
  std::vector<measure::RunCost> front;
  std::ranges::copy_if(situation.runs, std::back_inserter(front), &measure::RunCost::on_front);
  std::ranges::stable_sort(front, {}, &measure::RunCost::bytes_per_s);
  std::vector<Point> stairs;
  for (const measure::RunCost& run : front) {
    if (!stairs.empty()) stairs.push_back({run.bytes_per_s, stairs.back().y});
    stairs.push_back({run.bytes_per_s, run.error_m});
  }
  return stairs;
}

// The runs that are on the front, or those that are not, with their numbers.
Json runs_of(const std::string& name, std::size_t colour, const measure::Situation& situation, bool on_front) {
  std::vector<Point> points;
  Json numbers = Json::array();
  for (const measure::RunCost& run : situation.runs) {
    if (run.on_front != on_front) continue;
    points.push_back({run.bytes_per_s, run.error_m});
    numbers.push_back("run " + std::to_string(run.run + 1));
  }
  return curve(points, {{"name", name},
                        {"colour", colour},
                        {"mark", on_front ? "disc" : "ring"},
                        {"line", false},
                        {"labels", numbers},
                        {"written", on_front}});
}

}  // namespace

Json pareto_figure(const Json& summary) {
  const std::vector<measure::Situation> situations = measure::pareto_fronts(summary);
  if (std::ranges::none_of(situations, [](const measure::Situation& s) { return s.runs.size() > 1; })) return nullptr;
  Range errors;
  for (const measure::Situation& s : situations) {
    for (const measure::RunCost& run : s.runs) errors.add(run.error_m);
  }
  const std::size_t drawn = std::min(situations.size(), kMostFronts);
  Json series = Json::array();
  for (std::size_t i = 0; i < drawn; ++i) {
    const std::string name = situations[i].label.empty() ? "the front" : situations[i].label;
    series.push_back(
        curve(stairs_of(situations[i]), {{"name", name}, {"colour", i}, {"width", 2}, {"dash", i / kColours}}));
    for (const bool on_front : {false, true}) {
      if (Json runs = runs_of(name, i, situations[i], on_front); !runs["x"].empty()) series.push_back(std::move(runs));
    }
  }
  const bool logarithmic = errors.lo > 0.0;
  std::string label = "mean ghost error [m]";
  if (logarithmic) label += ", logarithmic";
  std::string subtitle =
      "filled, with the run's number: no other run of the same network has less error for no more bytes";
  if (drawn < situations.size())
    subtitle += "; " + std::to_string(situations.size() - drawn) + " networks are left out";
  Json panel{{"height", 320},
             {"x", {{"label", "sent by all peers [bytes/s]"}}},
             {"y", {{"label", label}, {logarithmic ? "log" : "zero", true}}},
             {"near", "xy"},
             {"series", series}};
  return figure_of(summary.at("scenario").get<std::string>() + ": error against bytes", subtitle,
                   Json::array({std::move(panel)}));
}

}  // namespace peerd::report
