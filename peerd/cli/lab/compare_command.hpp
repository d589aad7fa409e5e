#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "peerd/cli/lab/scenario_options.hpp"

namespace peerd {

struct CompareOptions {
  ScenarioOptions scenario;
  std::vector<std::filesystem::path> with;  // configurations of other systems; empty: all of `baselines`
  std::vector<std::filesystem::path> baselines;
};

// `peerd compare`: a scenario as it is and with each of those systems in its peers' place, on the simulated network:
// one table and one page.
[[nodiscard]] int run_compare(const CompareOptions& options);

}  // namespace peerd
