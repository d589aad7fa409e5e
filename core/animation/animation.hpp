#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/animation/network.hpp"
#include "core/animation/segment.hpp"
#include "core/animation/value.hpp"

namespace peerd::animation {

struct Field {
  FieldId id;
  std::uint32_t node = 0;  // index into Network::nodes
  std::string_view name;   // `x`, not set_x; "value_changed" of an interpolator; lives as long as the Animation
  FieldType type = FieldType::kFloat;
};

enum class DeliverError : std::uint8_t {
  kNoSuchField,  // no such node, or no such eventIn on it
  kType,         // the value is not of the field's type
  kBeforeRead,   // before the network was read
  kNotFinite     // the time, or a number of the value
};

struct AnimationOptions {
  // World time [s] at which the file is read: nothing happens before. All peers use the same value.
  double read_time_s = 0.0;
  // The most transitions of one component (see sensor_simulator.hpp) after its latest delivery; then it stands still
  // for good, and transition_limit_reached_at() says since when. This bounds the work of a question about a far time
  // where sensors start each other (~50 ns a transition: 3 s); nothing is limited where they do not. Two sensors that
  // start each other every second use ten a second: 77 days. All peers use the same value.
  std::size_t max_transitions = std::size_t{1} << 26;
  // The number of transitions of a component that are remembered at least, of about 100 bytes each. A question about a
  // time before them simulates the component from the beginning again.
  std::size_t min_history = std::size_t{1} << 16;
};

// An Animation is the predefined movement of a VRML97 world, as a function of world time. It is a pure function of the
// network and of the deliveries, not of earlier questions. Any t may be asked at any time; all peers get the same bits.
//
// Continuous parts (fraction_changed through interpolators and relays) are evaluated in closed form, backwards from the
// field that is asked for: at any t this costs as many steps as there are ports upstream of it. Discrete parts
// (isActive, cycleTime and time into the fields of TimeSensors) are simulated by SensorSimulator, once, from transition
// to transition; a later question about a time that was passed costs a binary search, unless it is forgotten by then.
//
// The standard leaves open (4.10.5) which of several events of one timestamp at one eventIn counts. Here it is the one
// that came over the fewest ROUTEs, and of those the one whose ROUTE is last in the file. A later timestamp wins over
// an earlier.
//
// An interpolator answers with the keys that it has at the time of the set_fraction; keys take no ROUTEs.
//
// Times that are asked for are finite. Not thread-safe: questions remember intermediate results. SF values are answered
// without allocation once the scratch buffers have grown.
class Animation {
 public:
  explicit Animation(const Network& network, const AnimationOptions& options = {});
  ~Animation();
  Animation(Animation&&) noexcept;
  Animation& operator=(Animation&&) noexcept;

  [[nodiscard]] std::span<const Finding> findings() const;
  // Returns nothing if the node has no such field, or is a plain node on whose field no ROUTE and no delivery has been.
  [[nodiscard]] std::optional<FieldId> field(std::uint32_t node, std::string_view name);
  [[nodiscard]] Field describe(FieldId id) const;
  // Returns the fields that a cascade from a TimeSensor can reach, by id. The value_changed of an interpolator is not
  // among them.
  [[nodiscard]] std::vector<Field> driven() const;

  // Writes the value of the latest event at or before t into `out`. Returns false if there was none: then the initial
  // value of the file holds.
  [[nodiscard]] bool value(FieldId id, double t, Value& out);

  // Describes how the field goes on from t, t included: begin_s <= t < end_s. All members are given for SFVec3f,
  // SFRotation, SFFloat and SFTime. Of colours, MF and other types only begin_s, end_s, initial and is_constant are
  // given, and nothing at all while colours and normals move. Coordinates move evenly until end_s. The result agrees
  // with value() on (begin_s, end_s) to the sum of 2e-15 of the largest keyValue (2e-15 rad), the movement during 2
  // ulp(end_s) and 2e-16 of a cycle, and the movement of the whole piece times 2e-16 / (distance of its keys), which is
  // the error that rounding of fractions can cause. It also agrees at begin_s unless the field jumps there: at the end
  // of a cycle value() is that of fraction 1, and the segment is the movement that follows. Consecutive segments may be
  // parts of one movement.
  [[nodiscard]] std::optional<Segment> segment(FieldId id, double t);

  // Lists the fields that may be, at some time in (from_s, to_s], other than at from_s: everything that a sensor which
  // is active or changes then, or a delivery, leads to. The list is sorted by id, has each field once, and leaves
  // interpolators out; from_s <= to_s. A call costs the number of fields, plus O(log n) a transition since the last
  // call; a call whose from_s is before the to_s of the last one costs O(all sensors). A delivery of the past since the
  // last call is reported whatever from_s is.
  void changing(double from_s, double to_s, std::vector<FieldId>& out);

  // Delivers an event from outside (a sensor of another kind, a key, a script) to an eventIn or exposedField, or from
  // an eventOut of a plain node. It takes effect from t on and passes the same ROUTEs. Deliveries of one t to one field
  // take effect in the order of the calls; otherwise the order of calls does not matter. A delivery of the past
  // discards the results after it.
  std::optional<DeliverError> deliver(double t, std::uint32_t node, std::string_view name, const Value& value);

  // Returns the time since when a component stands still because it has used up its transitions, as far as it has been
  // evaluated. O(sensors).
  [[nodiscard]] std::optional<double> transition_limit_reached_at() const;

 private:
  struct Parts;  // one block of memory, so that the parts can refer to each other while the Animation moves
  std::unique_ptr<Parts> parts_;
};

}  // namespace peerd::animation
