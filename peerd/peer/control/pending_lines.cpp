#include "peerd/peer/control/pending_lines.hpp"

#include <cassert>
#include <utility>

#include "peerd/peer/control/event_line.hpp"

namespace peerd::control {

bool PendingLines::add_event(const std::string& text) {
  if (events_ >= kEventsMax || events_bytes_ + text.size() > kEventsMax_bytes) {
    ++dropped_;
    return false;
  }
  if (dropped_ > 0) push_event(dropped_line(std::exchange(dropped_, 0)));
  push_event(text);
  return true;
}

void PendingLines::push_event(std::string text) {
  events_bytes_ += text.size();
  ++events_;
  lines_.push_back({std::move(text), false});
}

PendingLines::Line PendingLines::take_front() {
  assert(!lines_.empty());
  Line line = std::move(lines_.front());
  lines_.pop_front();
  if (line.is_reply) {
    --replies_;
  } else {
    events_bytes_ -= line.text.size();
    --events_;
  }
  if (events_ == 0 && dropped_ > 0) push_event(dropped_line(std::exchange(dropped_, 0)));
  return line;
}

}  // namespace peerd::control
