#pragma once
#include <cstdint>
#include <optional>

#include "core/animation/event_tracer.hpp"
#include "core/animation/segment.hpp"

namespace peerd::animation {

// Finds how a field moves from a time on, along the path that EventTracer finds. What it refers to outlives it.
class SegmentFinder {
 public:
  SegmentFinder(const EventGraph& graph, SensorSimulator& simulator, const DeliveryLog& deliveries, EventTracer& tracer)
      : graph_(graph), simulator_(simulator), deliveries_(deliveries), tracer_(tracer) {}

  // Does for a port as Animation::segment() does for a field.
  [[nodiscard]] std::optional<Segment> find(std::uint32_t port, double t);

 private:
  void bound_segment(double t, Segment& segment);
  [[nodiscard]] bool follow_path(double t, Segment& segment, Value& held);

  const EventGraph& graph_;
  SensorSimulator& simulator_;
  const DeliveryLog& deliveries_;
  EventTracer& tracer_;
  Value scratch_;  // keeps its memory between calls
};

}  // namespace peerd::animation
