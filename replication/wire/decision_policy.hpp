#pragma once
#include <cstdint>

namespace peerd::replication {

// Whose result of a collision counts. Every policy is a pure function of published states a while ago (decided_as_of),
// so that both owners compute the same without a word; the lower id is the last tie-breaker of all.
enum class DecisionPolicy : std::uint8_t {
  kId = 1,             // the lower id
  kVelocity = 2,       // who runs the faster object
  kFieldOfView = 3,    // who looks at it
  kExpectedError = 4,  // who would be wrong by least
  kServer = 5,         // one named peer
};

}  // namespace peerd::replication
