#pragma once
#include <filesystem>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "peerd/commands/commands.hpp"
#include "peerd/config/expectations.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/measure/run_record.hpp"
#include "peerd/measure/summary.hpp"

namespace peerd {

// Prints the error for a person and gives its exit code.
[[nodiscard]] int failed(const InputError& error);

// Prints one line each on standard error.
void print_warnings(std::span<const std::string> warnings);

// Checks what a scenario expects, writes its outputs into `out`, and prints its table, or summary.json instead. 1 where
// something was not as expected.
[[nodiscard]] int print_report(const report::ScenarioInfo& info, std::span<const report::RunRecord> runs,
                               std::span<const config::Expectation> expectations, const std::filesystem::path& out,
                               bool json);

// What a shell would have to be given to get the same numbers again: without where they go and how they are shown.
[[nodiscard]] std::string command_line(const char* command, const ScenarioOptions& options);

// One line of JSON. Names of old VRML files, in Latin-1, and paths need not be UTF-8: what is not is U+FFFD there.
[[nodiscard]] std::string json_line(const nlohmann::json& value);

}  // namespace peerd
