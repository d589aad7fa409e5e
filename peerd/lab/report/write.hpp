#pragma once
#include <expected>
#include <filesystem>
#include <span>
#include <string>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"

namespace peerd::report {

// Writes report.html, summary.json, errors.csv, traffic.csv and collisions.csv into `out`, which is made if need be.
// Pictures that an earlier version of the program wrote there are removed, because they would be taken for this run's.
// The error is a sentence that names the file.
[[nodiscard]] std::expected<void, std::string> write_report(const std::filesystem::path& out,
                                                            const measure::ScenarioInfo& info,
                                                            std::span<const measure::RunRecord> runs);

// Writes the same with a summary that the caller already has.
[[nodiscard]] std::expected<void, std::string> write_report(const std::filesystem::path& out,
                                                            const measure::ScenarioInfo& info,
                                                            std::span<const measure::RunRecord> runs,
                                                            const nlohmann::ordered_json& summary);

}  // namespace peerd::report
