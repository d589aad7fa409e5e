#pragma once
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/lab/chaos/chaos_run.hpp"
#include "peerd/lab/measure/run_record.hpp"

namespace peerd::cluster {

// All that a report needs of one run of a scenario.
struct RunResult {
  measure::RunRecord record;
  std::vector<std::string> warnings;  // one sentence each, in the order in which they came up
};

// The bytes of a run, and of the findings of a seed. The report of a result that was read from its bytes is the same,
// byte for byte, as that of the result. Only the same build reads them: WorkFolder refuses all others.
[[nodiscard]] std::string to_bytes(const RunResult& result);
[[nodiscard]] std::string to_bytes(const chaos::ChaosReport& report);
// Parse hostile input; the error is one sentence.
[[nodiscard]] std::expected<RunResult, std::string> run_result_from(std::string_view bytes);
[[nodiscard]] std::expected<chaos::ChaosReport, std::string> chaos_report_from(std::string_view bytes);

}  // namespace peerd::cluster
