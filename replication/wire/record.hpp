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

// The distance and the angle by which rounding may move an update, so small that they do not matter beside the
// thresholds in force.
struct Tolerance {
  double distance_m = 0.0;
  double angle_rad = 0.0;
};

// The largest angle between an orientation and its rounded form (smallest three, 13 bits each): 0.0343 degrees. Each
// of three components is off by at most e = 1 / (2 sqrt(2) 4095); the fourth, the largest, by their sum at most:
// |dq|^2 <= 3 e^2 + (3 e)^2, and the angle is 2 |dq| (to the third order).
inline constexpr double kOrientationError_rad = 6.0e-4;
// With a tolerance below four times that error, an orientation is sent exactly: rounding would matter.
inline constexpr double kCoarsestAngle_rad = 4.0 * kOrientationError_rad;

// The range of log2 of the step of the position [m]. Coarser steps would not make records much shorter, but cost
// accuracy where an object happens to move as its law says; thresholds never ask for finer ones.
inline constexpr int kStepLeast_log2 = -23, kStepMost_log2 = -9;

// The log2 of the time [s] for which rounding stays small: steps of derivatives are such that each of velocity,
// acceleration and jerk, and the rate, moves no axis by more than one step of the position by then. It is 1 s for
// second, history and third, and 4 s for the others, which are chosen because they last.
[[nodiscard]] int horizon_log2_s(MotionKind kind);

// The log2 of the position's step: the largest step that is at most a 16th of the tolerance; a 64th for laws that
// last. None: finer than the steps that exist.
[[nodiscard]] std::optional<int> position_step_log2(MotionKind kind, double tolerance_m);

// The record as receivers will have it: components rounded to steps, named in position_step_log2; or all of them
// exactly (position_step_log2 none), where the tolerance is below the smallest step, where a component has more steps
// than its field can count, or where rounding would leave the limits or make a sliding object stop short. A
// second-order model whose acceleration rounds to zero becomes one of first order, whose velocity has finer steps.
// Rounding a rounded record changes no bit.
[[nodiscard]] UpdateRecord quantised(const UpdateRecord& record, const Tolerance& tolerance);

// The size of an exact record with everything in it, and 10 bytes for each time.
inline constexpr std::size_t kRecordMax_bytes = 288;

// Writes the bytes of a record and returns their number. Times count from `base`. A record that names a step must be
// quantised().
[[nodiscard]] std::size_t encode_record(const UpdateRecord& record, SimTime base,
                                        std::span<std::byte, kRecordMax_bytes> out);

// An update on its way into a datagram, in which times count from the first update's. It is encoded anew only where
// another base asks for it.
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
  kUnknownModel,  // a model of a later version; the rest of it is sound, and `rest` has passed it
  kValue,         // bytes that encode_record() does not make
};
// Takes the first record of `rest`, which is not empty. Trusts nothing: the result encodes to the same bytes, and all
// its values are finite and within limits.
[[nodiscard]] std::expected<UpdateRecord, RecordError> decode_record(std::span<const std::byte>& rest, SimTime base);

}  // namespace peerd::replication
