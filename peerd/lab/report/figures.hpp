#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/svg.hpp"

namespace peerd::report {

// The scales that the pictures of one scenario share, so that they can be laid side by side.
struct FigureFrame {
  std::string object;  // path of the principal object; "" if nobody observes any
  int component = 0;   // component of the position that is drawn: 0 x, 1 y, 2 z
  // Axes by latency (the value of network.latency_ms; one for all where runs have none). Runs of one latency have one
  // scale, as in the thesis's appendix A.
  std::map<std::string, Range> position_m;
  std::map<std::string, Range> error_m;
  double rate_max_kB_s = 0.0;       // greatest output of the object's owner in any run
  double peer_rate_max_kB_s = 0.0;  // greatest output of any peer in any run
  double threshold_max_m = 0.0;     // greatest threshold of the object
};

// Finds the scales. The component is the one with the greatest range after the straight line from its first to its last
// value is taken off: of an object that is driven along z and turns in x, that is x.
[[nodiscard]] FigureFrame figure_frame(std::span<const measure::RunRecord> runs, const nlohmann::ordered_json& summary);

// Draws one run in the manner of the thesis's figures A.1 to A.12: position, ghost error and output rate over one time
// axis.
[[nodiscard]] std::string run_figure(const measure::ScenarioInfo& info, const measure::RunRecord& run,
                                     std::size_t number, const FigureFrame& frame);

// Draws, over the same time axis, the output of each peer, the thresholds of the principal object, and the peers'
// statements about contacts.
[[nodiscard]] std::string timeline_figure(const measure::ScenarioInfo& info, const measure::RunRecord& run,
                                          std::size_t number, const FigureFrame& frame);

// Draws all runs: mean ghost error over the numeric swept key with the most values, a line for each combination of the
// other keys, and the updates sent. Bars replace lines where no key is numeric, and a single run has a bar for each
// observer.
[[nodiscard]] std::string overview_figure(const nlohmann::ordered_json& summary);

// Draws the run with the greatest mean ghost error from above (world x and z at one scale): truth and ghosts of the
// principal object, the paths of all others that move, and the outlines of what stands.
[[nodiscard]] std::string plan_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                                      const nlohmann::ordered_json& summary);

// Draws error against bytes of all runs, and the front of runs that no other run beats in both (pareto.hpp). The result
// is empty for less than two runs.
[[nodiscard]] std::string pareto_figure(const nlohmann::ordered_json& summary);

// Draws the runs of a sweep as rows and columns of small pictures, each like run_figure with the same axes: columns are
// the numeric key with the most values, rows the other key with the most, and the values of a third key are colours.
// Pictures are numbered row by row. The result is empty where a sweep does not fit: without a swept key, with more than
// three, or with more values than can be told apart (7 columns, 8 rows, 4 colours).
[[nodiscard]] std::string multiples_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                                           const FigureFrame& frame);

}  // namespace peerd::report
