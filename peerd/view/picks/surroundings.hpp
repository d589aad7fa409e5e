#pragma once
#include <span>

#include <nlohmann/json_fwd.hpp>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::view {

// The look of a peer's interest and its adaptive thresholds look like, as JSON (docs/reference/gateway.md,
// "surroundings"): the grid of regions, which of them the peer has joined and in which its objects are; and for each
// object that interests name the sphere by which its time to contact is found. `movers`: the nodes of the picture.
// `at`: an instant to which the peer has been brought.
[[nodiscard]] nlohmann::ordered_json surroundings(const PeerNode& node, SimTime at, std::span<const ObjectId> movers);

}  // namespace peerd::view
