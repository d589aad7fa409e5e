#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <utility>

namespace peerd::embed {

// A file descriptor that a program's loop can wait for: readable from raise() until clear().
class EventSignal {
 public:
  // The error is the system's: the process has no more file descriptors.
  [[nodiscard]] static std::expected<EventSignal, std::string> open();
  ~EventSignal();
  EventSignal(EventSignal&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  EventSignal& operator=(EventSignal&&) = delete;

  // Any thread may call these.
  void raise() const;
  void clear() const;
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  explicit EventSignal(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;  // -1: moved away
};

}  // namespace peerd::embed
