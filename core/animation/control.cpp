#include "core/animation/control.hpp"

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
  const double tick = (std::floor(now / Control::kTick_s) + 1.0) * Control::kTick_s;
  return std::max(tick, std::nextafter(now, std::numeric_limits<double>::infinity()));
}

constexpr std::uint8_t bit(SensorOutput o) { return static_cast<std::uint8_t>(1u << static_cast<unsigned>(o)); }

void sort_unique(std::vector<std::uint32_t>& v) {
  std::ranges::sort(v);
  v.erase(std::ranges::unique(v).begin(), v.end());
}

}  // namespace

Control::Control(const CellGraph& graph, const Network& network, double read_time_s, std::size_t most_transitions,
                 std::size_t remembered)
    : graph_(graph), read_time_s_(read_time_s), most_transitions_(most_transitions), remembered_(remembered) {
  const auto sensors = static_cast<std::uint32_t>(graph.sensor_node.size());
  const auto cells = static_cast<std::uint32_t>(graph.cells.size());
  epochs_.resize(sensors);
  version_.assign(sensors, 0);
  stop_pending_.assign(sensors, 0);
  leads_to_control_.assign(sensors, 0);
  log_.resize(cells);
  fired_.assign(cells, 0);
  candidate_.assign(cells, 0);
  candidate_at_.assign(cells, 0);

  std::vector<std::uint32_t> parent(sensors + cells);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto element = [&](std::uint32_t cell) {
    const Cell& c = graph.cells[cell];
    const bool of_sensor = c.kind == CellKind::kSensorInput || c.kind == CellKind::kSensorOutput;
    return of_sensor ? graph.index_of_node[c.node] : sensors + cell;
  };
  for (const Link& link : graph.links) {
    if (link.from == kNone || !graph.cells[link.to].control) continue;
    parent[root(parent, element(link.from))] = root(parent, element(link.to));
    const Cell& from = graph.cells[link.from];
    if (from.kind == CellKind::kSensorOutput) {
      leads_to_control_[graph.index_of_node[from.node]] |= bit(static_cast<SensorOutput>(from.port));
    }
  }
  std::vector<std::uint32_t> component_of(sensors + cells, kNone);
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
    epochs_[s].push_back({-kInfinity, read_sensor(fields, read_time_s)});
    push_due(c, s, -kInfinity);
  }
  component_of_cell_.resize(cells, kNone);
  for (std::uint32_t c = 0; c < cells; ++c) {
    if (!graph.cells[c].control) continue;
    component_of_cell_[c] = component(element(c));
    components_[component_of_cell_[c]].cells.push_back(c);
  }
}

void Control::cell_added(std::uint32_t cell) {
  const Cell& c = graph_.cells[cell];
  component_of_cell_.push_back(kNone);
  if (c.kind == CellKind::kSensorInput) {
    component_of_cell_[cell] = component_of_sensor_[graph_.index_of_node[c.node]];
    components_[component_of_cell_[cell]].cells.push_back(cell);
  }
  log_.emplace_back();
  fired_.push_back(0);
  candidate_.push_back(0);
  candidate_at_.push_back(0);
  assert(log_.size() == cell + 1u);
}

double Control::due(std::uint32_t sensor, double now) const {
  const TimeSensorState& s = epochs_[sensor].back().state;
  if (now < read_time_s_) {
    if (starts(s, read_time_s_)) return read_time_s_;
    now = read_time_s_;
  }
  double t = next_transition(s, now);
  if (s.active) {
    const std::uint8_t leads = leads_to_control_[sensor];
    if (leads & bit(SensorOutput::kCycleTime)) t = std::min(t, next_cycle_start(s.fields, now));
    if (leads & bit(SensorOutput::kTime)) t = std::min(t, next_tick(now));
  } else if (starts(s, now)) {  // it has already started once at this instant
    t = next_tick(now);
  }
  return std::max(t, std::nextafter(now, kInfinity));
}

void Control::push_due(Component& c, std::uint32_t sensor, double now) {
  const std::uint32_t version = ++version_[sensor];
  const double t = due(sensor, now);
  if (t == kInfinity) return;
  c.heap.push_back({t, sensor, version});
  std::push_heap(c.heap.begin(), c.heap.end());
}

