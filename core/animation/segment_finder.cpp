#include "core/animation/segment_finder.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/animation/spherical_interpolation.hpp"

namespace peerd::animation {

namespace {

// A Line is a number that changes evenly: value + (t - at_s) / duration_s.
struct Line {
  double at_s = 0.0;
  double value = 0.0;
  double duration_s = 1.0;  // time for a change by 1; < 0 if the number falls

  [[nodiscard]] double at(double t) const { return value + (t - at_s) / duration_s; }
  [[nodiscard]] double time_of(double x) const { return at_s + (x - value) * duration_s; }
};

struct Piece {
  std::size_t a = 0;  // keys; a == b outside the ends
  std::size_t b = 0;
};

// Returns the keys that the line lies between just after t, and cuts the segment to the time that it does.
Piece enter_piece(std::span<const float> key, const Line& line, double t, Segment& s) {
  const auto not_before = [&](double x) { s.begin_s = std::max(s.begin_s, std::min(line.time_of(x), t)); };
  const auto not_after = [&](double x) {
    s.end_s = std::min(s.end_s, std::max(line.time_of(x), std::nextafter(t, kInfinity)));
  };
  const double x = line.at(t);
  const std::size_t last = key.size() - 1;
  if (line.duration_s > 0.0) {
    if (x < key[0]) return not_after(key[0]), Piece{0, 0};
    if (!(x < key[last])) return not_before(key[last]), Piece{last, last};
    const auto b = static_cast<std::size_t>(std::ranges::upper_bound(key, x) - key.begin());
    not_before(key[b - 1]);
    not_after(key[b]);
    return {b - 1, b};
  }
  if (x > key[last]) return not_after(key[last]), Piece{last, last};
  if (!(x > key[0])) return not_before(key[0]), Piece{0, 0};
  const auto b = static_cast<std::size_t>(std::ranges::lower_bound(key, x) - key.begin());
  not_before(key[b]);
  not_after(key[b - 1]);
  return {b - 1, b};
}

void hold(const Value& value, Segment& s) {
  s.is_constant = true;
  if (value.type == FieldType::kRotation) {
    s.orientation = value.quat();
  } else {
    s.position = value.vec3();
  }
}

}  // namespace

// Bounds the segment by the instants at which something upstream starts, stops or is delivered.
void SegmentFinder::bound_segment(double t, Segment& s) {
  const auto bound_by_deliveries = [&](std::uint32_t port) {
    if (port == kNone) return;
    if (const Delivered* const next = deliveries_.next(port, t)) s.end_s = std::min(s.end_s, next->t);
    if (const Delivered* const latest = deliveries_.latest(port, t)) s.begin_s = std::max(s.begin_s, latest->t);
  };
  for (const std::uint32_t port : tracer_.upstream()) {
    const EventPort& c = graph_.ports[port];
    if (c.feeds_sensor || c.kind == PortKind::kSensorOutput) {
      const std::uint32_t component = c.feeds_sensor ? simulator_.component_of_port(port)
                                                     : simulator_.component_of_sensor(graph_.index_of_node[c.node]);
      s.begin_s = std::max(s.begin_s, simulator_.previous_instant(component, t));
      s.end_s = std::min(s.end_s, simulator_.next_instant(component, t));
      // The latest cycleTime changes with the cycles, which need not be instants of the simulator.
      if (!c.feeds_sensor && c.slot == static_cast<std::uint8_t>(SensorOutput::kCycleTime)) {
        const TimeSensorState& sensor = simulator_.sensor(graph_.index_of_node[c.node], t);
        if (sensor.active && t < simulator_.last_time(component)) {
          s.begin_s = std::max(s.begin_s, cycle_start(sensor.fields, t));
          s.end_s = std::min(s.end_s, next_cycle_start(sensor.fields, t));
        }
      }
    } else {
      bound_by_deliveries(port);
      if (c.kind == PortKind::kInterpolator) {
        for (const std::uint32_t key : graph_.key_ports[graph_.index_of_node[c.node]]) bound_by_deliveries(key);
      }
    }
  }
}

std::optional<Segment> SegmentFinder::find(std::uint32_t port, double t) {
  Segment s;
  const bool found = tracer_.find(port, t, EventTracer::At::kJustAfter);
  bound_segment(t, s);
  s.initial = !found;
  if (found && !follow_path(t, s, scratch_)) return std::nullopt;
  return s;
}

// Follows the movement along the path from t on. Returns false if a segment cannot describe it.
bool SegmentFinder::follow_path(double t, Segment& s, Value& held) {
  const std::span<const std::uint32_t> path = tracer_.path();
  const EventPort& source = graph_.ports[tracer_.source().port];
  if (tracer_.source().stamp.t != kInfinity) {  // the source is no continuous eventOut of an active sensor
    tracer_.evaluate(t, held);
    hold(held, s);
    return true;
  }
  const TimeSensorFields& fields = simulator_.sensor(graph_.index_of_node[source.node], t).fields;
  Line line;  // `time`
  if (source.slot == static_cast<std::uint8_t>(SensorOutput::kFraction)) {
    line = {cycle_start(fields, t), 0.0, fields.cycle_interval};
    s.begin_s = std::max(s.begin_s, line.at_s);
    s.end_s = std::min(s.end_s, next_cycle_start(fields, t));
  }
  s.is_constant = false;
  for (std::size_t i = path.size() - 1; i-- > 0;) {
    const EventPort& c = graph_.ports[path[i]];
    if (c.kind != PortKind::kInterpolator) continue;
    const InterpolatorType type = graph_.interpolators[graph_.index_of_node[c.node]].type;
    const Keys keys = usable(type, tracer_.keys_at(path[i], t));
    if (s.is_constant) {
      evaluate(type, keys, held.scalar(), held);
      continue;
    }
    const auto [a, b] = enter_piece(keys.key, line, t, s);
    if (a == b) {
      evaluate(type, keys, a == 0 ? -kInfinity : kInfinity, held);
      s.is_constant = true;
      continue;
    }
    const double ka = keys.key[a];
    const double gap = keys.key[b] - ka;
    const double duration_s = gap * line.duration_s;  // duration of the whole piece; < 0 if the fraction falls
    // The weight is taken at begin_s. The time at which the line met key a can be far away where the line is nearly
    // level.
    const double weight = (line.at(s.begin_s) - ka) / gap;
    switch (type) {
      case InterpolatorType::kScalar: {
        const double va = keys.key_value[a];
        const double change = keys.key_value[b] - va;
        s.is_constant = change == 0.0;
        held.set(FieldType::kFloat, va);
        line = {s.begin_s, va + weight * change, duration_s / change};
        break;
      }
      case InterpolatorType::kPosition: {
        const Vec3 va = position_at(keys, a);
        const Vec3 change = position_at(keys, b) - va;
        s.velocity = change / duration_s;
        s.position = va + weight * change;
        s.is_constant = change == Vec3::Zero();
        return true;
      }
      case InterpolatorType::kOrientation: {
        const Quat qa = orientation_at(keys, a);
        const Vec3 change = rotation_between(qa, orientation_at(keys, b));
        s.angular_velocity_body = change / duration_s;
        s.orientation = rotated_in_body_frame(qa, weight * change);
        s.is_constant = change == Vec3::Zero();
        return true;
      }
      case InterpolatorType::kCoordinate:
        return true;
      case InterpolatorType::kColor:
      case InterpolatorType::kNormal:
        return false;
    }
  }
  if (s.is_constant) {
    hold(held, s);
  } else {
    s.position = {line.at(s.begin_s), 0.0, 0.0};
    s.velocity = {1.0 / line.duration_s, 0.0, 0.0};
  }
  return true;
}

}  // namespace peerd::animation
