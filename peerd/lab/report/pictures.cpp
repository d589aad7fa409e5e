#include "peerd/lab/report/pictures.hpp"

#include <algorithm>

#include "peerd/lab/report/figures.hpp"

namespace peerd::report {

Pictures draw_pictures(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                       const nlohmann::ordered_json& summary) {
  const FigureFrame frame = figure_frame(runs, summary);
  Pictures pictures{.overview = overview_figure(summary),
                    .pareto = pareto_figure(summary),
                    .multiples = multiples_figure(info, runs, frame),
                    .plan = plan_figure(info, runs, summary),
                    .runs = {}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    pictures.runs.push_back({run_figure(info, runs[i], i + 1, frame), timeline_figure(info, runs[i], i + 1, frame)});
  }
  return pictures;
}

std::string picture_file(std::string_view kind, std::size_t number) {
  const std::string digits = std::to_string(number);
  return std::string(kind) + '-' + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits + ".svg";
}

}  // namespace peerd::report
