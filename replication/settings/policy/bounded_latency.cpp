#include "replication/settings/policy/bounded_latency.hpp"

#include "core/fnv1a.hpp"

namespace peerd::replication {

// The hash goes on with that of the world's files and regions.
std::uint64_t BoundedLatency::session_hash(std::uint64_t world_hash) const {
  if (!is_on()) return world_hash;
  const std::uint64_t hash = fnv1a(fnv1a(world_hash, static_cast<std::uint64_t>(least.count())), measured ? 1 : 0);
  return measured ? fnv1a(hash, tick_hz) : hash;
}

}  // namespace peerd::replication
