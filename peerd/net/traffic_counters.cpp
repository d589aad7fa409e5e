#include "peerd/net/traffic_counters.hpp"

namespace peerd::net {

std::map<std::string, std::uint64_t> TrafficCounters::named() const {
  return {
      {"net.packets_in", packets_in},
      {"net.bytes_in", bytes_in},
      {"net.packets_out", packets_out},
      {"net.bytes_out", bytes_out},
      {"net.in_truncated", in_truncated},
      {"net.in_other_group", in_other_group},
      {"net.in_other_interface", in_other_interface},
      {"net.in_no_destination", in_no_destination},
      {"net.in_queue_overflow", in_queue_overflow},
      {"net.in_errors", in_errors},
      {"net.out_queue_full", out_queue_full},
      {"net.out_unreachable", out_unreachable},
      {"net.out_blocked", out_blocked},
      {"net.out_too_large", out_too_large},
      {"net.out_no_group", out_no_group},
      {"net.out_errors", out_errors},
  };
}

}  // namespace peerd::net
