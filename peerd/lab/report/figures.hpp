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

// All runs: mean ghost error over the numeric swept key with the most values, a line for each combination of the other
// keys, and the updates sent. Bars replace lines where no key is numeric. A single run has a bar for each observer.
[[nodiscard]] Json overview_figure(const Json& summary);

// The run with the greatest mean ghost error from above (world x and z): truth and ghosts of the principal object, the
// paths of all others that move, and the outlines of what stands. The script chooses the part of the world.
[[nodiscard]] Json plan_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                               const Json& summary);

// Error against bytes of all runs, and the front of runs that no other run beats in both (pareto.hpp). The result is
// null for less than two runs.
[[nodiscard]] Json pareto_figure(const Json& summary);

// The order of the runs of a sweep in rows and columns of small figures, which the script makes of their data: columns
// are the numeric key with the most values, rows the other key with the most, and the values of a third key are
// colours. Cells are numbered row by row. The result is null where a sweep does not fit: without a swept key, with more
// than three, or with more values than can be told apart (7 columns, 8 rows, 4 colours).
[[nodiscard]] Json multiples_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                                    const FigureChoice& choice);

// All data of a report's figures. What does not apply is null.
struct Figures {
  Json overview, pareto, multiples, plan;
  std::vector<Json> runs;
};
[[nodiscard]] Figures make_figures(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                                   const Json& summary);

}  // namespace peerd::report