// The next instant after the horizon, unless the component has stopped.
double Control::peek(Component& c) {
  while (!c.heap.empty() && c.heap.front().version != version_[c.heap.front().sensor]) {
    std::pop_heap(c.heap.begin(), c.heap.end());
    c.heap.pop_back();
  }
  const double due_t = c.heap.empty() ? kInfinity : c.heap.front().t;
  const double delivered_t = c.next_delivered < c.delivered.size() ? c.delivered[c.next_delivered].t : kInfinity;
  return std::min(due_t, delivered_t);
}

void Control::run_until(Component& c, double t) {
  while (c.horizon < t) {
    const double next = peek(c);
    if (!(next <= t)) {
      c.horizon = t;
      return;
    }
    run_instant(c, next);
    c.horizon = next;
    if (c.transitions - c.transitions_counted_from >= most_transitions_) {
      c.frozen_at = next;
      c.horizon = kInfinity;
    }
    if (c.changes.size() > std::max(remembered_, 8 * (c.sensors.size() + c.cells.size()))) forget(c);
  }
}

void Control::seek(Component& c, double t) {
  if (t < c.known_from) reset(c);
  run_until(c, t);
}

void Control::changed(Component& c, double t, std::uint32_t index, bool is_cell) {
  c.changes.push_back({t, index, is_cell});
  ++c.transitions;
}

// The older half of what is remembered, but for what still holds at the cut.
void Control::forget(Component& c) {
  const double cut = c.changes[c.changes.size() / 2].t;
  c.known_from = cut;
  for (const std::uint32_t s : c.sensors) {  // the first epoch stays, for reset()
    std::vector<Epoch>& epochs = epochs_[s];
    const auto after = std::ranges::upper_bound(epochs, cut, {}, &Epoch::t);
    if (after - epochs.begin() > 2) epochs.erase(epochs.begin() + 1, std::prev(after));
  }
  for (const std::uint32_t cell : c.cells) {
    std::vector<CellEvent>& log = log_[cell];
    const auto after = std::ranges::upper_bound(log, cut, {}, [](const CellEvent& e) { return e.stamp.t; });
    if (after - log.begin() > 1) log.erase(log.begin(), std::prev(after));
  }
  c.changes.erase(c.changes.begin(), std::ranges::lower_bound(c.changes, cut, {}, &Change::t));
}

void Control::reset(Component& c) {
  for (const std::uint32_t cell : c.cells) log_[cell].clear();
  c.heap.clear();
  c.changes.clear();
  c.next_delivered = 0;
  c.transitions = 0;
  c.transitions_counted_from = 0;
  c.known_from = -kInfinity;
  c.horizon = -kInfinity;
  c.frozen_at = kInfinity;
  for (const std::uint32_t s : c.sensors) {
    epochs_[s].resize(1);
    push_due(c, s, -kInfinity);
  }
}

void Control::run_instant(Component& c, double t) {
  look_.clear();
  looked_.clear();
  while (!c.heap.empty() && c.heap.front().t <= t) {
    const Due d = c.heap.front();
    std::pop_heap(c.heap.begin(), c.heap.end());
    c.heap.pop_back();
    if (d.version == version_[d.sensor]) look_.push_back(d.sensor);
  }
  std::uint32_t step = 0;
  do {
    sort_unique(look_);
    looked_.insert(looked_.end(), look_.begin(), look_.end());
    look_next_.clear();
    front_.clear();
    arriving_.clear();
    for (const std::uint32_t s : look_) sensor_phase(c, s, t, step);
    if (step == 0) take_deliveries(c, t);
    cascade(c, t, step);
    std::swap(look_, look_next_);
    ++step;
  } while (!look_.empty());
  sort_unique(looked_);
  for (const std::uint32_t s : looked_) push_due(c, s, t);
}

