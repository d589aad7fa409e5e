#include "core/animation/animation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/animation/change_tracker.hpp"
#include "core/animation/delivery_log.hpp"
#include "core/animation/event_graph.hpp"
#include "core/animation/event_tracer.hpp"
#include "core/animation/segment_finder.hpp"
#include "core/animation/sensor_simulator.hpp"

namespace peerd::animation {

namespace {

bool is_finite(const Value& v) {
  return std::ranges::all_of(v.number, [](double x) { return std::isfinite(x); }) &&
         std::ranges::all_of(v.numbers, [](float x) { return std::isfinite(x); });
}

}  // namespace

struct Animation::Parts {
  Parts(const Network& network, const AnimationOptions& options)
      : graph(network),
        simulator(graph, network, options.read_time_s, options.max_transitions, options.min_history),
        tracer(graph, simulator, deliveries),
        segments(graph, simulator, deliveries, tracer),
        changes(graph, simulator, deliveries),
        read_time_s(options.read_time_s) {
    grow();
  }

  void grow() {
    deliveries.grow(graph.ports.size());
    tracer.grow(graph.ports.size());
    changes.grow(graph.ports.size());
  }

  std::optional<std::uint32_t> find_or_add(std::uint32_t node, std::string_view name, FieldType type, bool in) {
    const std::size_t ports = graph.ports.size();
    const auto port = graph.find_or_add(node, name, type, in);
    if (graph.ports.size() != ports) {
      grow();
      simulator.port_added(*port);
    }
    return port;
  }

  EventGraph graph;
  SensorSimulator simulator;
  DeliveryLog deliveries;
  EventTracer tracer;
  SegmentFinder segments;
  ChangeTracker changes;
  double read_time_s;
};

Animation::Animation(const Network& network, const AnimationOptions& options)
    : parts_(std::make_unique<Parts>(network, options)) {}
Animation::~Animation() = default;
Animation::Animation(Animation&&) noexcept = default;
Animation& Animation::operator=(Animation&&) noexcept = default;

std::span<const Finding> Animation::findings() const { return parts_->graph.findings; }

std::optional<FieldId> Animation::field(std::uint32_t node, std::string_view name) {
  auto port = parts_->graph.find(node, name);
  if (!port && !parts_->graph.is_plain(node)) port = parts_->find_or_add(node, name, FieldType::kFloat, false);
  return port ? std::optional(FieldId{*port}) : std::nullopt;
}

Field Animation::describe(FieldId id) const {
  const EventPort& c = parts_->graph.ports[id.value];
  return {id, c.node, parts_->graph.names[c.name], c.type};
}

std::vector<Field> Animation::driven() const {
  const std::vector<EventPort>& ports = parts_->graph.ports;
  std::vector<Field> out;
  for (std::uint32_t c = 0; c < ports.size(); ++c) {
    if (ports[c].driven && ports[c].kind != PortKind::kInterpolator) out.push_back(describe({c}));
  }
  return out;
}

bool Animation::value(FieldId id, double t, Value& out) {
  assert(std::isfinite(t));
  if (!parts_->tracer.find(id.value, t, EventTracer::At::kNow)) return false;
  parts_->tracer.evaluate(t, out);
  return true;
}

std::optional<Segment> Animation::segment(FieldId id, double t) {
  assert(std::isfinite(t));
  return parts_->segments.find(id.value, t);
}

void Animation::changing(double from_s, double to_s, std::vector<FieldId>& out) {
  assert(std::isfinite(from_s) && std::isfinite(to_s) && from_s <= to_s);
  parts_->changes.changing(from_s, to_s, out);
}

std::optional<DeliverError> Animation::deliver(double t, std::uint32_t node, std::string_view name,
                                               const Value& value) {
  if (!std::isfinite(t) || !is_finite(value)) return DeliverError::kNotFinite;
  if (t < parts_->read_time_s) return DeliverError::kBeforeRead;
  const auto port = parts_->find_or_add(node, name, value.type, true);
  if (!port) return DeliverError::kNoSuchField;
  const EventPort& c = parts_->graph.ports[*port];
  if (value.type != (c.kind == PortKind::kInterpolator ? FieldType::kFloat : c.type)) return DeliverError::kType;
  if (c.feeds_sensor) {
    parts_->simulator.deliver(t, *port, value.scalar());
    parts_->changes.note_sensor_delivery(*port, t);
    return std::nullopt;
  }
  Value& kept = parts_->deliveries.insert(*port, t, value);
  if (c.kind == PortKind::kKey && c.slot == 0) sort_keys(kept.numbers);
  parts_->changes.note_delivery(*port, t);
  return std::nullopt;
}

std::optional<double> Animation::transition_limit_reached_at() const {
  return parts_->simulator.transition_limit_reached_at();
}

}  // namespace peerd::animation
