#pragma once
#include <string_view>

namespace peerd {

// What a counter of a peer counts, in a few words; empty: no counter has that name. Names are those of
// PeerNode::log() and, with "net." before them, of net::TrafficCounters.
[[nodiscard]] std::string_view meaning_of_counter(std::string_view name);

}  // namespace peerd
