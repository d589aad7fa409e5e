#pragma once
#include <cstdint>

#include <nlohmann/json.hpp>

#include "core/time.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::control {

// The members of the reply to "conflicts": rows from a number on, at most kConflictsMax.
[[nodiscard]] nlohmann::ordered_json conflict_rows(const PeerNode& node, HostTime now, std::uint32_t from);

}  // namespace peerd::control
