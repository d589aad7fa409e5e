#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/animation/event_graph.hpp"
#include "core/animation/sensor_simulator.hpp"
#include "core/animation/network.hpp"

namespace peerd::animation {

// A field that takes part in a network's events.
struct FieldId {
  std::uint32_t value = 0;
  friend constexpr auto operator<=>(const FieldId&, const FieldId&) = default;
};

struct Field {
  FieldId id;
  std::uint32_t node = 0;  // index into Network::nodes
  std::string_view name;   // `x`, not set_x; "value_changed" of an interpolator; lives as long as the Animation
  FieldType type = FieldType::kFloat;
};

// How a field moves from begin_s until end_s. In the frame that the field is in, which for translation and rotation is
// the parent's. SFFloat and SFTime use the first component of `position` and `velocity`.
struct Segment {
  double begin_s = -std::numeric_limits<double>::infinity();  // [s]
  double end_s = std::numeric_limits<double>::infinity();     // [s], exclusive; +inf: it never changes again
  bool initial = true;                  // no event has come: the file's value holds, and what is below means nothing
  bool is_constant = true;                    // nothing moves
  Vec3 position = Vec3::Zero();         // at begin_s
  Vec3 velocity = Vec3::Zero();         // [1/s]; a translation's [m/s]
  Quat orientation = Quat::Identity();  // at begin_s, unit
  Vec3 angular_velocity_body = Vec3::Zero();  // [rad/s] in the rotating frame, constant, as KinematicState has it

  // begin_s <= t <= end_s. Where begin_s is -inf (it is still) any t.
  [[nodiscard]] Vec3 position_at(double t) const;
  [[nodiscard]] Quat orientation_at(double t) const;  // orientation * exp(angular_velocity_body * (t - begin_s) / 2)
};

enum class DeliverError : std::uint8_t {
  kNoSuchField,  // no such node, or no such eventIn on it
  kType,         // the value is not of the field's type
  kBeforeRead,   // before the network was read
  kNotFinite     // the time, or a number of the value
};

struct AnimationOptions {
  // World time [s] at which the file is read: nothing happens before. The same on all peers.
  double read_time_s = 0.0;
  // The most transitions of one component (see control.hpp) after its latest delivery; then it stands still for good,
  // and limited_at() says since when. Bounds the work of a question about a far time where sensors start each other
  // (~50 ns a transition: 3 s); nothing is limited where they do not. Two sensors that start each other every second
  // use ten a second: 77 days. The same on all peers.
  std::size_t max_transitions = std::size_t{1} << 26;
  // How many transitions of a component are remembered at least (~100 bytes each). A question about a time before them
  // simulates the component from the beginning again.
  std::size_t min_history = std::size_t{1} << 16;
};

// The predefined movement of a VRML97 world, as a function of world time. A pure function of the network and of what
// was delivered: not of what was asked before. Any t may be asked at any time; all peers get the same bits.
//
// Continuous parts (fraction_changed through interpolators and relays) are evaluated in closed form, backwards from the
// field that is asked for: at any t this costs as many steps as there are ports upstream of it. Discrete parts
// (isActive, cycleTime and time into the fields of TimeSensors) are simulated by Control, once, from transition to
// transition; a later question about a time that was passed costs a binary search, unless it is forgotten by then.
//
// 4.10.5 leaves open which of several events of one timestamp at one eventIn counts. Here: the one that came over the
// fewest ROUTEs, and of those the one whose ROUTE is last in the file. A later timestamp wins over an earlier.
//
// An interpolator answers the keys that it has at the time of the set_fraction; keys take no ROUTEs.
//
// Times that are asked for are finite. Not thread-safe: questions remember what they found out. SF values are answered
// without allocation once the scratch buffers have grown.
class Animation {
 public:
  explicit Animation(const Network& network, const AnimationOptions& options = {});

  [[nodiscard]] std::span<const Finding> findings() const { return graph_->findings; }
  // None if the node has no such field, or is a plain node on whose field no ROUTE and no delivery has been.
  [[nodiscard]] std::optional<FieldId> field(std::uint32_t node, std::string_view name);
  [[nodiscard]] Field describe(FieldId id) const;
  // Fields that a cascade from a TimeSensor can reach, by id. An interpolator's value_changed is not among them.
  [[nodiscard]] std::vector<Field> driven() const;

  // The value of the latest event at or before t, into `out`; false if none was: then the file's initial value holds.
  [[nodiscard]] bool value(FieldId id, double t, Value& out);

