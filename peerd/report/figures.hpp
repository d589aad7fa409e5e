#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "peerd/measure/run_record.hpp"
#include "peerd/measure/summary.hpp"
#include "peerd/report/svg.hpp"

namespace peerd::report {

// What the pictures of one scenario have in common, so that they can be laid side by side.
struct FigureFrame {
  std::string object;  // path of the principal object; "" if nobody observes any
  int component = 0;   // of its position that is drawn: 0 x, 1 y, 2 z
  // Axes, by latency (value of network.latency_ms; one for all where runs have none): the same scale for the same
  // latency, as in the seed's appendix A.
  std::map<std::string, Range> position_m;
  std::map<std::string, Range> error_m;
  double rate_max_kB_s = 0.0;       // of the owner's output, over all runs
  double peer_rate_max_kB_s = 0.0;  // of any peer's
  double threshold_max_m = 0.0;     // that was in force for the object
};

// The component is the one with the greatest range once the straight line from its first to its last value is taken
// off: of an object that is driven along z and turns in x, that is x.
[[nodiscard]] FigureFrame figure_frame(std::span<const RunRecord> runs, const nlohmann::ordered_json& summary);

// One run in the manner of the seed's figures A.1 to A.12: position, ghost error and output rate over one time axis.
[[nodiscard]] std::string run_figure(const ScenarioInfo& info, const RunRecord& run, std::size_t number,
                                     const FigureFrame& frame);

// The same time axis once more: what each peer sends, the thresholds in force for the principal object, and who said
// what of contacts when.
[[nodiscard]] std::string timeline_figure(const ScenarioInfo& info, const RunRecord& run, std::size_t number,
                                          const FigureFrame& frame);

// All runs: mean ghost error over the numeric swept key with the most values, a line per combination of the others, and
// the updates sent. Bars where no key is numeric; a run alone gets bars per observer.
[[nodiscard]] std::string overview_figure(const nlohmann::ordered_json& summary);

// The path from above (world x and z at one scale): truth and ghosts of the run with the greatest mean ghost error.
[[nodiscard]] std::string plan_figure(const ScenarioInfo& info, std::span<const RunRecord> runs,
                                      const nlohmann::ordered_json& summary);

// Error against bytes of all runs, and which of them no other beats in both (pareto.hpp). "" for less than two runs.
[[nodiscard]] std::string pareto_figure(const nlohmann::ordered_json& summary);

// The runs of a sweep as rows and columns of small pictures, each like run_figure with the same axes: columns are the
// numeric key with the most values, rows the other key with the most, and the values of a third are colours. Pictures
// are numbered row by row. "" where a sweep does not fit: no swept key, more than three, or more values than can be
// told apart (7 columns, 8 rows, 4 colours).
[[nodiscard]] std::string multiples_figure(const ScenarioInfo& info, std::span<const RunRecord> runs,
                                           const FigureFrame& frame);

}  // namespace peerd::report
