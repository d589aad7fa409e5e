#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "peerd/peer/control/event_kind.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd::control {

// The kind under which clients are given that output of a peer; none: it is none of their concern.
[[nodiscard]] std::optional<EventKind> kind_of(const replication::Output& output);

// The event as a line of the control protocol, without a line end. The output has a kind, and the node has just put it
// out.
[[nodiscard]] std::string event_line(const replication::Output& output, const PeerNode& node);

// The line that says how many events a client was not given because it did not read what waited for it.
[[nodiscard]] std::string dropped_line(std::uint64_t count);

}  // namespace peerd::control