void Control::sensor_phase(Component& c, std::uint32_t sensor, double t, std::uint32_t step) {
  changed(c, t, sensor, false);
  const TimeSensorState& now = epochs_[sensor].back().state;
  if (stop_pending_[sensor]) {
    stop_pending_[sensor] = 0;
    send(sensor, SensorOutput::kIsActive, 0.0);
    send(sensor, SensorOutput::kTime, t);
    look_next_.push_back(sensor);  // which may start again
  } else if (now.active && now.end_s <= t) {
    TimeSensorState& s = touch(c, sensor, t);
    stop(s, t, true);
    s.end_step = step;
    send(sensor, SensorOutput::kIsActive, 0.0);
    send(sensor, SensorOutput::kTime, t);
  } else if (now.active && step == 0) {
    if (t > now.begin_s && cycle_start(now.fields, t) == t) send(sensor, SensorOutput::kCycleTime, t);
    send(sensor, SensorOutput::kTime, t);
  } else if (starts(now, t) && !(now.ran && now.begin_s == t)) {
    TimeSensorState& s = touch(c, sensor, t);
    start(s, t);
    s.begin_step = step;
    send(sensor, SensorOutput::kIsActive, 1.0);
    send(sensor, SensorOutput::kCycleTime, cycle_start(s.fields, t));
    send(sensor, SensorOutput::kTime, t);
  }
}

void Control::take_deliveries(Component& c, double t) {
  while (c.next_delivered < c.delivered.size() && c.delivered[c.next_delivered].t <= t) {
    Delivered& d = c.delivered[c.next_delivered++];
    d.transitions = c.transitions;
    c.transitions_counted_from = c.transitions;
    changed(c, t, d.cell, true);
    if (!arriving_.empty() && arriving_.back().cell == d.cell) {
      arriving_.back().value = d.value;
    } else {
      arriving_.push_back({d.cell, kNone, d.value});
    }
  }
}

void Control::cascade(Component& c, double t, std::uint32_t step) {
  const std::uint64_t fired = ++mark_;
  std::uint32_t wave = 0;
  while (true) {
    by_field(arriving_);
    for (const Sent& event : arriving_) {
      if (!arrive(c, event, {t, step, wave})) continue;
      fired_[event.cell] = fired;
      front_.push_back(event);
    }
    if (front_.empty()) return;
    arriving_.clear();
    const std::uint64_t wave_mark = ++mark_;
    for (const Sent& event : front_) {
      for (std::uint32_t r = graph_.cells[event.cell].first_out; r != kNone; r = graph_.links[r].next_out) {
        const std::uint32_t to = graph_.links[r].to;
        if (!graph_.cells[to].control || fired_[to] == fired) continue;
        if (candidate_[to] != wave_mark) {
          candidate_[to] = wave_mark;
          candidate_at_[to] = static_cast<std::uint32_t>(arriving_.size());
          arriving_.push_back({to, r, event.value});
        } else if (Sent& rival = arriving_[candidate_at_[to]]; rival.route < r) {
          rival = {to, r, event.value};
        }
      }
    }
    front_.clear();
    ++wave;
  }
}

// Takes one event; whether it is sent on.
bool Control::arrive(Component& c, const Sent& event, const Stamp& stamp) {
  const Cell& cell = graph_.cells[event.cell];
  if (cell.kind == CellKind::kSensorInput) {
    const std::uint32_t sensor = graph_.index_of_node[cell.node];
    TimeSensorState s = epochs_[sensor].back().state;
    const SetResult result = set(s, static_cast<SensorInput>(cell.port), event.value, stamp.t);
    if (result == SetResult::kIgnored) return false;
    if (result == SetResult::kSetAndStopped) {
      s.end_step = stamp.step + 1;
      stop_pending_[sensor] = 1;
    }
    touch(c, sensor, stamp.t) = s;
    look_next_.push_back(sensor);
  }
  log_[event.cell].push_back({stamp, event.value});
  changed(c, stamp.t, event.cell, true);
  return true;
}

void Control::send(std::uint32_t sensor, SensorOutput output, double value) {
  if (!(leads_to_control_[sensor] & bit(output))) return;
  front_.push_back({graph_.sensor_outputs[sensor][static_cast<std::size_t>(output)], kNone, value});
}

