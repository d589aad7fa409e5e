#pragma once
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "peerd/measure/run_record.hpp"
#include "peerd/measure/summary.hpp"
#include "peerd/report/pictures.hpp"

namespace peerd::report {

// report.html: all of a report on one page that needs nothing but itself: what was run, the table of runs, the
// pictures, and each run's details, folded. Its size is bounded; what is left out is said where it would be.
[[nodiscard]] std::string report_page(const ScenarioInfo& info, std::span<const RunRecord> runs,
                                      const nlohmann::ordered_json& summary, const Pictures& pictures);

}  // namespace peerd::report
