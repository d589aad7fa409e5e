#include "core/animation/event_tracer.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace peerd::animation {

namespace {

bool is_float_or_time(const EventPort& c) {
  return c.slot == static_cast<std::uint8_t>(SensorOutput::kFraction) ||
         c.slot == static_cast<std::uint8_t>(SensorOutput::kTime);
}

}  // namespace

void EventTracer::grow(std::size_t ports) {
  seen_.resize(ports, 0);
  reached_.resize(ports, 0);
  via_.resize(ports, kNone);
}

// Ports whose latest event is known without looking further upstream.
bool EventTracer::is_source(const EventPort& c) const {
  return c.feeds_sensor || c.kind == PortKind::kSensorOutput || c.kind == PortKind::kKey;
}

// A port's own latest event at or before t, those that come over ROUTEs left out unless it is a leaf.
std::optional<Stamp> EventTracer::source_event(std::uint32_t port, double t, At at) {
  const EventPort& c = graph_.ports[port];
  if (c.feeds_sensor) {
    const PortEvent* event = simulator_.latest(port, t);
    return event ? std::optional(event->stamp) : std::nullopt;
  }
  if (c.kind != PortKind::kSensorOutput) {
    const Delivered* d = deliveries_.latest(port, t);
    return d ? std::optional(Stamp{d->t, 0, 0}) : std::nullopt;
  }
  const std::uint32_t sensor = graph_.index_of_node[c.node];
  const TimeSensorState& s = simulator_.sensor(sensor, t);
  const double last = simulator_.last_time(simulator_.component_of_sensor(sensor));
  t = std::min(t, last);
  if (!s.has_run) return std::nullopt;
  const auto since = [&](double when) { return Stamp{when, when == s.begin_s ? s.begin_step : 0, 0}; };
  if (c.slot == static_cast<std::uint8_t>(SensorOutput::kCycleTime)) {
    return since(std::max(s.active ? cycle_start(s.fields, t) : s.final_cycle_s, s.begin_s));
  }
  if (!s.active) return Stamp{s.end_s, s.end_step, 0};
  if (!is_float_or_time(c)) return Stamp{s.begin_s, s.begin_step, 0};
  return at == At::kJustAfter && t < last ? Stamp{kInfinity, 0, 0} : since(t);
}

Keys EventTracer::keys_at(std::uint32_t port, double t) const {
  const std::uint32_t i = graph_.index_of_node[graph_.ports[port].node];
  Keys keys = keys_of(graph_.interpolators[i]);
  const auto [key, key_value] = graph_.key_ports[i];
  if (key != kNone) {
    if (const Delivered* d = deliveries_.latest(key, t)) keys.key = d->value.numbers;
  }
  if (key_value != kNone) {
    if (const Delivered* d = deliveries_.latest(key_value, t)) keys.key_value = d->value.numbers;
  }
  return keys;
}

// Returns whether the port sends an event on that reaches it at t.
bool EventTracer::interpolates(std::uint32_t port, double t) const {
  const EventPort& c = graph_.ports[port];
  if (c.kind != PortKind::kInterpolator) return true;
  return sends(graph_.interpolators[graph_.index_of_node[c.node]].type, keys_at(port, t));
}

// Follows the single chain of ROUTEs that most fields hang on, where there is nothing to choose. Returns false if there
// is a choice.
bool EventTracer::find_simple_path(std::uint32_t port, double t, At at, bool& found) {
  const std::uint64_t mark = ++mark_;
  path_.clear();
  found = false;
  while (true) {
    if (std::exchange(seen_[port], mark) == mark) return false;  // a ring
    const EventPort& c = graph_.ports[port];
    path_.push_back(port);
    if (is_source(c)) break;
    if (deliveries_.has(port)) return false;
    if (c.first_in == kNone) break;
    const Link& link = graph_.links[c.first_in];
    if (link.next_in != kNone) return false;
    port = link.from;
  }
  upstream_ = path_;
  const auto stamp = source_event(port, t, at);  // none of a port that nothing leads to
  if (!stamp) return true;
  source_ = {*stamp, port};
  found = std::ranges::all_of(path_, [&](std::uint32_t c) { return interpolates(c, std::min(stamp->t, t)); });
  return true;
}

