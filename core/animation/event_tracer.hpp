#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/animation/delivery_log.hpp"
#include "core/animation/event_graph.hpp"
#include "core/animation/sensor_simulator.hpp"

namespace peerd::animation {

// EventTracer finds the event that a port has at a time, and the ports that it came over, backwards from the port. It
// keeps the answer until the next question. The graph, the simulator and the deliveries outlive it.
class EventTracer {
 public:
  // The choice between events up to the time asked for and those that an active sensor also sends just after it.
  enum class At : std::uint8_t { kNow, kJustAfter };
  struct Source {
    Stamp stamp;
    std::uint32_t port = kNone;
  };

  EventTracer(const EventGraph& graph, SensorSimulator& simulator, const DeliveryLog& deliveries)
      : graph_(graph), simulator_(simulator), deliveries_(deliveries) {}

  // Makes room for that many ports.
  void grow(std::size_t ports);

  // Finds the event that is the latest of the port at or before t, or just after t. Returns false if there is none.
  [[nodiscard]] bool find(std::uint32_t port, double t, At at);

  // The answers of the latest find(). The event that counts and the path, which leads from the port asked for back to
  // that of the event, hold if it returned true. The upstream ports are those that events may have come over, the one
  // asked for first.
  [[nodiscard]] const Source& source() const { return source_; }
  [[nodiscard]] std::span<const std::uint32_t> path() const { return path_; }
  [[nodiscard]] std::span<const std::uint32_t> upstream() const { return upstream_; }

  // Computes the value of the event that find() has found for t, as it arrives at the port asked for.
  void evaluate(double t, Value& out);
  // Returns the keys of the interpolator of that port, as of t.
  [[nodiscard]] Keys keys_at(std::uint32_t port, double t) const;

 private:
  [[nodiscard]] bool is_source(const EventPort& c) const;
  [[nodiscard]] std::optional<Stamp> source_event(std::uint32_t port, double t, At at);
  [[nodiscard]] bool interpolates(std::uint32_t port, double t) const;
  [[nodiscard]] bool find_simple_path(std::uint32_t port, double t, At at, bool& found);
  void propagate(const Source* group, const Source* group_end, std::uint32_t target);

  const EventGraph& graph_;
  SensorSimulator& simulator_;
  const DeliveryLog& deliveries_;

  Source source_;
  std::vector<std::uint32_t> path_;
  std::vector<std::uint32_t> upstream_;
  std::vector<Source> sources_;         // all events that may count
  std::vector<std::uint64_t> seen_;     // indexed by port: the mark of the question that has met it
  std::vector<std::uint64_t> reached_;  // indexed by port: the mark of the wave that has reached it
  std::vector<std::uint32_t> via_;      // indexed by port: the ROUTE of the event that counts
  std::vector<std::uint32_t> wave_, next_wave_;
  std::uint64_t mark_ = 0;
};

}  // namespace peerd::animation
