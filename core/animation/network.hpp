#pragma once
#include <compare>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/animation/interpolator.hpp"
#include "core/animation/time_sensor.hpp"
#include "core/animation/value.hpp"

namespace peerd::animation {

// A Network is the part of a file that an Animation is built from: the nodes that events pass through, and the ROUTEs.

// A PlainNode is any node that is neither a TimeSensor nor an interpolator. Its fields relay (4.7): an event to set_x
// sets x and sends x_changed. The other events of a node (those of the program of a Script) come from outside, by
// Animation::deliver.
struct PlainNode {};

using Node = std::variant<PlainNode, TimeSensorFields, Interpolator>;

// A field name is `x`, whether the text of the ROUTE says x, set_x or x_changed; an eventIn or eventOut that belongs to
// no exposedField has its own name. For TimeSensors and interpolators the forms set_x and x_changed are understood too.
struct Route {
  std::uint32_t from_node = 0;  // index into Network::nodes
  std::string from_field;
  std::uint32_t to_node = 0;
  std::string to_field;
  FieldType type = FieldType::kFloat;  // type of both ends (4.10.2: they shall match)
};

struct Network {
  std::vector<Node> nodes;
  std::vector<Route> routes;  // in file order, which decides between events of one time
};

enum class Problem : std::uint8_t {
  kNoSuchNode,         // the ROUTE is left out
  kNoSuchField,        // the ROUTE is left out
  kTypeMismatch,       // the ROUTE is left out
  kRouteToKeys,        // ": an interpolator's key and keyValue take events by deliver() alone
  kRepeated,           // ": the first of them counts (4.10.2)
  kUnsortedKeys,       // each key counts as the greatest up to it
  kNoKeys,             // the interpolator sends nothing
  kUnusedKeys,         // keys without a keyValue, or keyValues without a key, are not used
  kBadTimeSensor,      // a startTime or stopTime that is no number, or a cycleInterval <= 0, counts as the default
  kShortCycleInterval  // counts as kShortestCycle_s
};

struct Finding {
  Problem problem = Problem::kNoSuchNode;
  std::uint32_t index = 0;  // index of the ROUTE for the first five, else of the node
};

// A FieldId names a field that takes part in the events of a network.
struct FieldId {
  std::uint32_t value = 0;
  friend constexpr auto operator<=>(const FieldId&, const FieldId&) = default;
};

}  // namespace peerd::animation
