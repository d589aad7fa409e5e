#pragma once
#include <cassert>
#include <cstdint>

#include "core/time.hpp"

namespace peerd::replication {

// The points of session time at which every peer of a session ticks, `hz` times a second, and the last of them at
// which this peer has ticked. Times are rounded down to whole nanoseconds.
class TickGrid {
 public:
  explicit TickGrid(std::uint32_t hz) : hz_(hz) { assert(hz > 0); }

  // The last tick that is not after t.
  [[nodiscard]] std::int64_t number_at(SimTime t) const;
  [[nodiscard]] SimTime time_of(std::int64_t number) const;

  [[nodiscard]] std::int64_t last() const { return last_; }
  [[nodiscard]] SimTime last_time() const { return time_of(last_); }
  [[nodiscard]] SimTime next_time() const { return time_of(last_ + 1); }
  void set_last(std::int64_t number) { last_ = number; }

  [[nodiscard]] std::uint32_t hz() const { return hz_; }
  // Whether the last tick is the first one of its second.
  [[nodiscard]] bool begins_a_second() const { return last_ % hz_ == 0; }

 private:
  std::uint32_t hz_;
  std::int64_t last_ = 0;
};

}  // namespace peerd::replication
