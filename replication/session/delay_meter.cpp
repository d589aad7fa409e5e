#include "replication/session/delay_meter.hpp"

namespace peerd::replication {
namespace {

constexpr Duration kLatencyGrid = std::chrono::milliseconds(50);

}  // namespace

Duration latency_bound(Duration longest) {
  const auto steps = (std::max(longest, Duration{0}) + kLatencyGrid / 2 + kLatencyGrid - Duration{1}) / kLatencyGrid;
  return steps * kLatencyGrid;
}

}  // namespace peerd::replication
