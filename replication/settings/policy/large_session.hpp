#pragma once
#include <cstdint>

namespace peerd::replication {

// How a session of many peers saves traffic, where the scene is cut into regions (docs/scale.md). A peer that knows of
// more than `above` peers, itself included, says hello to the regions where it publishes, and to all peers only so
// often that the far hellos of all together are `hellos_per_s`.
struct LargeSession {
  std::uint32_t above = 48;    // 0: no session is large
  double hellos_per_s = 24.0;  // > 0

  // The hash of a session whose scene is cut into regions: peers with other settings are of another session. The hash
  // goes on with that of the world's files and regions; the defaults leave it as it is.
  [[nodiscard]] std::uint64_t session_hash(std::uint64_t world_hash) const;
  friend bool operator==(const LargeSession&, const LargeSession&) = default;
};

}  // namespace peerd::replication
