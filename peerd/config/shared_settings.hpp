#pragma once
#include <string>

#include "peerd/config/run_settings.hpp"

namespace peerd::config {

// The settings of a run that all peers of its session share, as a configuration (TOML) to which a newcomer adds its
// world and itself: how updates go out and contacts are decided, the regions, the group and the port. Of the other
// peers it has those whom these settings name.
[[nodiscard]] std::string shared_settings(const RunSettings& run);

}  // namespace peerd::config
