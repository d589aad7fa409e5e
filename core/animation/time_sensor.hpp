#pragma once
#include <cstdint>
#include <optional>

namespace peerd::animation {

// A TimeSensor of VRML97 (6.50, 4.6.9) as a function of time. Times in seconds of world time, whose 0 is the time 0
// that startTime and stopTime are written in.

// Shortest cycle [s]: a shorter cycleInterval counts as this one. Nobody sees a shorter cycle, and a sensor that
// starts others each cycle would need unbounded work. It also keeps a cycle from starting twice at one time.
inline constexpr double kShortestCycle_s = 0x1p-10;

struct TimeSensorFields {
  double cycle_interval = 1.0;  // [s], > 0
  bool enabled = true;
  bool loop = false;
  double start_time = 0.0;  // [s]
  double stop_time = 0.0;   // [s]; of no effect unless > start_time

  friend bool operator==(const TimeSensorFields&, const TimeSensorFields&) = default;
};

// Cycle n begins at c_n = start_time + n * cycle_interval, evaluated in binary64, so that a cycle's beginning is one
// number wherever it is asked for. Cycles too short for t's own resolution (t / cycle_interval > 2^50) begin at t.
[[nodiscard]] double cycle_start(const TimeSensorFields& f, double t);       // greatest c_n <= t; t >= start_time
[[nodiscard]] double next_cycle_start(const TimeSensorFields& f, double t);  // least c_n > t

// fraction_changed at t >= start_time: (t - c_n) / cycle_interval, in [0, 1]; at a cycle's end 1, not 0 (6.50: "if (f
// == 0.0 && now > startTime) fraction_changed = 1.0"). Differs from the real number by at most 2 ulp(t) /
// cycle_interval.
[[nodiscard]] double fraction(const TimeSensorFields& f, double t);

// The state of a sensor from one transition until the next. Fields keep their initial values where the comments name no
// other.
struct TimeSensorState {
  TimeSensorFields fields;
  bool active = false;
  bool has_run = false;          // it has been active: the eventOuts below have sent
  bool cycle_done = false;       // startTime's one cycle is over; only loop or a new startTime makes it run again
  std::uint32_t begin_step = 0;  // orders transitions at one time (see control.hpp)
  std::uint32_t end_step = 0;    // orders transitions at one time (see sensor_simulator.hpp)
  double begin_s = 0.0;          // when the latest run became active
  double end_s = 0.0;          // active: when it will stop if no event comes, +inf if never. Inactive: when it stopped
  double final_fraction = 0;   // inactive: the latest events' values
  double final_cycle_s = 0.0;  //
};

// The sensor of a file that is read at read_time_s, before anything runs. One that does not loop and whose startTime is
// not later than the reading has had its cycle: so 4.6.9 has it ("any node with default values is already inactive"),
// and touch-triggered sensors, whose startTime is 0 until they are touched, rely on it.
[[nodiscard]] TimeSensorState read_sensor(const TimeSensorFields& fields, double read_time_s);

// Inactive and due to start at `now` (4.6.9): enabled, startTime <= now, stopTime not reached, and looping or in the
// first cycle. Depends on state alone: a looping sensor that is enabled late starts late, in phase.
[[nodiscard]] bool starts(const TimeSensorState& s, double now);
void start(TimeSensorState& s, double now);

// Sends the final events as of `now` and becomes inactive. `at_end`: stopTime or the end of a cycle has come, so that
// no cycle begins now; otherwise an event stops it.
void stop(TimeSensorState& s, double now, bool at_end);

// Returns when an active sensor stops if no event comes: stopTime (if > startTime) or, unless it loops, the end of its
// cycle.
[[nodiscard]] double end_of_run(const TimeSensorFields& f, double now);

// Returns the next transition after now if no event comes; +inf if there is none.
[[nodiscard]] double next_transition(const TimeSensorState& s, double now);

// The inputs stand in the order in which events of one time are taken: "processed as set_stopTime, then set_startTime"
// (4.6.9).
enum class SensorInput : std::uint8_t { kStopTime, kEnabled, kLoop, kCycleInterval, kStartTime };

enum class SetResult : std::uint8_t { kIgnored, kSet, kSetAndStopped };

// An event to an exposedField. Ignored (no x_changed): set_startTime and set_cycleInterval to an active sensor,
// set_stopTime <= startTime to an active one, a cycleInterval <= 0. A set_stopTime in (startTime, now] and a
// set_enabled FALSE stop an active sensor now; a set_loop FALSE lets it finish its cycle.
[[nodiscard]] SetResult set(TimeSensorState& s, SensorInput input, double value, double now);

// The latest event of each eventOut at or before t, where t is before the state's next transition; none before the
// first run.
struct TimeSensorOutput {
  bool is_active = false;
  double fraction = 0.0;
  double time_s = 0.0;
  double cycle_time_s = 0.0;
};
[[nodiscard]] std::optional<TimeSensorOutput> output(const TimeSensorState& s, double t);

// A sensor that no event reaches: its state at t. At most two transitions, whatever t is.
[[nodiscard]] TimeSensorState sensor_at(const TimeSensorFields& fields, double read_time_s, double t);

}  // namespace peerd::animation
