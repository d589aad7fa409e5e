#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "peerd/config/expectations.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/measure/run_record.hpp"
#include "peerd/measure/summary.hpp"

namespace peerd {

struct ScenarioOptions;

// Says whether failed() prints errors for programs, too: as the JSON object of error_json, on standard output.
void print_errors_as_json(bool json);

// Prints the error for a person and gives its exit code.
[[nodiscard]] int failed(const InputError& error);

// Prints one line each on standard error.
void print_warnings(std::span<const std::string> warnings);

// Checks the scenario's expectations, writes its outputs into `out`, and prints its table, or summary.json instead.
// Returns 1 where an expectation failed.
[[nodiscard]] int print_report(const report::ScenarioInfo& info, std::span<const report::RunRecord> runs,
                               std::span<const config::Expectation> expectations, const std::filesystem::path& out,
                               bool json);

// A shell command that gives the same numbers again. Options that say where outputs go and how they are shown are left
// out.
[[nodiscard]] std::string command_line(const char* command, const ScenarioOptions& options);

}  // namespace peerd