// Finds the event that is the port's latest at or before t (or just after t), into source_ and path_: collects all that
// is upstream, then lets the sources' events spread, the latest timestamp first, wave by wave, each port taking the
// first that reaches it.
bool EventTracer::find(std::uint32_t port, double t, At at) {
  if (bool found = false; find_simple_path(port, t, at, found)) return found;
  const std::uint64_t question = ++mark_;
  upstream_.assign(1, port);
  sources_.clear();
  seen_[port] = question;
  for (std::size_t i = 0; i < upstream_.size(); ++i) {
    const std::uint32_t at_port = upstream_[i];
    if (const auto stamp = source_event(at_port, t, at); stamp && interpolates(at_port, std::min(stamp->t, t))) {
      sources_.push_back({*stamp, at_port});
    }
    const EventPort& c = graph_.ports[at_port];
    if (is_source(c)) continue;
    for (std::uint32_t r = c.first_in; r != kNone; r = graph_.links[r].next_in) {
      const std::uint32_t from = graph_.links[r].from;
      if (std::exchange(seen_[from], question) != question) upstream_.push_back(from);
    }
  }
  std::ranges::sort(sources_, [](const Source& a, const Source& b) {
    return std::tuple(b.stamp.t, b.stamp.step, a.stamp.wave, a.port) <
           std::tuple(a.stamp.t, a.stamp.step, b.stamp.wave, b.port);
  });
  const Source* const end = sources_.data() + sources_.size();
  for (const Source* group = sources_.data(); group != end && reached_[port] <= question;) {
    const Source* group_end = group;
    while (group_end != end && group_end->stamp.t == group->stamp.t && group_end->stamp.step == group->stamp.step) {
      ++group_end;
    }
    source_ = *group;
    wave_.clear();
    propagate(group, group_end, port);
    group = group_end;
  }
  if (reached_[port] <= question) return false;
  path_.clear();
  path_.push_back(port);
  while (via_[path_.back()] != kNone) path_.push_back(graph_.links[via_[path_.back()]].from);
  source_.port = path_.back();
  return true;
}

// The events of one timestamp. A port is claimed if its mark is above the question's, seen_[target].
void EventTracer::propagate(const Source* group, const Source* group_end, std::uint32_t target) {
  const std::uint64_t question = seen_[target];
  const double t = group->stamp.t;
  for (std::uint32_t wave = group->stamp.wave; group != group_end || !wave_.empty(); ++wave) {
    if (wave_.empty()) wave = group->stamp.wave;
    for (; group != group_end && group->stamp.wave == wave; ++group) {
      if (reached_[group->port] > question) continue;
      reached_[group->port] = ++mark_;
      via_[group->port] = kNone;
      wave_.push_back(group->port);
    }
    if (reached_[target] > question) return;
    const std::uint64_t wave_mark = ++mark_;
    next_wave_.clear();
    for (const std::uint32_t from : wave_) {
      for (std::uint32_t r = graph_.ports[from].first_out; r != kNone; r = graph_.links[r].next_out) {
        const std::uint32_t to = graph_.links[r].to;
        if (seen_[to] != question || is_source(graph_.ports[to])) continue;
        if (reached_[to] == wave_mark) {
          via_[to] = std::max(via_[to], r);
        } else if (reached_[to] <= question && interpolates(to, t)) {
          reached_[to] = wave_mark;
          via_[to] = r;
          next_wave_.push_back(to);
        }
      }
    }
    std::swap(wave_, next_wave_);
  }
}

// The event of source_, as it arrives at the other end of path_.
void EventTracer::evaluate(double t, Value& out) {
  const EventPort& source = graph_.ports[source_.port];
  const double when = std::min(source_.stamp.t, t);
  std::size_t next = path_.size() - 1;  // the first port of the path that has yet to take the event
  if (source.feeds_sensor) {
    out.set(source.type, simulator_.latest(source_.port, t)->value);
  } else if (source.kind == PortKind::kSensorOutput) {
    const std::uint32_t sensor = graph_.index_of_node[source.node];
    const double last = simulator_.last_time(simulator_.component_of_sensor(sensor));
    const TimeSensorOutput o = *output(simulator_.sensor(sensor, t), std::min(t, last));
    const double by_slot[] = {o.is_active ? 1.0 : 0.0, o.cycle_time_s, o.fraction, o.time_s};
    out.set(source.type, by_slot[source.slot]);
  } else {
    out = deliveries_.latest(source_.port, t)->value;
    ++next;
  }
  while (next-- > 0) {
    const EventPort& c = graph_.ports[path_[next]];
    if (c.kind != PortKind::kInterpolator) continue;
    const InterpolatorType type = graph_.interpolators[graph_.index_of_node[c.node]].type;
    animation::evaluate(type, keys_at(path_[next], when), out.scalar(), out);
  }
}

}  // namespace peerd::animation
