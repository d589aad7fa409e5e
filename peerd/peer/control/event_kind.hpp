#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace peerd::control {

// The kinds of events that a client can subscribe to.
enum class EventKind : std::uint8_t { kObjects, kContacts, kPeers, kData, kMessages, kEdits };

inline constexpr std::array<std::string_view, 6> kEventKindNames{"objects", "contacts", "peers",
                                                                 "data",    "messages", "edits"};

[[nodiscard]] constexpr std::optional<EventKind> find_event_kind(std::string_view name) {
  for (std::size_t i = 0; i < kEventKindNames.size(); ++i) {
    if (kEventKindNames[i] == name) return static_cast<EventKind>(i);
  }
  return std::nullopt;
}

// A set of kinds.
class EventKinds {
 public:
  void add(EventKind kind) { bits_ |= bit(kind); }
  void add(EventKinds others) { bits_ |= others.bits_; }
  [[nodiscard]] bool contains(EventKind kind) const { return (bits_ & bit(kind)) != 0; }
  [[nodiscard]] bool empty() const { return bits_ == 0; }
  [[nodiscard]] static EventKinds all() {
    EventKinds kinds;
    for (std::size_t i = 0; i < kEventKindNames.size(); ++i) kinds.add(static_cast<EventKind>(i));
    return kinds;
  }
  friend bool operator==(const EventKinds&, const EventKinds&) = default;

 private:
  [[nodiscard]] static std::uint32_t bit(EventKind kind) { return std::uint32_t{1} << static_cast<unsigned>(kind); }
  std::uint32_t bits_ = 0;
};

}  // namespace peerd::control
