#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/animation/event_graph.hpp"

namespace peerd::animation {

// A Stamp orders events: a later `t` is later; at one t, a later `step` is; within a step, events that came over fewer
// ROUTEs (lower `wave`) came first, and the first is the one that counts (4.10.4).
struct Stamp {
  double t = 0.0;  // [s]
  std::uint32_t step = 0;
  std::uint32_t wave = 0;
};

struct PortEvent {
  Stamp stamp;
  double value = 0.0;  // SFTime [s], SFBool 0 or 1
};

// SensorSimulator computes the discrete part of a network: TimeSensors, the events that reach their exposedFields, and
// the relays in between. The part changes at instants (starts, stops, deliveries; the beginnings of cycles where
// cycleTime leads to a sensor; ticks, see below). It is simulated from one instant to the next, in order, once, as far
// as any question went, and remembered: answers do not depend on the order of questions.
//
// At an instant everything happens at one timestamp, in steps. In a step the sensors that are due start, stop or begin
// a cycle; their eventOuts fire (wave 0, together with the deliveries of the first step), and each wave passes every
// ROUTE out of the ports that the wave before has fired. A port fires at most once a step (4.10.4); of several events
// that reach it in one wave, the one of the ROUTE that is last in the file counts. Events only set fields; a sensor
// that must start or stop because of them sends its isActive in the next step, at the same t. A sensor starts at most
// once at one t, and otherwise waits for the next tick: so two sensors that retrigger each other end.
//
// The eventOut `time` is sent continuously. Where it leads to a field of a sensor it is taken when its own sensor
// starts and stops and at ticks: whole multiples of kTick_s.
//
// The latest transitions are remembered; a question about a time before them simulates from the beginning again.
//
// Sensors that cannot affect each other are in different components, each simulated by itself. A sensor that no event
// reaches has two instants at most, so that any t costs the same.
class SensorSimulator {
 public:
  static constexpr double kTick_s = 0x1p-6;

  SensorSimulator(const EventGraph& graph, const Network& network, double read_time_s, std::size_t max_transitions,
                  std::size_t min_history);

  // Returns the state whose transition is the latest at or before t.
  [[nodiscard]] const TimeSensorState& sensor(std::uint32_t sensor, double t);
  // Returns the latest event of a port that feeds a sensor at or before t, or null.
  [[nodiscard]] const PortEvent* latest(std::uint32_t port, double t);

  void deliver(double t, std::uint32_t port, double value);
  void port_added(std::uint32_t port);  // called after EventGraph::find_or_add has added a port to a sensor

  [[nodiscard]] std::uint32_t component_count() const { return static_cast<std::uint32_t>(components_.size()); }
  [[nodiscard]] std::uint32_t component_of_sensor(std::uint32_t s) const { return component_of_sensor_[s]; }
  [[nodiscard]] std::uint32_t component_of_port(std::uint32_t c) const { return component_of_port_[c]; }
  [[nodiscard]] const std::vector<std::uint32_t>& sensors(std::uint32_t component) const {
    return components_[component].sensors;
  }

  // Both return an instant next to t; -inf and +inf where there is none. They are exact for a component that is not
  // stopped.
  [[nodiscard]] double previous_instant(std::uint32_t component, double t);  // <= t
  [[nodiscard]] double next_instant(std::uint32_t component, double t);      // > t

  // Calls f(is_port, index) for each change in (from, to], in order of time, repeatedly for a port or sensor that
  // changed often. Where `from` is forgotten, it calls f once for each port and sensor of the component.
  template <class F>
  void for_each_change(std::uint32_t component, double from, double to, F&& f) {
    Component& c = components_[component];
    run_or_replay_until(c, to);
    if (from < c.history_begin_s) {
      for (const std::uint32_t s : c.sensors) f(false, s);
      for (const std::uint32_t port : c.ports) f(true, port);
      return;
    }
    for (std::size_t i = change_after(c, from); i < c.changes.size() && c.changes[i].t <= to; ++i) {
      f(c.changes[i].is_port, c.changes[i].index);
    }
  }

