#pragma once
#include <string>
#include <string_view>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Digests, questions and reports about ghosts as bytes; docs/protocol.md specifies them. take_..() trusts nothing: it
// returns false for bytes that packed() does not make. Of an instant the low byte of its number on the grid travels;
// the receiver takes the instant that is nearest to `near`, which is less than 32 s away.

[[nodiscard]] std::string packed(const GhostDigest& digest);
[[nodiscard]] bool take_ghosts(std::string_view bytes, SimTime near, GhostDigest& digest);

[[nodiscard]] std::string packed(const GhostQuestion& question);
[[nodiscard]] bool take_ghosts(std::string_view bytes, SimTime near, GhostQuestion& question);

[[nodiscard]] std::string packed(const std::vector<GhostReport>& reports);
[[nodiscard]] bool take_ghosts(std::string_view bytes, std::vector<GhostReport>& reports);

}  // namespace peerd::replication