  // How the field goes on from t, t included: begin_s <= t < end_s. For SFVec3f, SFRotation, SFFloat and SFTime; of
  // colours, MF and other types only begin_s, end_s, initial and still are given, and nothing at all while they move.
  // Agrees with value() on (begin_s, end_s) to the sum of 2e-15 of the largest keyValue (2e-15 rad), the movement
  // during 2 ulp(end_s) and 2e-16 of a cycle, and the piece's whole movement times 2e-16 / (distance of its keys),
  // which is what rounding fractions can make. At begin_s too unless the field jumps there: at the end of a cycle
  // value() is that of fraction 1, and the segment is what follows. Consecutive segments may be parts of one movement.
  [[nodiscard]] std::optional<Segment> segment(FieldId id, double t);

  // Fields that may be, at some time in (from_s, to_s], other than at from_s: all that a sensor which is active or
  // changes then, or a delivery, leads to. By id, each once, interpolators left out; from_s <= to_s. Costs the number
  // of fields, plus O(log n) a transition since the last call; a call whose from_s is before the last one's to_s costs
  // O(all sensors). A delivery of the past since the last call is reported whatever from_s is.
  void changing(double from_s, double to_s, std::vector<FieldId>& out);

  // An event from outside (a sensor of another kind, a key, a script): to an eventIn or exposedField, or from a plain
  // node's eventOut. Takes effect from t on and passes the same ROUTEs. Deliveries of one t to one field take effect in
  // the order of the calls; else the order of calls does not matter. One of the past costs what was found out after it.
  std::optional<DeliverError> deliver(double t, std::uint32_t node, std::string_view name, const Value& value);

  // Since when something stands still for want of transitions; looks at what has been evaluated so far. O(sensors).
  [[nodiscard]] std::optional<double> transition_limit_reached_at() const { return simulator_->transition_limit_reached_at(); }

 private:
  struct Delivered {
    double t = 0.0;
    Value value;
  };
  struct Source {
    Stamp stamp;
    std::uint32_t port = kNone;
  };
  struct Upcoming {
    double t = 0.0;
    std::uint32_t index = 0;  // of a component, or of a port that has a delivery
    bool is_port = false;
    friend bool operator<(const Upcoming& a, const Upcoming& b) { return a.t > b.t; }
  };
  enum class At : std::uint8_t { kNow, kJustAfter };

  [[nodiscard]] bool is_source(const EventPort& c) const;
  [[nodiscard]] const Delivered* delivered(std::uint32_t port, double t) const;
  [[nodiscard]] std::optional<Stamp> source_event(std::uint32_t port, double t, At at);
  [[nodiscard]] bool interpolates(std::uint32_t port, double t) const;
  [[nodiscard]] Keys keys_at(std::uint32_t port, double t) const;
  [[nodiscard]] bool find_path(std::uint32_t port, double t, At at);
  [[nodiscard]] bool find_simple_path(std::uint32_t port, double t, At at, bool& found);
  void propagate(const Source* group_begin, const Source* group_end, std::uint32_t target);
  void evaluate_path(double t, Value& out);
  [[nodiscard]] std::optional<std::uint32_t> find_or_add(std::uint32_t node, std::string_view name, FieldType type,
                                                         bool in);
  void grow();

  void bound_segment(double t, Segment& segment);
  [[nodiscard]] bool follow_path(double t, Segment& segment, Value& out);

  void move_cursor(double t, bool note);
  void rebuild(double t);
  void refresh(std::uint32_t component, double t);
  void set_active(std::uint32_t sensor, bool active);
  void push_component(std::uint32_t component, double t);
  void mark_downstream(std::uint32_t port, std::vector<FieldId>& out);

  std::unique_ptr<EventGraph> graph_;  // at a fixed place: Control refers to it
  std::unique_ptr<SensorSimulator> simulator_;
  AnimationOptions options_;
  std::map<std::uint32_t, std::vector<Delivered>> delivered_;  // by port that is not control, then time
  std::vector<std::uint8_t> has_delivered_;                    // by port

  // Of the question that is being answered.
  Source source_;                        // whose event counts
  std::vector<std::uint32_t> path_;      // the ports from the one asked for back to the source's
  std::vector<std::uint32_t> upstream_;  // ports that events may have come over, the one asked for first
  std::vector<Source> sources_;
  std::vector<std::uint64_t> seen_;     // by port: the question's mark
  std::vector<std::uint64_t> reached_;  // "
  std::vector<std::uint32_t> via_;      // by port: the ROUTE of the event that counts
  std::vector<std::uint32_t> wave_, next_wave_;
  std::uint64_t mark_ = 0;
  Value scratch_;

  // Who is active at the cursor.
  bool cursor_valid_ = false;
  double cursor_s_ = 0.0;
  std::vector<std::uint32_t> active_;
  std::vector<std::uint32_t> place_;                        // by sensor: in active_, or kNone
  std::vector<Upcoming> upcoming_;                          // heap; may hold an instant twice, or one that is no more
  std::vector<std::uint32_t> changed_sensors_, changed_ports_;  // changed since the last call
};

}  // namespace peerd::animation
