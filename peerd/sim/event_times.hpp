#pragma once
#include <optional>
#include <vector>

#include "peerd/config/events.hpp"
#include "peerd/sim/network.hpp"

namespace peerd::sim {

// A run's events in virtual time, one after the other.
class EventTimes {
 public:
  explicit EventTimes(const std::vector<config::ScenarioEvent>& events) : events_(events) {}

  // When the motions begin: events count from there.
  void begin(VirtualTime t) { begin_ = t; }
  [[nodiscard]] bool begun() const { return begin_.has_value(); }
  // None: not known yet, or there are no more.
  [[nodiscard]] std::optional<VirtualTime> next() const {
    if (!begin_ || done_ == events_.size()) return std::nullopt;
    return *begin_ + from_seconds(events_[done_].at_s);
  }
  [[nodiscard]] const config::ScenarioEvent& take() { return events_[done_++]; }

 private:
  const std::vector<config::ScenarioEvent>& events_;
  std::optional<VirtualTime> begin_;
  std::size_t done_ = 0;
};

}  // namespace peerd::sim
