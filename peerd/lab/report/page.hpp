#pragma once
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/figures.hpp"

namespace peerd::report {

// Makes report.html: a whole report on one self-contained page, with the command, the table of runs, the figures, and
// each run's details, folded. Its size is bounded, and it says where something is left out.
[[nodiscard]] std::string report_page(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                                      const nlohmann::ordered_json& summary, const Figures& figures);

}  // namespace peerd::report
