#pragma once

namespace peerd {

struct ScenarioOptions;

// `peerd sim`: runs the scenario on a simulated network, as fast as it goes.
[[nodiscard]] int run_sim(const ScenarioOptions& options);

}  // namespace peerd
