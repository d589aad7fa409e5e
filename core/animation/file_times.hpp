#pragma once
#include "core/animation/time_sensor.hpp"
#include "core/vrml/diagnostics.hpp"
#include "core/vrml/document.hpp"

namespace peerd::animation {

// VRML97 counts time from 1970 (4.11), and a world begins decades later. A startTime or stopTime in a file is therefore
// past when the world begins, unless it is so large that its author cannot have meant the past. World time begins at 0,
// so that what is past has to be expressed in times of 0 and less.

// Times [s] below this one (September 2001) are past.
inline constexpr double kPastBelow_s = 1e9;

// Returns the fields by which a sensor does in world time what these fields do in a browser that opens the file today:
// a stopTime that is past and after startTime has ended the run, and what runs has the phase of startTime 0. The result
// for a result is the same.
[[nodiscard]] TimeSensorFields in_world_time(const TimeSensorFields& file);

// Returns whether the sensor runs at other times, or in another phase, by the one than by the other, if it is enabled
// and no event comes.
[[nodiscard]] bool runs_alike(const TimeSensorFields& a, const TimeSensorFields& b);

}  // namespace peerd::animation

namespace peerd::vrml {

// Returns whether a WorldInfo says that the times of the world's files count from the world's beginning.
[[nodiscard]] bool has_world_times(const Document& document);

// Returns whether a TimeSensor would have other times if the document were written and read again as a file.
[[nodiscard]] bool needs_world_times(const Document& document);

// Gives the TimeSensors of a file their times in world time, unless has_world_times(). A warning at each sensor that
// runs otherwise by that names the nodes that it drives.
void count_from_1970(Document& document, Problems& problems);

}  // namespace peerd::vrml
