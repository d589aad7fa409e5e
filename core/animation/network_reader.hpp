#pragma once
#include <cstdint>
#include <vector>

#include "core/animation/network.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// A document's ROUTEs and the nodes that they join, as what moves by itself is computed from.
struct NetworkReadResult {
  animation::Network network;
  std::vector<std::uint32_t> document_node;  // by the network's node: the document's
  std::vector<Position> routes_at;           // by the network's ROUTE
  bool has_sensors = false;                  // TimeSensors; without one nothing moves by itself
};
[[nodiscard]] NetworkReadResult read_network(const std::shared_ptr<const Document>& document);

// Says what of it has no effect, or another than it seems to have: keys out of order, a cycleInterval of 0, ..
void check_network(const std::shared_ptr<const Document>& document, Problems& problems);

}  // namespace peerd::vrml
