#include "peerd/daemon/embed/event_signal.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstring>

namespace peerd::embed {

std::expected<EventSignal, std::string> EventSignal::open() {
  const int descriptor = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (descriptor < 0) return std::unexpected(std::strerror(errno));
  return EventSignal(descriptor);
}

EventSignal::~EventSignal() {
  if (descriptor_ >= 0) close(descriptor_);
}

// It fails only where the counter is full, which is readable as well.
void EventSignal::raise() const {
  [[maybe_unused]] const int done = eventfd_write(descriptor_, 1);
  assert(done == 0 || errno == EAGAIN);
}

// It fails only where nothing was raised.
void EventSignal::clear() const {
  eventfd_t raised = 0;
  [[maybe_unused]] const int done = eventfd_read(descriptor_, &raised);
  assert(done == 0 || errno == EAGAIN);
}

}  // namespace peerd::embed
