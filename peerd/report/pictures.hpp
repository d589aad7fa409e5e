#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/measure/run_record.hpp"
#include "peerd/measure/summary.hpp"

namespace peerd::report {

// Every picture of a report, drawn once for its file and for the page. "" where one does not apply.
struct Pictures {
  struct OfRun {
    std::string run, timeline;
  };
  std::string overview, pareto, multiples, plan;
  std::vector<OfRun> runs;
};
[[nodiscard]] Pictures draw_pictures(const ScenarioInfo& info, std::span<const RunRecord> runs,
                                     const nlohmann::ordered_json& summary);

// "run-001.svg" of ("run", 1).
[[nodiscard]] std::string picture_file(std::string_view kind, std::size_t number);

}  // namespace peerd::report
