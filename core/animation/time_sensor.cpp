#include "core/animation/time_sensor.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/animation/value.hpp"

namespace peerd::animation {
namespace {

// c_n, without 0 * inf
double cycle(const TimeSensorFields& f, double n) {
  return n == 0.0 ? f.start_time : f.start_time + n * f.cycle_interval;
}

// Returns whether the cycles around t can be told apart in binary64, so that counting them is off by one at most.
bool resolvable(const TimeSensorFields& f, double t) {
  return std::max(std::abs(t), std::abs(f.start_time)) * 0x1p-50 < f.cycle_interval;
}

// The n of the greatest c_n <= t.
double cycle_index(const TimeSensorFields& f, double t) {
  double n = std::floor((t - f.start_time) / f.cycle_interval);
  if (n > 0.0 && cycle(f, n) > t) n -= 1.0;
  if (cycle(f, n + 1.0) <= t) n += 1.0;
  return n;
}

bool stop_time_counts(const TimeSensorFields& f) { return f.stop_time > f.start_time; }

}  // namespace

double cycle_start(const TimeSensorFields& f, double t) {
  assert(t >= f.start_time);
  return resolvable(f, t) ? cycle(f, cycle_index(f, t)) : t;
}

double next_cycle_start(const TimeSensorFields& f, double t) {
  if (t < f.start_time) return f.start_time;
  const double next = resolvable(f, t) ? cycle(f, cycle_index(f, t) + 1.0) : t;
  return std::max(next, std::nextafter(t, kInfinity));
}

double fraction(const TimeSensorFields& f, double t) {
  const double phase = std::min((t - cycle_start(f, t)) / f.cycle_interval, 1.0);
  return phase == 0.0 && t > f.start_time ? 1.0 : phase;
}

TimeSensorState read_sensor(const TimeSensorFields& fields, double read_time_s) {
  const TimeSensorFields defaults;
  TimeSensorState s;
  s.fields = fields;
  if (!std::isfinite(fields.start_time)) s.fields.start_time = defaults.start_time;
  if (!std::isfinite(fields.stop_time)) s.fields.stop_time = defaults.stop_time;
  if (!(fields.cycle_interval > 0.0) || !std::isfinite(fields.cycle_interval))
    s.fields.cycle_interval = defaults.cycle_interval;
  s.fields.cycle_interval = std::max(s.fields.cycle_interval, kShortestCycle_s);
  s.cycle_done = s.fields.start_time <= read_time_s;
  s.end_s = -kInfinity;
  return s;
}

bool starts(const TimeSensorState& s, double now) {
  const TimeSensorFields& f = s.fields;
  if (s.active || !f.enabled || !(f.start_time <= now)) return false;
  if (stop_time_counts(f) && f.stop_time <= now) return false;
  return f.loop || (!s.cycle_done && now < cycle(f, 1.0));
}

double end_of_run(const TimeSensorFields& f, double now) {
  const double stop_s = stop_time_counts(f) ? f.stop_time : kInfinity;
  return f.loop ? stop_s : std::min(stop_s, next_cycle_start(f, now));
}

void start(TimeSensorState& s, double now) {
  s.active = true;
  s.has_run = true;
  s.begin_s = now;
  s.end_s = end_of_run(s.fields, now);
}

void stop(TimeSensorState& s, double now, bool at_end) {
  assert(s.active);
  s.active = false;
  s.final_fraction = fraction(s.fields, now);
  // When the run ends with a cycle, no new cycle has begun.
  const double before = at_end ? std::max(std::nextafter(now, -kInfinity), s.fields.start_time) : now;
  s.final_cycle_s = cycle_start(s.fields, before);
  s.end_s = now;
  if (!s.fields.loop && now >= cycle(s.fields, 1.0)) s.cycle_done = true;
}

double next_transition(const TimeSensorState& s, double now) {
  if (s.active) return s.end_s;
  return s.fields.enabled && s.fields.start_time > now ? s.fields.start_time : kInfinity;
}

SetResult set(TimeSensorState& s, SensorInput input, double value, double now) {
  TimeSensorFields& f = s.fields;
  switch (input) {
    case SensorInput::kStopTime:
      if (s.active && value <= f.start_time) return SetResult::kIgnored;
      if (s.active && value <= now) {
        stop(s, now, false);
        f.stop_time = value;
        return SetResult::kSetAndStopped;
      }
      f.stop_time = value;
      break;
    case SensorInput::kEnabled:
      if (s.active && value == 0.0) {
        stop(s, now, false);
        f.enabled = false;
        return SetResult::kSetAndStopped;
      }
      f.enabled = value != 0.0;
      break;
    case SensorInput::kLoop:
      f.loop = value != 0.0;
      break;
    case SensorInput::kCycleInterval:
      if (s.active || !(value > 0.0)) return SetResult::kIgnored;
      f.cycle_interval = std::max(value, kShortestCycle_s);
      break;
    case SensorInput::kStartTime:
      if (s.active) return SetResult::kIgnored;
      f.start_time = value;
      s.cycle_done = false;
      break;
  }
  if (s.active) s.end_s = end_of_run(f, now);
  return SetResult::kSet;
}

std::optional<TimeSensorOutput> output(const TimeSensorState& s, double t) {
  if (!s.has_run) return std::nullopt;
  if (!s.active) return TimeSensorOutput{false, s.final_fraction, s.end_s, s.final_cycle_s};
  return TimeSensorOutput{true, fraction(s.fields, t), t, cycle_start(s.fields, t)};
}

TimeSensorState sensor_at(const TimeSensorFields& fields, double read_time_s, double t) {
  TimeSensorState s = read_sensor(fields, read_time_s);
  double now = read_time_s;
  while (now <= t) {
    if (starts(s, now)) {
      start(s, now);
    } else if (s.active) {
      stop(s, now, true);
    }
    now = next_transition(s, now);
  }
  return s;
}

}  // namespace peerd::animation
