#include "replication/session/presence.hpp"

#include <algorithm>
#include <cstddef>

#include "replication/wire/operation.hpp"

namespace peerd::replication {
namespace {

// Operations of an earlier session than these are no longer on their way.
constexpr std::size_t kStaysMax = 8;

}  // namespace

void Presence::move(SimTime before, SimTime now) {
  if (before_.size() == kStaysMax) before_.erase(before_.begin());
  before_.push_back({since_, before + kStampAheadMax});
  since_ += now - before;
}

bool Presence::was_there(SimTime stamp) const {
  return stamp >= since_ ||
         std::ranges::any_of(before_, [&](const Stay& stay) { return stay.from <= stamp && stamp <= stay.to; });
}

}  // namespace peerd::replication
