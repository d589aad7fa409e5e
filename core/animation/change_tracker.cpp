#include "core/animation/change_tracker.hpp"

#include <algorithm>
#include <utility>

namespace peerd::animation {

void ChangeTracker::changing(double from_s, double to_s, std::vector<FieldId>& out) {
  if (!cursor_valid_ || from_s < cursor_s_) {
    rebuild(from_s);
  } else {
    move_cursor(from_s, false);
  }
  move_cursor(to_s, true);

  out.clear();
  ++mark_;
  const auto mark_sensor = [&](std::uint32_t sensor) {
    for (const std::uint32_t port : graph_.sensor_outputs[sensor]) {
      if (port != kNone) mark_downstream(port, out);
    }
  };
  for (const std::uint32_t sensor : active_) mark_sensor(sensor);
  for (const std::uint32_t sensor : changed_sensors_) mark_sensor(sensor);
  for (const std::uint32_t port : changed_ports_) mark_downstream(port, out);
  changed_sensors_.clear();
  changed_ports_.clear();
  std::ranges::sort(out);
}

void ChangeTracker::mark_downstream(std::uint32_t port, std::vector<FieldId>& out) {
  open_.assign(1, port);
  while (!open_.empty()) {
    const std::uint32_t at = open_.back();
    open_.pop_back();
    if (std::exchange(seen_[at], mark_) == mark_) continue;
    const EventPort& c = graph_.ports[at];
    if (c.kind == PortKind::kRelay || c.kind == PortKind::kSensorInput) out.push_back({at});
    if (c.kind == PortKind::kKey) {  // what its interpolator sends from now on
      const auto sender = graph_.find(c.node, "value_changed");
      if (sender) open_.push_back(*sender);
    }
    for (std::uint32_t r = c.first_out; r != kNone; r = graph_.links[r].next_out) open_.push_back(graph_.links[r].to);
  }
}

// Finds the sensors that are active at t and the instants that come after it.
void ChangeTracker::rebuild(double t) {
  upcoming_.clear();
  cursor_valid_ = true;
  cursor_s_ = t;
  for (std::uint32_t c = 0; c < simulator_.component_count(); ++c) {
    refresh(c, t);
    push_component(c, t);
  }
  for (const auto& [port, all] : deliveries_.all()) {
    for (auto d = std::ranges::upper_bound(all, t, {}, &Delivered::t); d != all.end(); ++d) {
      upcoming_.push_back({d->t, port, true});
    }
  }
  std::make_heap(upcoming_.begin(), upcoming_.end());
}

void ChangeTracker::move_cursor(double t, bool note) {
  while (!upcoming_.empty() && upcoming_.front().t <= t) {
    const Upcoming next = upcoming_.front();
    std::pop_heap(upcoming_.begin(), upcoming_.end());
    upcoming_.pop_back();
    if (next.is_port) {
      if (note) changed_ports_.push_back(next.index);
      continue;
    }
    simulator_.for_each_change(next.index, cursor_s_, t, [&](bool is_port, std::uint32_t index) {
      if (is_port) {
        if (note) changed_ports_.push_back(index);
      } else {
        if (note) changed_sensors_.push_back(index);
        set_active(index, simulator_.sensor(index, t).active);
      }
    });
    if (simulator_.last_time(next.index) <= t) refresh(next.index, t);
    push_component(next.index, t);
  }
  cursor_s_ = t;
}

void ChangeTracker::refresh(std::uint32_t component, double t) {
  const bool stands = simulator_.last_time(component) <= t;
  for (const std::uint32_t sensor : simulator_.sensors(component)) {
    set_active(sensor, !stands && simulator_.sensor(sensor, t).active);
  }
}

void ChangeTracker::set_active(std::uint32_t sensor, bool active) {
  if (active == (place_[sensor] != kNone)) return;
  if (active) {
    place_[sensor] = static_cast<std::uint32_t>(active_.size());
    active_.push_back(sensor);
    return;
  }
  const std::uint32_t last = active_.back();
  active_[place_[sensor]] = last;
  place_[last] = std::exchange(place_[sensor], kNone);
  if (last == sensor) place_[sensor] = kNone;
  active_.pop_back();
}

void ChangeTracker::push(const Upcoming& upcoming) {
  upcoming_.push_back(upcoming);
  std::push_heap(upcoming_.begin(), upcoming_.end());
}

void ChangeTracker::push_component(std::uint32_t component, double t) {
  const double next = simulator_.next_instant(component, t);
  if (next == kInfinity) return;
  push({next, component, false});
}

void ChangeTracker::note_sensor_delivery(std::uint32_t port, double t) {
  if (!cursor_valid_) return;
  const std::uint32_t component = simulator_.component_of_port(port);
  if (t > cursor_s_) return push({t, component, false});
  changed_ports_.push_back(port);
  const std::vector<std::uint32_t>& sensors = simulator_.sensors(component);
  changed_sensors_.insert(changed_sensors_.end(), sensors.begin(), sensors.end());
  refresh(component, cursor_s_);
  push_component(component, cursor_s_);
}

void ChangeTracker::note_delivery(std::uint32_t port, double t) {
  if (!cursor_valid_) return;
  if (t > cursor_s_) return push({t, port, true});
  changed_ports_.push_back(port);
}

}  // namespace peerd::animation
