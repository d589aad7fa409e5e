#include "peerd/lab/live/live_events.hpp"

#include <cstdlib>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/control/control_client.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

// This is longer than a peer's tick takes. Events of other peers must not wait for one that hangs.
constexpr std::chrono::milliseconds kAnswerWithin{200};

}  // namespace

std::optional<InputError> why_not_live(const std::vector<config::ScenarioEvent>& events) {
  std::set<std::string> already_joined;
  for (const config::ScenarioEvent& e : events) {
    const std::string key = "error: event." + e.name + ": ";
    if (e.peer.empty()) {
      return InputError{key + std::string(to_string(e.kind)) +
                        " is for a simulated network; use peerd sim, or take the event out"};
    }
    const bool joins = e.kind == config::EventKind::kJoin;
    if (joins && (already_joined.contains(e.peer) || config::starts_with(events, e.peer))) {
      return InputError{key + "a real peer that has gone does not come back; peerd sim has such peers"};
    }
    already_joined.insert(e.peer);
  }
  return std::nullopt;
}

Result<LiveEvents> LiveEvents::make(const std::vector<config::ScenarioEvent>& events) {
  LiveEvents live(events);
  std::erase_if(live.events_, [](const config::ScenarioEvent& e) {  // the peers do these by themselves
    return e.kind == config::EventKind::kKey || e.kind == config::EventKind::kEdit;
  });
  if (live.events_.empty()) return live;
  std::error_code error;
  std::string folder = (fs::temp_directory_path(error) / "peerd-XXXXXX").string();
  if (error || mkdtemp(folder.data()) == nullptr) {
    return std::unexpected(
        InputError{"error: can't make a folder like " + folder + " for a control socket", kSystemFailed});
  }
  live.folder_ = folder;
  return live;
}

LiveEvents::LiveEvents(LiveEvents&& other) noexcept
    : events_(std::move(other.events_)),
      folder_(std::exchange(other.folder_, {})),
      begin_(other.begin_),
      done_(other.done_) {}

LiveEvents::~LiveEvents() {
  std::error_code ignored;  // a socket that is left in the folder does no harm
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

const config::ScenarioEvent* LiveEvents::take_due() {
  if (done_ == events_.size()) return nullptr;
  const auto now = std::chrono::steady_clock::now();
  if (!begin_) {
    const auto reply = control::ask(control(), R"({"do":"status"})", kAnswerWithin);
    if (!reply) return nullptr;  // the peer has not opened its socket yet
    const auto status = json_if_valid(*reply);
    if (!status.is_object() || !status.contains("since_start_s") || !status["since_start_s"].is_number())
      return nullptr;
    const std::chrono::duration<double> since(status["since_start_s"].get<double>());
    begin_ = now - std::chrono::duration_cast<std::chrono::steady_clock::duration>(since);
  }
  const std::chrono::duration<double> at(events_[done_].at_s);
  return now - *begin_ >= at ? &events_[done_++] : nullptr;
}

}  // namespace peerd
