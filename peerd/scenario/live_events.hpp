#pragma once
#include <chrono>
#include <filesystem>
#include <optional>
#include <vector>

#include "peerd/config/events.hpp"

namespace peerd {

// Why real processes can't have these events; none: they can.
[[nodiscard]] std::optional<InputError> why_not_live(const std::vector<config::ScenarioEvent>& events);

// When the events of a scenario between real processes are due: those that are done to a process. Keys are in the
// settings that it reads itself. One of the peers is asked when the motions began; its
// control socket lies in a folder of its own, which goes with the object.
class LiveEvents {
 public:
  // The error: the folder can't be made. Without events there is none.
  [[nodiscard]] static Result<LiveEvents> make(const std::vector<config::ScenarioEvent>& events);
  LiveEvents(LiveEvents&& other) noexcept;
  LiveEvents& operator=(LiveEvents&&) = delete;
  ~LiveEvents();

  // What the peer that is asked needs as --control; empty: nobody is asked.
  [[nodiscard]] std::filesystem::path control() const { return folder_.empty() ? folder_ : folder_ / "s"; }
  // The next one that is due; null: none is. Asks, so it may take a moment.
  [[nodiscard]] const config::ScenarioEvent* take_due();

 private:
  explicit LiveEvents(const std::vector<config::ScenarioEvent>& events) : events_(events) {}

  std::vector<config::ScenarioEvent> events_;
  std::filesystem::path folder_;
  std::optional<std::chrono::steady_clock::time_point> begin_;
  std::size_t done_ = 0;
};

}  // namespace peerd
