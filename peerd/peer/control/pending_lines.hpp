#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace peerd::control {

// The lines that wait for one client to read them: replies, and events within limits. An event that has no room is
// dropped, and before the next one that has room a line says how many were.
class PendingLines {
 public:
  // So many events wait at most.
  static constexpr std::size_t kEventsMax = 1024, kEventsMax_bytes = std::size_t{1} << 20;

  struct Line {
    std::string text;       // without a line end
    bool is_reply = false;  // else it is an event
  };

  void add_reply(std::string text) {
    lines_.push_back({std::move(text), true});
    ++replies_;
  }
  // False: it was dropped.
  bool add_event(const std::string& text);

  [[nodiscard]] bool empty() const { return lines_.empty(); }
  [[nodiscard]] const Line& front() const { return lines_.front(); }
  [[nodiscard]] bool has_reply() const { return replies_ > 0; }
  // The client has read the first line, which is returned.
  Line take_front();

 private:
  void push_event(std::string text);

  std::deque<Line> lines_;
  std::size_t replies_ = 0, events_ = 0, events_bytes_ = 0;
  std::uint64_t dropped_ = 0;  // since the line that said so last
};

}  // namespace peerd::control
