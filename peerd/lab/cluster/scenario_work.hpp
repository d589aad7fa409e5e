#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "peerd/lab/cluster/cluster_options.hpp"
#include "peerd/lab/cluster/work_folder.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::cluster {

inline constexpr const char* kWorkFolder = "work";  // below the folder of a report

// A work that this program does: its version and the hash of its file. It has no settings and no items yet.
[[nodiscard]] Result<Work> work_of_this_program(const ClusterOptions& options, std::string kind);

// The runs of a scenario as the items of a work. Its settings are the texts of `files` (the scenario and its
// configurations), `others` (what the command line says besides), the settings of each run, and the bytes of the world,
// of all recorded motions and of all nodes that events add.
[[nodiscard]] Result<Work> scenario_work(const ClusterOptions& options, const std::vector<std::filesystem::path>& files,
                                         const std::vector<std::string>& others, const config::Scenario& scenario,
                                         const SharedWorld& shared);

}  // namespace peerd::cluster
