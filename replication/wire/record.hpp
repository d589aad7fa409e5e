#pragma once
#include <array>
#include <cstddef>
#include <expected>
#include <optional>
#include <span>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// One update as bytes: components are whole numbers of steps, which the receiver multiplies out to the very binary64
// values that the sender's own ghost uses. proto/README.md specifies the bits.

// By how much rounding may move what an update says, so that it does not matter beside the thresholds in force.
struct Tolerance {
  double distance_m = 0.0;
  double angle_rad = 0.0;
};

// Smallest three, 13 bits each: at most this from the orientation that was rounded. 0.0343 degrees.
// Of three components each is off by at most e = 1 / (2 sqrt(2) 4095); the fourth, the largest, by their sum at most:
// |dq|^2 <= 3 e^2 + (3 e)^2, and the angle is 2 |dq| (to the third order).
inline constexpr double kOrientationError_rad = 6.0e-4;
// Tolerances below four times that would see the rounding.
inline constexpr double kCoarsestAngle_rad = 4.0 * kOrientationError_rad;

// log2 of steps of the position [m]. Coarser ones would not make records much shorter, but cost accuracy where an
// object happens to move as its law says, and thresholds would never ask for more.
inline constexpr int kStepLeast_log2 = -23, kStepMost_log2 = -9;

// For how long [s, log2] rounding stays small: steps of derivatives are such that each of velocity, acceleration and
// jerk, and the rate, moves no axis by more than one step of the position by then. 1 s for second, history and
// third; 4 s for the others, which are chosen because they last.
[[nodiscard]] int horizon_log2_s(MotionKind kind);

// The position's step: the largest that is at most a 16th of the tolerance; a 64th for laws that last. None: finer
// than there are.
[[nodiscard]] std::optional<int> position_step_log2(MotionKind kind, double tolerance_m);

// What receivers will hold of it: components rounded to steps, named in position_step_log2; or, exactly, all that they
// are (position_step_log2 none), where the tolerance is below the steps there are, where a component is more of its
// steps than its field holds, or where rounding would leave the limits or make a sliding object stop short. A second
// order whose acceleration rounds to zero is said as the first that it then is, whose velocity has finer steps.
// Rounding what is rounded changes no bit.
[[nodiscard]] UpdateRecord quantised(const UpdateRecord& record, const Tolerance& tolerance);

// An exact record with everything in it, and 10 bytes of each time.
inline constexpr std::size_t kRecordMax_bytes = 256;

// The bytes of a record, of which it gives the number. Times count from `base`. A record that names a step must be
// quantised().
[[nodiscard]] std::size_t encode_record(const UpdateRecord& record, SimTime base,
                                        std::span<std::byte, kRecordMax_bytes> out);

// An update on its way into a datagram, which counts times from its first update's: encoded, anew only where another
// base asks for it.
class EncodedUpdate {
 public:
  EncodedUpdate(const UpdateRecord& record, SimTime base);
  void count_from(SimTime base);
  [[nodiscard]] const UpdateRecord& record() const { return record_; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return std::span(bytes_).first(size_bytes_); }

 private:
  UpdateRecord record_;
  SimTime base_;
  std::array<std::byte, kRecordMax_bytes> bytes_;
  std::size_t size_bytes_;
};

enum class RecordError : std::uint8_t {
  kUnknownModel,  // a later version's; sound otherwise, and `rest` has passed it
  kValue,         // not what encode_record() makes
};
// Takes the first record of `rest`. Trusts nothing: what comes back encodes to the same record, all its values finite
// and within limits.
[[nodiscard]] std::expected<UpdateRecord, RecordError> decode_record(std::span<const std::byte>& rest, SimTime base);

}  // namespace peerd::replication
