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
    for (const std::uint32_t cell : graph_->sensor_outputs[sensor]) {
      if (cell != kNone) mark_downstream(cell, out);
    }
  };
  for (const std::uint32_t sensor : active_) mark_sensor(sensor);
  for (const std::uint32_t sensor : noted_sensors_) mark_sensor(sensor);
  for (const std::uint32_t cell : noted_cells_) mark_downstream(cell, out);
  noted_sensors_.clear();
  noted_cells_.clear();
  std::ranges::sort(out);
}

void Animation::mark_downstream(std::uint32_t cell, std::vector<FieldId>& out) {
  front_.assign(1, cell);
  while (!front_.empty()) {
    const std::uint32_t at = front_.back();
    front_.pop_back();
    if (std::exchange(seen_[at], mark_) == mark_) continue;
    const Cell& c = graph_->cells[at];
    if (c.kind == CellKind::kRelay || c.kind == CellKind::kSensorInput) out.push_back({at});
    if (c.kind == CellKind::kKey) {  // what its interpolator sends from now on
      const auto sender = graph_->find(c.node, "value_changed");
      if (sender) front_.push_back(*sender);
    }
    for (std::uint32_t r = c.first_out; r != kNone; r = graph_->links[r].next_out)
      front_.push_back(graph_->links[r].to);
  }
}

// Who is active, and what comes next, from t on.
void Animation::rebuild(double t) {
  upcoming_.clear();
  cursor_valid_ = true;
  cursor_s_ = t;
  for (std::uint32_t c = 0; c < control_->component_count(); ++c) {
    refresh(c, t);
    push_component(c, t);
  }
  for (const auto& [cell, all] : delivered_) {
    for (auto d = std::ranges::upper_bound(all, t, {}, &Delivered::t); d != all.end(); ++d) {
      upcoming_.push_back({d->t, cell, true});
    }
  }
  std::make_heap(upcoming_.begin(), upcoming_.end());
}

void Animation::move_cursor(double t, bool note) {
  while (!upcoming_.empty() && upcoming_.front().t <= t) {
    const Upcoming next = upcoming_.front();
    std::pop_heap(upcoming_.begin(), upcoming_.end());
    upcoming_.pop_back();
    if (next.is_cell) {
      if (note) noted_cells_.push_back(next.index);
      continue;
    }
    control_->for_each_change(next.index, cursor_s_, t, [&](bool is_cell, std::uint32_t index) {
      if (is_cell) {
        if (note) noted_cells_.push_back(index);
      } else {
        if (note) noted_sensors_.push_back(index);
        set_active(index, control_->sensor(index, t).active);
      }
    });
    if (control_->last_time(next.index) <= t) refresh(next.index, t);
    push_component(next.index, t);
  }
  cursor_s_ = t;
}

void Animation::refresh(std::uint32_t component, double t) {
  const bool stands = control_->last_time(component) <= t;
  for (const std::uint32_t sensor : control_->sensors(component)) {
    set_active(sensor, !stands && control_->sensor(sensor, t).active);
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
  const double next = control_->next_instant(component, t);
  if (next == std::numeric_limits<double>::infinity()) return;
  upcoming_.push_back({next, component, false});
  std::push_heap(upcoming_.begin(), upcoming_.end());
}

}  // namespace peerd::animation
