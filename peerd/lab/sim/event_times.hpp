#pragma once
#include <optional>
#include <vector>

#include "peerd/lab/sim/network.hpp"
#include "peerd/peer/config/events.hpp"

namespace peerd::sim {

// The events of a run in virtual time, one after the other.
class EventTimes {
 public:
  explicit EventTimes(const std::vector<config::ScenarioEvent>& events) : events_(events) {}

  // Events count from `t`, the begin of the motions.
  void begin(VirtualTime t) { begin_ = t; }
  [[nodiscard]] std::optional<VirtualTime> begun() const { return begin_; }
  // The time of the next event; none where it is not known yet, or where no event is left.
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
