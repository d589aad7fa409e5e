#pragma once
#include <cstddef>
#include <optional>
#include <span>

#include "core/ids.hpp"

namespace peerd::replication {

// An Envelope tells of a datagram what can be known without reading what it says.
struct Envelope {
  PeerId sender;
  bool has_only_updates = false;  // or nothing: no hello, decision, operation or farewell
  // Updates, decisions, or objects that the sender claims as its own. Logs don't count: others pass them on, too.
  bool changes_world = false;
};

// None: it is no Datagram of proto/peerd.proto, or names no sender, or two.
[[nodiscard]] std::optional<Envelope> envelope_of(std::span<const std::byte> datagram);

}  // namespace peerd::replication
