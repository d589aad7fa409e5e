#pragma once
#include <cstdint>
#include <vector>

#include "core/animation/network.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// A document's ROUTEs and the nodes that they join, as what moves by itself is computed from.
struct NetworkReading {
  animation::Network network;
  std::vector<std::uint32_t> documents_node;  // by the network's node: the document's
  bool has_sensors = false;                   // TimeSensors; without one nothing moves by itself
};
[[nodiscard]] NetworkReading read_network(const std::shared_ptr<const Document>& document);

}  // namespace peerd::vrml
