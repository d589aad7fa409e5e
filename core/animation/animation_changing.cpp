#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/animation/animation.hpp"

namespace peerd::animation {

void Animation::changing(double from_s, double to_s, std::vector<FieldId>& out) {
  assert(std::isfinite(from_s) && std::isfinite(to_s) && from_s <= to_s);
  if (!cursor_valid_ || from_s < cursor_s_) {
    rebuild(from_s);
  } else {
    move_cursor(from_s, false);
  }
  move_cursor(to_s, true);

  out.clear();
  ++mark_;
  const auto mark_sensor = [&](std::uint32_t sensor) {
    for (const std::uint32_t port : graph_->sensor_outputs[sensor]) {
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

void Animation::mark_downstream(std::uint32_t port, std::vector<FieldId>& out) {
  wave_.assign(1, port);
  while (!wave_.empty()) {
    const std::uint32_t at = wave_.back();
    wave_.pop_back();
    if (std::exchange(seen_[at], mark_) == mark_) continue;
    const EventPort& c = graph_->ports[at];
    if (c.kind == PortKind::kRelay || c.kind == PortKind::kSensorInput) out.push_back({at});
    if (c.kind == PortKind::kKey) {  // what its interpolator sends from now on
      const auto sender = graph_->find(c.node, "value_changed");
      if (sender) wave_.push_back(*sender);
    }
    for (std::uint32_t r = c.first_out; r != kNone; r = graph_->links[r].next_out)
      wave_.push_back(graph_->links[r].to);
  }
}

// Who is active, and what comes next, from t on.
void Animation::rebuild(double t) {
  upcoming_.clear();
  cursor_valid_ = true;
  cursor_s_ = t;
  for (std::uint32_t c = 0; c < simulator_->component_count(); ++c) {
    refresh(c, t);
    push_component(c, t);
  }
  for (const auto& [port, all] : delivered_) {
    for (auto d = std::ranges::upper_bound(all, t, {}, &Delivered::t); d != all.end(); ++d) {
      upcoming_.push_back({d->t, port, true});
    }
  }
  std::make_heap(upcoming_.begin(), upcoming_.end());
}

void Animation::move_cursor(double t, bool note) {
  while (!upcoming_.empty() && upcoming_.front().t <= t) {
    const Upcoming next = upcoming_.front();
    std::pop_heap(upcoming_.begin(), upcoming_.end());
    upcoming_.pop_back();
    if (next.is_port) {
      if (note) changed_ports_.push_back(next.index);
      continue;
    }
    simulator_->for_each_change(next.index, cursor_s_, t, [&](bool is_port, std::uint32_t index) {
      if (is_port) {
        if (note) changed_ports_.push_back(index);
      } else {
        if (note) changed_sensors_.push_back(index);
        set_active(index, simulator_->sensor(index, t).active);
      }
    });
    if (simulator_->last_time(next.index) <= t) refresh(next.index, t);
    push_component(next.index, t);
  }
  cursor_s_ = t;
}

void Animation::refresh(std::uint32_t component, double t) {
  const bool stands = simulator_->last_time(component) <= t;
  for (const std::uint32_t sensor : simulator_->sensors(component)) {
    set_active(sensor, !stands && simulator_->sensor(sensor, t).active);
  }
}

void Animation::set_active(std::uint32_t sensor, bool active) {
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

void Animation::push_component(std::uint32_t component, double t) {
  const double next = simulator_->next_instant(component, t);
  if (next == std::numeric_limits<double>::infinity()) return;
  upcoming_.push_back({next, component, false});
  std::push_heap(upcoming_.begin(), upcoming_.end());
}

}  // namespace peerd::animation
