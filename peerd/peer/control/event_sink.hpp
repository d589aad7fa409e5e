#pragma once
#include <string>

#include "peerd/peer/control/event_kind.hpp"

namespace peerd::control {

// A server whose clients subscribe to events.
class EventSink {
 public:
  EventSink() = default;
  EventSink(const EventSink&) = delete;
  EventSink& operator=(const EventSink&) = delete;
  virtual ~EventSink() = default;

  // The kinds that some client wants.
  [[nodiscard]] virtual EventKinds wanted() const = 0;
  // Gives an event, a line without its end, to all clients that want the kind. Never waits for one.
  virtual void publish(EventKind kind, const std::string& line) = 0;
};

}  // namespace peerd::control
