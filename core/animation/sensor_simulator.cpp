#include "core/animation/sensor_simulator.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

namespace peerd::animation {
namespace {

std::uint32_t root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

double next_tick(double now) {
  const double tick = (std::floor(now / SensorSimulator::kTick_s) + 1.0) * SensorSimulator::kTick_s;
  return std::max(tick, std::nextafter(now, std::numeric_limits<double>::infinity()));
}

constexpr std::uint8_t bit(SensorOutput o) { return static_cast<std::uint8_t>(1u << static_cast<unsigned>(o)); }

void sort_unique(std::vector<std::uint32_t>& v) {
  std::ranges::sort(v);
  v.erase(std::ranges::unique(v).begin(), v.end());
}

}  // namespace

SensorSimulator::SensorSimulator(const EventGraph& graph, const Network& network, double read_time_s,
                                 std::size_t max_transitions, std::size_t min_history)
    : graph_(graph), read_time_s_(read_time_s), max_transitions_(max_transitions), min_history_(min_history) {
  const auto sensors = static_cast<std::uint32_t>(graph.sensor_node.size());
  const auto ports = static_cast<std::uint32_t>(graph.ports.size());
  state_history_.resize(sensors);
  version_.assign(sensors, 0);
  stop_pending_.assign(sensors, 0);
  feeds_sensor_inputs_.assign(sensors, 0);
  log_.resize(ports);
  fired_.assign(ports, 0);
  candidate_.assign(ports, 0);
  candidate_at_.assign(ports, 0);

  std::vector<std::uint32_t> parent(sensors + ports);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto element = [&](std::uint32_t port) {
    const EventPort& c = graph.ports[port];
    const bool of_sensor = c.kind == PortKind::kSensorInput || c.kind == PortKind::kSensorOutput;
    return of_sensor ? graph.index_of_node[c.node] : sensors + port;
  };
  for (const Link& link : graph.links) {
    if (link.from == kNone || !graph.ports[link.to].feeds_sensor) continue;
    parent[root(parent, element(link.from))] = root(parent, element(link.to));
    const EventPort& from = graph.ports[link.from];
    if (from.kind == PortKind::kSensorOutput) {
      feeds_sensor_inputs_[graph.index_of_node[from.node]] |= bit(static_cast<SensorOutput>(from.slot));
    }
  }
  std::vector<std::uint32_t> component_of(sensors + ports, kNone);
  const auto component = [&](std::uint32_t e) {
    std::uint32_t& id = component_of[root(parent, e)];
    if (id == kNone) {
      id = component_count();
      components_.emplace_back();
    }
    return id;
  };
  component_of_sensor_.resize(sensors);
  for (std::uint32_t s = 0; s < sensors; ++s) {
    component_of_sensor_[s] = component(s);
    Component& c = components_[component_of_sensor_[s]];
    c.sensors.push_back(s);
    const TimeSensorFields& fields = std::get<TimeSensorFields>(network.nodes[graph.sensor_node[s]]);
    state_history_[s].push_back({-kInfinity, read_sensor(fields, read_time_s)});
    push_due(c, s, -kInfinity);
  }
  component_of_port_.resize(ports, kNone);
  for (std::uint32_t c = 0; c < ports; ++c) {
    if (!graph.ports[c].feeds_sensor) continue;
    component_of_port_[c] = component(element(c));
    components_[component_of_port_[c]].ports.push_back(c);
  }
}

void SensorSimulator::port_added(std::uint32_t port) {
  const EventPort& c = graph_.ports[port];
  component_of_port_.push_back(kNone);
  if (c.kind == PortKind::kSensorInput) {
    component_of_port_[port] = component_of_sensor_[graph_.index_of_node[c.node]];
    components_[component_of_port_[port]].ports.push_back(port);
  }
  log_.emplace_back();
  fired_.push_back(0);
  candidate_.push_back(0);
  candidate_at_.push_back(0);
  assert(log_.size() == port + 1u);
}

double SensorSimulator::due(std::uint32_t sensor, double now) const {
  const TimeSensorState& s = state_history_[sensor].back().state;
  if (now < read_time_s_) {
    if (starts(s, read_time_s_)) return read_time_s_;
    now = read_time_s_;
  }
  double t = next_transition(s, now);
  if (s.active) {
    const std::uint8_t leads = feeds_sensor_inputs_[sensor];
    if (leads & bit(SensorOutput::kCycleTime)) t = std::min(t, next_cycle_start(s.fields, now));
    if (leads & bit(SensorOutput::kTime)) t = std::min(t, next_tick(now));
  } else if (starts(s, now)) {  // it has already started once at this instant
    t = next_tick(now);
  }
  return std::max(t, std::nextafter(now, kInfinity));
}

void SensorSimulator::push_due(Component& c, std::uint32_t sensor, double now) {
  const std::uint32_t version = ++version_[sensor];
  const double t = due(sensor, now);
  if (t == kInfinity) return;
  c.heap.push_back({t, sensor, version});
  std::push_heap(c.heap.begin(), c.heap.end());
}

// The next instant after the horizon, unless the component has stopped.
double SensorSimulator::peek(Component& c) {
  while (!c.heap.empty() && c.heap.front().version != version_[c.heap.front().sensor]) {
    std::pop_heap(c.heap.begin(), c.heap.end());
    c.heap.pop_back();
  }
  const double due_t = c.heap.empty() ? kInfinity : c.heap.front().t;
  const double delivered_t = c.next_delivered < c.delivered.size() ? c.delivered[c.next_delivered].t : kInfinity;
  return std::min(due_t, delivered_t);
}

void SensorSimulator::run_until(Component& c, double t) {
  while (c.simulated_until_s < t) {
    const double next = peek(c);
    if (!(next <= t)) {
      c.simulated_until_s = t;
      return;
    }
    run_instant(c, next);
    c.simulated_until_s = next;
    if (c.transitions - c.transitions_counted_from >= max_transitions_) {
      c.stopped_at_s = next;
      c.simulated_until_s = kInfinity;
    }
    if (c.changes.size() > std::max(min_history_, 8 * (c.sensors.size() + c.ports.size()))) drop_old_history(c);
  }
}

void SensorSimulator::run_or_replay_until(Component& c, double t) {
  if (t < c.history_begin_s) reset(c);
  run_until(c, t);
}

void SensorSimulator::changed(Component& c, double t, std::uint32_t index, bool is_port) {
  c.changes.push_back({t, index, is_port});
  ++c.transitions;
}

// The older half of what is remembered, but for what still holds at the cut.
void SensorSimulator::drop_old_history(Component& c) {
  const double cut = c.changes[c.changes.size() / 2].t;
  c.history_begin_s = cut;
  for (const std::uint32_t s : c.sensors) {  // the first epoch stays, for reset()
    std::vector<TimedState>& history = state_history_[s];
    const auto after = std::ranges::upper_bound(history, cut, {}, &TimedState::t);
    if (after - history.begin() > 2) history.erase(history.begin() + 1, std::prev(after));
  }
  for (const std::uint32_t port : c.ports) {
    std::vector<PortEvent>& log = log_[port];
    const auto after = std::ranges::upper_bound(log, cut, {}, [](const PortEvent& e) { return e.stamp.t; });
    if (after - log.begin() > 1) log.erase(log.begin(), std::prev(after));
  }
  c.changes.erase(c.changes.begin(), std::ranges::lower_bound(c.changes, cut, {}, &Change::t));
}

void SensorSimulator::reset(Component& c) {
  for (const std::uint32_t port : c.ports) log_[port].clear();
  c.heap.clear();
  c.changes.clear();
  c.next_delivered = 0;
  c.transitions = 0;
  c.transitions_counted_from = 0;
  c.history_begin_s = -kInfinity;
  c.simulated_until_s = -kInfinity;
  c.stopped_at_s = kInfinity;
  for (const std::uint32_t s : c.sensors) {
    state_history_[s].resize(1);
    push_due(c, s, -kInfinity);
  }
}

void SensorSimulator::run_instant(Component& c, double t) {
  due_sensors_.clear();
  processed_sensors_.clear();
  while (!c.heap.empty() && c.heap.front().t <= t) {
    const Due d = c.heap.front();
    std::pop_heap(c.heap.begin(), c.heap.end());
    c.heap.pop_back();
    if (d.version == version_[d.sensor]) due_sensors_.push_back(d.sensor);
  }
  std::uint32_t step = 0;
  do {
    sort_unique(due_sensors_);
    processed_sensors_.insert(processed_sensors_.end(), due_sensors_.begin(), due_sensors_.end());
    next_sensors_.clear();
    wave_.clear();
    next_wave_.clear();
    for (const std::uint32_t s : due_sensors_) sensor_phase(c, s, t, step);
    if (step == 0) take_deliveries(c, t);
    cascade(c, t, step);
    std::swap(due_sensors_, next_sensors_);
    ++step;
  } while (!due_sensors_.empty());
  sort_unique(processed_sensors_);
  for (const std::uint32_t s : processed_sensors_) push_due(c, s, t);
}

void SensorSimulator::sensor_phase(Component& c, std::uint32_t sensor, double t, std::uint32_t step) {
  changed(c, t, sensor, false);
  const TimeSensorState& now = state_history_[sensor].back().state;
  if (stop_pending_[sensor]) {
    stop_pending_[sensor] = 0;
    send(sensor, SensorOutput::kIsActive, 0.0);
    send(sensor, SensorOutput::kTime, t);
    next_sensors_.push_back(sensor);  // which may start again
  } else if (now.active && now.end_s <= t) {
    TimeSensorState& s = state_for_change(c, sensor, t);
    stop(s, t, true);
    s.end_step = step;
    send(sensor, SensorOutput::kIsActive, 0.0);
    send(sensor, SensorOutput::kTime, t);
  } else if (now.active && step == 0) {
    if (t > now.begin_s && cycle_start(now.fields, t) == t) send(sensor, SensorOutput::kCycleTime, t);
    send(sensor, SensorOutput::kTime, t);
  } else if (starts(now, t) && !(now.has_run && now.begin_s == t)) {
    TimeSensorState& s = state_for_change(c, sensor, t);
    start(s, t);
    s.begin_step = step;
    send(sensor, SensorOutput::kIsActive, 1.0);
    send(sensor, SensorOutput::kCycleTime, cycle_start(s.fields, t));
    send(sensor, SensorOutput::kTime, t);
  }
}

void SensorSimulator::take_deliveries(Component& c, double t) {
  while (c.next_delivered < c.delivered.size() && c.delivered[c.next_delivered].t <= t) {
    Delivered& d = c.delivered[c.next_delivered++];
    d.transitions = c.transitions;
    c.transitions_counted_from = c.transitions;
    changed(c, t, d.port, true);
    if (!next_wave_.empty() && next_wave_.back().port == d.port) {
      next_wave_.back().value = d.value;
    } else {
      next_wave_.push_back({d.port, kNone, d.value});
    }
  }
}

void SensorSimulator::cascade(Component& c, double t, std::uint32_t step) {
  const std::uint64_t fired = ++mark_;
  std::uint32_t wave = 0;
  while (true) {
    sort_by_field(next_wave_);
    for (const PendingEvent& event : next_wave_) {
      if (!receive(c, event, {t, step, wave})) continue;
      fired_[event.port] = fired;
      wave_.push_back(event);
    }
    if (wave_.empty()) return;
    next_wave_.clear();
    const std::uint64_t wave_mark = ++mark_;
    for (const PendingEvent& event : wave_) {
      for (std::uint32_t r = graph_.ports[event.port].first_out; r != kNone; r = graph_.links[r].next_out) {
        const std::uint32_t to = graph_.links[r].to;
        if (!graph_.ports[to].feeds_sensor || fired_[to] == fired) continue;
        if (candidate_[to] != wave_mark) {
          candidate_[to] = wave_mark;
          candidate_at_[to] = static_cast<std::uint32_t>(next_wave_.size());
          next_wave_.push_back({to, r, event.value});
        } else if (PendingEvent& rival = next_wave_[candidate_at_[to]]; rival.route < r) {
          rival = {to, r, event.value};
        }
      }
    }
    wave_.clear();
    ++wave;
  }
}

// Takes one event; whether it is sent on.
bool SensorSimulator::receive(Component& c, const PendingEvent& event, const Stamp& stamp) {
  const EventPort& port = graph_.ports[event.port];
  if (port.kind == PortKind::kSensorInput) {
    const std::uint32_t sensor = graph_.index_of_node[port.node];
    TimeSensorState s = state_history_[sensor].back().state;
    const SetResult result = set(s, static_cast<SensorInput>(port.slot), event.value, stamp.t);
    if (result == SetResult::kIgnored) return false;
    if (result == SetResult::kSetAndStopped) {
      s.end_step = stamp.step + 1;
      stop_pending_[sensor] = 1;
    }
    state_for_change(c, sensor, stamp.t) = s;
    next_sensors_.push_back(sensor);
  }
  log_[event.port].push_back({stamp, event.value});
  changed(c, stamp.t, event.port, true);
  return true;
}

void SensorSimulator::send(std::uint32_t sensor, SensorOutput output, double value) {
  if (!(feeds_sensor_inputs_[sensor] & bit(output))) return;
  wave_.push_back({graph_.sensor_outputs[sensor][static_cast<std::size_t>(output)], kNone, value});
}

// The sensor's state as of t, to be changed. One epoch a time: of what happens at one t, the last is what holds.
TimeSensorState& SensorSimulator::state_for_change(Component& c, std::uint32_t sensor, double t) {
  std::vector<TimedState>& history = state_history_[sensor];
  if (history.back().t != t) {
    history.push_back({t, history.back().state});
    changed(c, t, sensor, false);
  }
  return history.back().state;
}

void SensorSimulator::sort_by_field(std::vector<PendingEvent>& events) const {
  if (events.size() < 2) return;
  std::ranges::sort(events, {}, [&](const PendingEvent& e) {
    const EventPort& c = graph_.ports[e.port];
    return std::tuple(c.node, c.slot, e.port);
  });
}

const TimeSensorState& SensorSimulator::sensor(std::uint32_t sensor, double t) {
  run_or_replay_until(components_[component_of_sensor_[sensor]], t);
  const std::vector<TimedState>& history = state_history_[sensor];
  if (history.back().t <= t) return history.back().state;
  return std::prev(std::ranges::upper_bound(history, t, {}, &TimedState::t))->state;
}

const PortEvent* SensorSimulator::latest(std::uint32_t port, double t) {
  run_or_replay_until(components_[component_of_port_[port]], t);
  const std::vector<PortEvent>& log = log_[port];
  const auto after = std::ranges::upper_bound(log, t, {}, [](const PortEvent& e) { return e.stamp.t; });
  return after == log.begin() ? nullptr : &*std::prev(after);
}

std::size_t SensorSimulator::change_after(const Component& c, double t) {
  return static_cast<std::size_t>(std::ranges::upper_bound(c.changes, t, {}, &Change::t) - c.changes.begin());
}

double SensorSimulator::previous_instant(std::uint32_t component, double t) {
  Component& c = components_[component];
  run_or_replay_until(c, t);
  const std::size_t after = change_after(c, t);
  return after == 0 ? -kInfinity : c.changes[after - 1].t;
}

double SensorSimulator::next_instant(std::uint32_t component, double t) {
  Component& c = components_[component];
  run_or_replay_until(c, t);
  const std::size_t after = change_after(c, t);
  if (after < c.changes.size()) return c.changes[after].t;
  return c.stopped_at_s < kInfinity ? kInfinity : peek(c);
}

void SensorSimulator::deliver(double t, std::uint32_t port, double value) {
  Component& c = components_[component_of_port_[port]];
  const auto key = [](const Delivered& d) { return std::pair(d.t, d.port); };
  const auto at = std::ranges::upper_bound(c.delivered, std::pair(t, port), {}, key);
  c.delivered.insert(at, {t, port, value, 0});
  if (t <= c.simulated_until_s) roll_back(c, t);
}

// Forgets everything from t on.
void SensorSimulator::roll_back(Component& c, double t) {
  const double before = std::nextafter(t, -kInfinity);
  if (c.stopped_at_s < t) return;  // it stands still
  if (t <= c.history_begin_s) return reset(c);
  processed_sensors_.clear();
  while (!c.changes.empty() && c.changes.back().t >= t) {
    const Change change = c.changes.back();
    c.changes.pop_back();
    --c.transitions;
    if (change.is_port) {
      std::vector<PortEvent>& log = log_[change.index];
      while (!log.empty() && log.back().stamp.t >= t) log.pop_back();
    } else {
      while (state_history_[change.index].back().t >= t) state_history_[change.index].pop_back();
      processed_sensors_.push_back(change.index);
    }
  }
  c.next_delivered =
      static_cast<std::size_t>(std::ranges::lower_bound(c.delivered, t, {}, &Delivered::t) - c.delivered.begin());
  c.transitions_counted_from = c.next_delivered > 0 ? c.delivered[c.next_delivered - 1].transitions : 0;
  c.simulated_until_s = before;
  c.stopped_at_s = kInfinity;
  sort_unique(processed_sensors_);
  for (const std::uint32_t s : processed_sensors_) push_due(c, s, before);
}

std::optional<double> SensorSimulator::transition_limit_reached_at() const {
  double first = kInfinity;
  for (const Component& c : components_) first = std::min(first, c.stopped_at_s);
  return first < kInfinity ? std::optional(first) : std::nullopt;
}

}  // namespace peerd::animation
