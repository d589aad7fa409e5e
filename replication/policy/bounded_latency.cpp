#include "replication/policy/bounded_latency.hpp"

namespace peerd::replication {

// The hash is FNV-1a 64, as for world files.
std::uint64_t BoundedLatency::session_hash(std::uint64_t world_hash) const {
  if (!is_on()) return world_hash;
  std::uint64_t hash = world_hash;
  for (const std::uint64_t part : {static_cast<std::uint64_t>(least.count()), std::uint64_t{measured}}) {
    for (int byte = 0; byte < 8; ++byte) hash = (hash ^ (part >> (8 * byte) & 0xFF)) * 0x100000001B3;
  }
  return hash;
}

}  // namespace peerd::replication
