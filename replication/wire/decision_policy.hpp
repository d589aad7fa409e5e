#pragma once
#include <cstdint>

namespace peerd::replication {

// The policy that chooses the peer whose result of a collision counts. Every policy is a pure function of states that
// were published a while ago (decided_as_of), so that both owners compute the same without a message; the lower id is
// the last tie-breaker of all.
enum class DecisionPolicy : std::uint8_t {
  kId = 1,             // the owner with the lower id
  kVelocity = 2,       // the owner of the faster object
  kFieldOfView = 3,    // the owner that has the collision in its field of view
  kExpectedError = 4,  // the owner that would be wrong by least
  kServer = 5,         // one named peer
};

}  // namespace peerd::replication
