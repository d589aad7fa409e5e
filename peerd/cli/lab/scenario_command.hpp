#pragma once
#include <filesystem>

namespace peerd {

struct ScenarioOptions;

// `peerd scenario`: runs the same scenario between real processes over real multicast. `program` is peerd itself.
[[nodiscard]] int run_scenario(const ScenarioOptions& options, const std::filesystem::path& program);

}  // namespace peerd
