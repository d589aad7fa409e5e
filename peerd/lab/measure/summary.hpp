#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/lab/measure/run_record.hpp"

namespace peerd::measure {

// Rows of errors.csv for some nine megabytes.
inline constexpr std::size_t kCsvRows = 40'000;

struct ScenarioInfo {
  std::string name;
  std::string mode;  // "sim" or "real"
  std::uint64_t seed = 0;
  std::vector<std::string> warnings;               // one sentence each
  std::uint32_t repeat = 1;                        // number of successive runs that differ in their seed alone
  std::string command = {};                        // that was given, in a shell's words; "" if there was none
  bool stopped = false;                            // a signal has ended the last run, or has left out runs after it
  std::optional<std::size_t> csv_rows = kCsvRows;  // the most rows of errors.csv, and of traffic.csv; none: all
};

// Makes summary.json; docs/reference/measures.md defines every number. The same records give the same bytes.
[[nodiscard]] nlohmann::ordered_json summarise(const ScenarioInfo& info, std::span<const RunRecord> runs);

// The numbers of a part of a run, in the shape of a run of summary.json. The run's contacts are those of the part.
[[nodiscard]] nlohmann::ordered_json summarise_part(const RunRecord& run, const Measured& part);

}  // namespace peerd::measure
