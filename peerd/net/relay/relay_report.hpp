#pragma once
#include <string>

#include <nlohmann/json.hpp>

#include "peerd/net/relay/relay.hpp"

namespace peerd::relay {

// The work of a relay so far, and its links as they are now: one object of
// {"instance", "port", "path": root last, "links": [..], "networks": [..], "counters": {NAME: N}}.
[[nodiscard]] nlohmann::json report_of(const Relay& relay);

// The same in a line for people.
[[nodiscard]] std::string line_of(const Relay& relay);

}  // namespace peerd::relay
