#include "replication/session/delay_meter.hpp"

#include "replication/wire/codec.hpp"

namespace peerd::replication {

Duration latency_bound(Duration longest) {
  constexpr Duration kStep = kLatencyStep;
  const auto steps = (std::max(longest, Duration{0}) + kStep / 2 + kStep - Duration{1}) / kStep;
  return steps * kStep;
}

}  // namespace peerd::replication
