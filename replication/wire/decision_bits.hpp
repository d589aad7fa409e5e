#pragma once
#include <cstddef>
#include <optional>
#include <span>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// A decision as bytes, bit for bit what its author applies itself; proto/README.md specifies them. What an outcome
// leaves as it was takes a bit.

inline constexpr std::size_t kDecisionMax_bytes = 640;  // with nothing left out

// The bytes of a decision, of which it gives the number.
[[nodiscard]] std::size_t encode_decision(const DecisionRecord& decision, std::span<std::byte, kDecisionMax_bytes> out);

// Takes the first decision of `rest`; its contact is the time nearest to `near` that fits. Trusts nothing: none is what
// encode_decision() cannot have made, or values that are not finite, of unit length or within limits.
[[nodiscard]] std::optional<DecisionRecord> decode_decision(std::span<const std::byte>& rest, SimTime near);

}  // namespace peerd::replication
