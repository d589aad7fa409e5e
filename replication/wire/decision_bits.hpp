#pragma once
#include <cstddef>
#include <optional>
#include <span>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// A decision as bytes, bit for bit as its author applies it; proto/README.md specifies them. A part that an outcome
// leaves unchanged takes one bit.

inline constexpr std::size_t kDecisionMax_bytes = 640;  // the size of a decision with nothing left out

// Writes the bytes of a decision and returns their number.
[[nodiscard]] std::size_t encode_decision(const DecisionRecord& decision, std::span<std::byte, kDecisionMax_bytes> out);

// Takes the first decision of `rest`; its contact is the time nearest to `near` that fits. Trusts nothing: returns
// none for bytes that encode_decision() cannot have made, or for values that are not finite, of unit length or within
// limits.
[[nodiscard]] std::optional<DecisionRecord> decode_decision(std::span<const std::byte>& rest, SimTime near);

}  // namespace peerd::replication
