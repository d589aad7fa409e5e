#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"

namespace peerd::report {

// All pictures of a report, each drawn once for its file and for the page. A picture that does not apply is empty.
struct Pictures {
  struct OfRun {
    std::string run, timeline;
  };
  std::string overview, pareto, multiples, plan;
  std::vector<OfRun> runs;
};
[[nodiscard]] Pictures draw_pictures(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                                     const nlohmann::ordered_json& summary);

// The name of a picture's file: "run-001.svg" for ("run", 1).
[[nodiscard]] std::string picture_file(std::string_view kind, std::size_t number);

}  // namespace peerd::report
