#pragma once
#include <chrono>
#include <filesystem>
#include <optional>
#include <vector>

#include "peerd/peer/config/events.hpp"

namespace peerd {

// The reason why real processes cannot have these events; none where they can.
[[nodiscard]] std::optional<InputError> why_not_live(const std::vector<config::ScenarioEvent>& events);

// Reports when the events of a scenario between real processes are due. Only events that happen to a process are meant:
// a peer reads scripted keys from its own settings. One of the peers is asked when the motions began; its control
// socket lies in a folder of its own, which is deleted with this object.
class LiveEvents {
 public:
  // The error is that the folder can't be made. Without events there is no folder.
  [[nodiscard]] static Result<LiveEvents> make(const std::vector<config::ScenarioEvent>& events);
  LiveEvents(LiveEvents&& other) noexcept;
  LiveEvents& operator=(LiveEvents&&) = delete;
  ~LiveEvents();

  // The argument of --control for the peer that is asked. It is empty where no peer is asked.
  [[nodiscard]] std::filesystem::path control() const { return folder_.empty() ? folder_ : folder_ / "s"; }
  // The next event that is due, or null. It may ask the peer, which can take a moment.
  [[nodiscard]] const config::ScenarioEvent* take_due();

 private:
  explicit LiveEvents(const std::vector<config::ScenarioEvent>& events) : events_(events) {}

  std::vector<config::ScenarioEvent> events_;
  std::filesystem::path folder_;
  std::optional<std::chrono::steady_clock::time_point> begin_;
  std::size_t done_ = 0;
};

}  // namespace peerd
