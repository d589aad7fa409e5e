#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/measure/run_record.hpp"

namespace peerd::report {

struct ScenarioInfo {
  std::string name;
  std::string mode;  // "sim" or "real"
  std::uint64_t seed = 0;
  std::vector<std::string> warnings;  // one sentence each
  std::uint32_t repeat = 1;           // number of successive runs that differ in their seed alone
  std::string command = {};           // that was given, in a shell's words; "" if there was none
};

// Makes summary.json; docs/reference/measures.md defines every number. The same records give the same bytes.
[[nodiscard]] nlohmann::ordered_json summarise(const ScenarioInfo& info, std::span<const RunRecord> runs);

}  // namespace peerd::report
