#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/animation/network.hpp"

namespace peerd::animation {

inline constexpr std::uint32_t kNone = 0xffffffffu;

enum class PortKind : std::uint8_t { kRelay, kInterpolator, kKey, kSensorOutput, kSensorInput };
enum class SensorOutput : std::uint8_t { kIsActive, kCycleTime, kFraction, kTime };

// An event port sends at most one event at one timestamp (4.10.4). It is an exposedField, an eventOut, or an
// interpolator as a whole, which takes set_fraction and sends value_changed.
struct EventPort {
  std::uint32_t node = 0;
  std::uint32_t name = 0;  // index into EventGraph::names
  PortKind kind = PortKind::kRelay;
  std::uint8_t slot = 0;               // SensorOutput or SensorInput; kKey: 0 for key, 1 for keyValue
  FieldType type = FieldType::kFloat;  // type of the events that it sends
  bool driven = false;                 // a ROUTE leads here from a TimeSensor's eventOut
  bool feeds_sensor = false;           // a TimeSensor's input, or a relay that leads to one
  std::uint32_t first_in = kNone;      // routes, chained by Link::next_in
  std::uint32_t first_out = kNone;     // routes, chained by Link::next_out
};

struct Link {
  std::uint32_t from = kNone;  // ports
  std::uint32_t to = kNone;
  std::uint32_t next_in = kNone;
  std::uint32_t next_out = kNone;
};

// An EventGraph holds the ports and ROUTEs of a network. Links keep the order of the file by index; one that is left
// out has from == kNone.
class EventGraph {
 public:
  explicit EventGraph(const Network& network);

  // Returns the port of a field, made if there is none yet and the node can have it. `in`: the field is to take an
  // event.
  [[nodiscard]] std::optional<std::uint32_t> find_or_add(std::uint32_t node, std::string_view field, FieldType type,
                                                         bool in);
  [[nodiscard]] std::optional<std::uint32_t> find(std::uint32_t node, std::string_view field) const;

  [[nodiscard]] bool is_plain(std::uint32_t node) const {
    return node >= kind_of_node_.size() || kind_of_node_[node] == NodeKind::kPlain;
  }

  std::vector<EventPort> ports;
  std::vector<Link> links;
  std::deque<std::string> names;  // elements stay in place as more are added
  std::vector<Finding> findings;

  // The index of each node among those of its kind (sensors, interpolators); kNone for a plain node.
  std::vector<std::uint32_t> index_of_node;
  std::vector<std::uint32_t> sensor_node;
  std::vector<std::array<std::uint32_t, 4>> sensor_outputs;  // indexed by sensor and SensorOutput: ports or kNone
  std::vector<Interpolator> interpolators;                   // with sorted keys
  std::vector<std::array<std::uint32_t, 2>> key_ports;       // indexed by interpolator: key, keyValue; ports or kNone

 private:
  struct PortSpec {
    std::string_view name;  // canonical
    PortKind kind = PortKind::kRelay;
    std::uint8_t slot = 0;
    FieldType type = FieldType::kFloat;
    bool in = true;
    bool out = true;
    FieldType in_type = FieldType::kFloat;
  };
  [[nodiscard]] std::optional<PortSpec> port_spec_of(std::uint32_t node, std::string_view field, FieldType type) const;
  std::optional<Problem> add_route(const Network& network, const Route& route, std::uint32_t index);
  void mark_driven();
  void mark_sensor_inputs();

  enum class NodeKind : std::uint8_t { kPlain, kSensor, kInterpolator };
  std::vector<NodeKind> kind_of_node_;
  std::unordered_map<std::string, std::uint32_t> name_ids_;
  std::unordered_map<std::uint64_t, std::uint32_t> port_of_field_;  // looked up, never iterated
  std::unordered_set<std::uint64_t> routed_;                        // pairs of ports; "
};

}  // namespace peerd::animation
