#include "peerd/cli/lab/print_report.hpp"

#include <algorithm>
#include <iostream>

#include <nlohmann/json.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/input/console/shell_word.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/lab/measure/expectations.hpp"
#include "peerd/lab/report/table.hpp"
#include "peerd/lab/report/write.hpp"

namespace peerd {

int print_report(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                 std::span<const config::Expectation> expectations, const std::filesystem::path& out, bool json) {
  auto summary = measure::summarise(info, runs);
  const auto checked = measure::check_expectations(expectations, info.mode, runs, summary["runs"]);
  if (!checked.empty()) summary["expectations"] = measure::expectations_json(checked);
  if (const auto written = report::write_report(out, info, runs, summary); !written) {
    return failed({"error: " + written.error(), kSystemFailed});
  }
  const std::string thinned = report::thinned_rows(info, runs);
  const std::string rows = thinned.empty() ? "" : "\n" + thinned + "\n";
  std::cout << (json ? json_text(summary) + "\n"
                     : report::table(summary) + report::objects_table(summary) + report::contacts_lines(summary) +
                           report::wrong_outcomes_table(summary) +
                           measure::expectations_table(checked, summary["runs"]) + rows);
  return std::ranges::any_of(checked, &measure::CheckedExpectation::failed) ? 1 : 0;
}

std::string command_line(const char* command, const ScenarioOptions& options) {
  std::string line = std::string("peerd ") + command + ' ' + shell_word(options.scenario.string());
  for (const auto& file : options.configs) line += " --config " + shell_word(file.string());
  for (const std::string& set : options.sets) line += " --set " + shell_word(set);
  if (options.seed) line += " --seed " + std::to_string(*options.seed);
  return line;
}

}  // namespace peerd
