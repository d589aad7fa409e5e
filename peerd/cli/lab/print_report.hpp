#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "peerd/cli/lab/scenario_options.hpp"
#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/peer/config/expectations.hpp"

namespace peerd {

// Checks the scenario's expectations, writes its outputs into `out`, and prints its table, or summary.json instead.
// Returns 1 where an expectation failed.
[[nodiscard]] int print_report(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                               std::span<const config::Expectation> expectations, const std::filesystem::path& out,
                               bool json);

// A shell command that gives the same numbers again. Options that say where outputs go and how they are shown are left
// out.
[[nodiscard]] std::string command_line(const char* command, const ScenarioOptions& options);

}  // namespace peerd