// The sensor's state as of t, to be changed. One epoch a time: of what happens at one t, the last is what holds.
TimeSensorState& Control::touch(Component& c, std::uint32_t sensor, double t) {
  std::vector<Epoch>& epochs = epochs_[sensor];
  if (epochs.back().t != t) {
    epochs.push_back({t, epochs.back().state});
    changed(c, t, sensor, false);
  }
  return epochs.back().state;
}

void Control::by_field(std::vector<Sent>& events) const {
  if (events.size() < 2) return;
  std::ranges::sort(events, {}, [&](const Sent& e) {
    const Cell& c = graph_.cells[e.cell];
    return std::tuple(c.node, c.port, e.cell);
  });
}

const TimeSensorState& Control::sensor(std::uint32_t sensor, double t) {
  seek(components_[component_of_sensor_[sensor]], t);
  const std::vector<Epoch>& epochs = epochs_[sensor];
  if (epochs.back().t <= t) return epochs.back().state;
  return std::prev(std::ranges::upper_bound(epochs, t, {}, &Epoch::t))->state;
}

const CellEvent* Control::latest(std::uint32_t cell, double t) {
  seek(components_[component_of_cell_[cell]], t);
  const std::vector<CellEvent>& log = log_[cell];
  const auto after = std::ranges::upper_bound(log, t, {}, [](const CellEvent& e) { return e.stamp.t; });
  return after == log.begin() ? nullptr : &*std::prev(after);
}

std::size_t Control::change_after(const Component& c, double t) {
  return static_cast<std::size_t>(std::ranges::upper_bound(c.changes, t, {}, &Change::t) - c.changes.begin());
}

double Control::previous_instant(std::uint32_t component, double t) {
  Component& c = components_[component];
  seek(c, t);
  const std::size_t after = change_after(c, t);
  return after == 0 ? -kInfinity : c.changes[after - 1].t;
}

double Control::next_instant(std::uint32_t component, double t) {
  Component& c = components_[component];
  seek(c, t);
  const std::size_t after = change_after(c, t);
  if (after < c.changes.size()) return c.changes[after].t;
  return c.frozen_at < kInfinity ? kInfinity : peek(c);
}

void Control::deliver(double t, std::uint32_t cell, double value) {
  Component& c = components_[component_of_cell_[cell]];
  const auto key = [](const Delivered& d) { return std::pair(d.t, d.cell); };
  const auto at = std::ranges::upper_bound(c.delivered, std::pair(t, cell), {}, key);
  c.delivered.insert(at, {t, cell, value, 0});
  if (t <= c.horizon) roll_back(c, t);
}

// Forgets everything from t on.
void Control::roll_back(Component& c, double t) {
  const double before = std::nextafter(t, -kInfinity);
  if (c.frozen_at < t) return;  // it stands still
  if (t <= c.known_from) return reset(c);
  looked_.clear();
  while (!c.changes.empty() && c.changes.back().t >= t) {
    const Change change = c.changes.back();
    c.changes.pop_back();
    --c.transitions;
    if (change.is_cell) {
      std::vector<CellEvent>& log = log_[change.index];
      while (!log.empty() && log.back().stamp.t >= t) log.pop_back();
    } else {
      while (epochs_[change.index].back().t >= t) epochs_[change.index].pop_back();
      looked_.push_back(change.index);
    }
  }
  c.next_delivered =
      static_cast<std::size_t>(std::ranges::lower_bound(c.delivered, t, {}, &Delivered::t) - c.delivered.begin());
  c.transitions_counted_from = c.next_delivered > 0 ? c.delivered[c.next_delivered - 1].transitions : 0;
  c.horizon = before;
  c.frozen_at = kInfinity;
  sort_unique(looked_);
  for (const std::uint32_t s : looked_) push_due(c, s, before);
}

std::optional<double> Control::limited_at() const {
  double first = kInfinity;
  for (const Component& c : components_) first = std::min(first, c.frozen_at);
  return first < kInfinity ? std::optional(first) : std::nullopt;
}

}  // namespace peerd::animation
