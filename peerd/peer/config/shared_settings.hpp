#pragma once
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/config/run_settings.hpp"

namespace peerd::config {

// The settings of a run that all peers of its session share, as a configuration (TOML) to which a joining peer adds its
// world and itself: how updates go out and contacts are decided, the regions, the group and the port. Of the other
// peers it has those whom these settings name.
[[nodiscard]] std::string shared_settings(const RunSettings& run);
// Whether a text that another peer has provided is such a configuration and nothing more: a scenario can name files,
// sockets and events. The error says what it has besides.
[[nodiscard]] Result<void> check_shared(const std::string& text);

}  // namespace peerd::config
