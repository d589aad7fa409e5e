#include "peerd/commands/print.hpp"

#include <algorithm>
#include <cctype>
#include <iostream>

#include <nlohmann/json.hpp>

#include "peerd/command_line/error_json.hpp"
#include "peerd/command_line/shell_word.hpp"
#include "peerd/commands/scenario_options.hpp"
#include "peerd/measure/expectations.hpp"
#include "peerd/report/table.hpp"
#include "peerd/report/write.hpp"

namespace peerd {
namespace {

// Set once, before anything fails: the form of errors is that of the program's whole output.
bool errors_as_json = false;

}  // namespace

void print_errors_as_json(bool json) { errors_as_json = json; }

int failed(const InputError& error) {
  if (errors_as_json) print_error_json(error_json(error), std::cout);
  std::cerr << error.text << (error.text.ends_with('\n') ? "" : "\n");
  return error.exit_code;
}

void print_warnings(std::span<const std::string> warnings) {
  for (const std::string& warning : warnings) std::cerr << warning << '\n';
}

int print_report(const report::ScenarioInfo& info, std::span<const report::RunRecord> runs,
                 std::span<const config::Expectation> expectations, const std::filesystem::path& out, bool json) {
  auto summary = report::summarise(info, runs);
  const auto checked = report::check_expectations(expectations, info.mode, runs, summary["runs"]);
  if (!checked.empty()) summary["expectations"] = report::expectations_json(checked);
  if (const auto written = report::write_report(out, info, runs, summary); !written) {
    return failed({"error: " + written.error(), 3});
  }
  const std::string thinned = report::thinned_rows(info, runs);
  const std::string rows = thinned.empty() ? "" : "\n" + thinned + "\n";
  std::cout << (json ? summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n"
                     : report::table(summary) + report::objects_table(summary) + report::wrong_outcomes_table(summary) +
                           report::expectations_table(checked, summary["runs"]) + rows);
  return std::ranges::any_of(checked, &report::CheckedExpectation::failed) ? 1 : 0;
}

std::string command_line(const char* command, const ScenarioOptions& options) {
  std::string line = std::string("peerd ") + command + ' ' + shell_word(options.scenario.string());
  for (const auto& file : options.configs) line += " --config " + shell_word(file.string());
  for (const std::string& set : options.sets) line += " --set " + shell_word(set);
  if (options.seed) line += " --seed " + std::to_string(*options.seed);
  return line;
}

}  // namespace peerd
