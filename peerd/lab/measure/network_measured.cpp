#include "peerd/lab/measure/network_measured.hpp"

#include "peerd/lab/measure/statistics/statistics.hpp"

namespace peerd::measure {
namespace {

constexpr double kOversleepBefore_ms = 10.0, kOversleepDuring_ms = 50.0;

}  // namespace

bool kept_time(const NetworkMeasured& network) {
  return statistics(network.oversleep_before_ms).p99 <= kOversleepBefore_ms &&
         statistics(network.oversleep_during_ms).p99 <= kOversleepDuring_ms;
}

}  // namespace peerd::measure
