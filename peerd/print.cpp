#include "peerd/print.hpp"

#include <iostream>

#include "peerd/report/table.hpp"
#include "peerd/report/write.hpp"

namespace peerd {

int failed(const config::InputError& error) {
  std::cerr << error.text << (error.text.ends_with('\n') ? "" : "\n");
  return error.exit_code;
}

int print_report(const report::ScenarioInfo& info, std::span<const report::RunRecord> runs,
                 const std::filesystem::path& out, bool json) {
  const auto summary = report::summarise(info, runs);
  if (const auto written = report::write_report(out, info, runs, summary); !written) {
    return failed({"error: " + written.error(), 3});
  }
  std::cout << (json ? summary.dump(2) + "\n" : report::table(summary) + report::wrong_outcomes_table(summary));
  return 0;
}

}  // namespace peerd
