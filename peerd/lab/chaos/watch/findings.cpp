#include "peerd/lab/chaos/watch/findings.hpp"

#include <spdlog/fmt/fmt.h>

namespace peerd::chaos {

void Findings::violate(double now_s, const std::string& what) {
  if (violations_.size() < kViolationsMax) violations_.push_back(fmt::format("at {:.3f} s: {}", now_s, what));
}

std::string name_of(const WatchedPeer& peer) { return fmt::format("peer {}", peer.host + 1); }

}  // namespace peerd::chaos
