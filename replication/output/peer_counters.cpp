#include "replication/output/peer_counters.hpp"

namespace peerd::replication {

const char* to_string(Drop drop) {
  switch (drop) {
    case Drop::kOwn:
      return "own";
    case Drop::kUndecodable:
      return "undecodable";
    case Drop::kIdInUse:
      return "id_in_use";
    case Drop::kStaleIncarnation:
      return "stale_boot";
    case Drop::kOtherWorld:
      return "other_world";
    case Drop::kTooMany:
      return "too_many";
    case Drop::kUnintroduced:
      return "stranger";
    case Drop::kIdentityCheck:
      return "identity_check";
    case Drop::kRegion:
      return "region";
    case Drop::kNotYetInSession:
      return "not_yet_in_session";
  }
  return "?";
}

}  // namespace peerd::replication
