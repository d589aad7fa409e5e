#pragma once
#include "peerd/cli/commands/view_command.hpp"

namespace peerd {

// Serves the page of a recording, an output folder of peerd sim or a capture, until a signal ends it. Returns the exit
// code.
[[nodiscard]] int view_recorded(const ViewOptions& options);

}  // namespace peerd
