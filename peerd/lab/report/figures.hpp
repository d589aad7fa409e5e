#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/figure_json.hpp"

namespace peerd::report {

// The choices that all figures of one scenario share, so that they can be laid side by side.
struct FigureChoice {
  std::string object;         // path of the principal object; "" if nobody observes any
  int component = 0;          // component of the position that is drawn: 0 x, 1 y, 2 z
  std::size_t buckets = 700;  // parts of a line's length, each of which has two points at most; fewer of many runs
};

// The component is the one with the greatest range after the straight line from its first to its last value is taken
// off: of an object that is driven along z and turns in x, that is x.
[[nodiscard]] FigureChoice figure_choice(std::span<const measure::RunRecord> runs, const Json& summary);

// What happened in one run. The script draws two figures of it: position, ghost error and output rate over one time
// axis, in the manner of the thesis's figures A.1 to A.12; and the output of each peer, the thresholds of the principal
// object and the peers' statements about contacts.
[[nodiscard]] Json run_data(const measure::ScenarioInfo& info, const measure::RunRecord& run, std::size_t number,
                            const FigureChoice& choice);

// The values of the swept keys in all runs, the mean ghost errors of the principal object and its updates. The script
// makes two figures of it: the overview, and small figures of all runs in rows and columns.
[[nodiscard]] Json sweep_data(const Json& summary);

// The title of the overview of all runs; of a single run the figure, with a bar for each observer.
[[nodiscard]] Json overview_figure(const Json& summary);

// The run with the greatest mean ghost error from above (world x and z): truth and ghosts of the principal object, the
// paths of all others that move, and the outlines of what stands. The script chooses the part of the world.
[[nodiscard]] Json plan_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                               const Json& summary);

// Error against bytes of all runs, and the front of runs that no other run beats in both (pareto.hpp). The result is
// null for less than two runs.
[[nodiscard]] Json pareto_figure(const Json& summary);

// All data of a report's figures. What does not apply is null.
struct Figures {
  Json sweep, overview, pareto, plan;
  std::vector<Json> runs;
};
[[nodiscard]] Figures make_figures(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                                   const Json& summary);

}  // namespace peerd::report
