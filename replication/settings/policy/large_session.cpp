#include "replication/settings/policy/large_session.hpp"

#include <bit>

#include "core/fnv1a.hpp"

namespace peerd::replication {

std::uint64_t LargeSession::session_hash(std::uint64_t world_hash) const {
  if (*this == LargeSession{}) return world_hash;
  return fnv1a(fnv1a(world_hash, above), std::bit_cast<std::uint64_t>(hellos_per_s));
}

}  // namespace peerd::replication
