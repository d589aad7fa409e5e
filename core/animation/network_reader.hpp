#pragma once
#include <cstdint>
#include <vector>

#include "core/animation/network.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Returns the fields of a TimeSensor, as the text has them.
[[nodiscard]] animation::TimeSensorFields sensor_fields_of(const Node& node);

// The ROUTEs of a document and the nodes that they join, from which predefined movement is computed.
struct NetworkReadResult {
  animation::Network network;
  std::vector<std::uint32_t> document_node;  // indexed by the network's node: the document's
  std::vector<Position> routes_at;           // indexed by the network's ROUTE
  bool has_sensors = false;                  // TimeSensors; without one nothing moves by itself
};
[[nodiscard]] NetworkReadResult read_network(const std::shared_ptr<const Document>& document);

// Reports the parts of the network that have no effect, or another than they seem to have: keys out of order, a
// cycleInterval of 0, and others.
void check_network(const std::shared_ptr<const Document>& document, Problems& problems);

}  // namespace peerd::vrml