  // A component that has used up its transitions stands still from that instant on, sensors included.
  [[nodiscard]] double last_time(std::uint32_t component) const { return components_[component].stopped_at_s; }
  [[nodiscard]] std::optional<double> transition_limit_reached_at() const;

 private:
  struct TimedState {
    double t = -kInfinity;
    TimeSensorState state;
  };
  struct Due {
    double t = 0.0;
    std::uint32_t sensor = 0;
    std::uint32_t version = 0;
    friend bool operator<(const Due& a, const Due& b) { return a.t != b.t ? a.t > b.t : a.sensor > b.sensor; }
  };
  struct Change {
    double t = 0.0;
    std::uint32_t index : 31 = 0;
    std::uint32_t is_port : 1 = 0;
  };
  struct Delivered {
    double t = 0.0;
    std::uint32_t port = 0;
    double value = 0.0;
    std::size_t transitions = 0;  // before it was taken
  };
  struct Component {
    std::vector<std::uint32_t> sensors;
    std::vector<std::uint32_t> ports;
    std::vector<Due> heap;             // least t on top; an entry counts if its version is the sensor's
    std::vector<Change> changes;       // sorted by t
    std::vector<Delivered> delivered;  // sorted by t and port, then in order of the calls
    std::size_t next_delivered = 0;
    std::size_t transitions = 0;               // changes there have been
    std::size_t transitions_counted_from = 0;  // transitions when the latest delivery was taken
    double history_begin_s = -kInfinity;       // earlier transitions are forgotten
    double simulated_until_s = -kInfinity;     // every instant up to here is done
    double stopped_at_s = kInfinity;
  };
  struct PendingEvent {
    std::uint32_t port = 0;
    std::uint32_t route = kNone;
    double value = 0.0;
  };

  [[nodiscard]] double due(std::uint32_t sensor, double now) const;
  void push_due(Component& c, std::uint32_t sensor, double now);
  [[nodiscard]] double peek(Component& c);
  void run_or_replay_until(Component& c, double t);
  void run_until(Component& c, double t);
  void drop_old_history(Component& c);
  void reset(Component& c);
  void changed(Component& c, double t, std::uint32_t index, bool is_port);
  void run_instant(Component& c, double t);
  void sensor_phase(Component& c, std::uint32_t sensor, double t, std::uint32_t step);
  void take_deliveries(Component& c, double t);
  void cascade(Component& c, double t, std::uint32_t step);
  bool receive(Component& c, const PendingEvent& event, const Stamp& stamp);
  void send(std::uint32_t sensor, SensorOutput output, double value);
  TimeSensorState& state_for_change(Component& c, std::uint32_t sensor, double t);
  void roll_back(Component& c, double t);
  [[nodiscard]] static std::size_t change_after(const Component& c, double t);
  void sort_by_field(std::vector<PendingEvent>& events) const;

  const EventGraph& graph_;
  double read_time_s_ = 0.0;
  std::size_t max_transitions_ = 0;
  std::size_t min_history_ = 0;
  std::vector<Component> components_;
  std::vector<std::uint32_t> component_of_sensor_;
  std::vector<std::uint32_t> component_of_port_;        // kNone unless control
  std::vector<std::vector<TimedState>> state_history_;  // indexed by sensor, then time; the first is the file's
  std::vector<std::vector<PortEvent>> log_;             // indexed by port, then time; control ports only
  std::vector<std::uint32_t> version_;                  // indexed by sensor, of its valid Due
  std::vector<std::uint8_t> feeds_sensor_inputs_;       // indexed by sensor: bits, of SensorOutput

  // The state of the instant that is being run.
  std::vector<std::uint8_t> stop_pending_;  // indexed by sensor: stopped by an event, has yet to say so
  std::vector<std::uint32_t> due_sensors_, next_sensors_, processed_sensors_;
  std::vector<PendingEvent> wave_, next_wave_;
  std::vector<std::uint64_t> fired_, candidate_;  // indexed by port: the mark of the step, of the wave
  std::vector<std::uint32_t> candidate_at_;
  std::uint64_t mark_ = 0;
};

}  // namespace peerd::animation
