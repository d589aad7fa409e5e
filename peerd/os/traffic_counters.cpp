#include "peerd/os/traffic_counters.hpp"

namespace peerd::net {

std::map<std::string, std::uint64_t> TrafficCounters::named() const {
  return {
      {"net.packets_in", packets_in},
      {"net.bytes_in", bytes_in},
      {"net.packets_out", packets_out},
      {"net.bytes_out", bytes_out},
      {"net.calls_in", calls_in},
      {"net.calls_out", calls_out},
      {"net.in_truncated", in_truncated},
      {"net.in_other_group", in_other_group},
      {"net.in_other_region", in_other_region},
      {"net.in_stranger", in_stranger},
      {"net.in_other_interface", in_other_interface},
      {"net.in_no_destination", in_no_destination},
      {"net.in_malformed", in_malformed},
      {"net.in_queue_overflow", in_queue_overflow},
      {"net.in_errors", in_errors},
      {"net.in_unstamped", in_unstamped},
      {"net.in_stamp_refused", in_stamp_refused},
      {"net.announcements_in", announcements_in},
      {"net.in_open", in_open},
      {"net.in_own", in_own},
      {"net.in_unproven", in_unproven},
      {"net.in_forged", in_forged},
      {"net.in_replayed", in_replayed},
      {"net.in_too_many_boots", in_too_many_boots},
      {"net.in_no_member", in_no_member},
      {"net.in_impostor", in_impostor},
      {"net.in_unsigned", in_unsigned},
      {"net.in_wrong_sender", in_wrong_sender},
      {"net.in_observer", in_observer},
      {"net.in_other_epoch", in_other_epoch},
      {"net.in_flood", in_flood},
      {"net.out_queue_full", out_queue_full},
      {"net.out_unreachable", out_unreachable},
      {"net.out_blocked", out_blocked},
      {"net.out_stale", out_stale},
      {"net.out_too_large", out_too_large},
      {"net.out_no_group", out_no_group},
      {"net.out_errors", out_errors},
      {"net.greetings_in", greetings_in},
      {"net.greetings_out", greetings_out},
      {"net.peers_refused", peers_refused},
      {"net.greetings_unopened", greetings_unopened},
      {"net.greetings_flood", greetings_flood},
  };
}

}  // namespace peerd::net
