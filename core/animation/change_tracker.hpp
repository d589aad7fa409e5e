#pragma once
#include <cstdint>
#include <vector>

#include "core/animation/delivery_log.hpp"
#include "core/animation/event_graph.hpp"
#include "core/animation/sensor_simulator.hpp"

namespace peerd::animation {

// ChangeTracker finds the fields that may change in an interval of time. It keeps a cursor in time, with the sensors
// that are active there and the instants to come, so that intervals that follow each other cost little. The objects
// that it refers to outlive it.
class ChangeTracker {
 public:
  ChangeTracker(const EventGraph& graph, SensorSimulator& simulator, const DeliveryLog& deliveries)
      : graph_(graph), simulator_(simulator), deliveries_(deliveries), place_(graph.sensor_node.size(), kNone) {}

  // Makes room for that many ports.
  void grow(std::size_t ports) { seen_.resize(ports, 0); }

  // Does for ports as Animation::changing() does for fields.
  void changing(double from_s, double to_s, std::vector<FieldId>& out);

  // Notes an event from outside at t that the simulator, or the delivery log, has just taken for that port.
  void note_sensor_delivery(std::uint32_t port, double t);
  void note_delivery(std::uint32_t port, double t);

 private:
  struct Upcoming {
    double t = 0.0;
    std::uint32_t index = 0;  // index of a component, or of a port that has a delivery
    bool is_port = false;
    friend bool operator<(const Upcoming& a, const Upcoming& b) { return a.t > b.t; }
  };

  void move_cursor(double t, bool note);
  void rebuild(double t);
  void refresh(std::uint32_t component, double t);
  void set_active(std::uint32_t sensor, bool active);
  void push(const Upcoming& upcoming);
  void push_component(std::uint32_t component, double t);
  void mark_downstream(std::uint32_t port, std::vector<FieldId>& out);

  const EventGraph& graph_;
  SensorSimulator& simulator_;
  const DeliveryLog& deliveries_;

  bool cursor_valid_ = false;
  double cursor_s_ = 0.0;
  std::vector<std::uint32_t> active_;  // the sensors that are active at the cursor
  std::vector<std::uint32_t> place_;   // indexed by sensor: its place in active_, or kNone
  std::vector<Upcoming> upcoming_;     // heap; may hold an instant twice, or one that is no more
  std::vector<std::uint32_t> changed_sensors_, changed_ports_;  // changed since the last call of changing()

  std::vector<std::uint64_t> seen_;  // indexed by port: the mark of the call that has met it
  std::uint64_t mark_ = 0;
  std::vector<std::uint32_t> open_;  // ports whose ROUTEs are to be followed
};

}  // namespace peerd::animation
