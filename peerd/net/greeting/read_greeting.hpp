#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <optional>
#include <span>

#include "core/time.hpp"
#include "peerd/net/greeting/greeting_seal.hpp"
#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/os/traffic_counters.hpp"

namespace peerd::net {

// Reads a greeting that came from there. `seal`: what has sealed it; null: it is open. None: it is no greeting, the
// seal does not open it, or strangers have sent too many; `counters` has the reason.
[[nodiscard]] std::optional<Greeting> read_greeting(std::span<const std::byte> bytes, bool v4, GreetingSeal* seal,
                                                    HostTime at, const boost::asio::ip::udp::endpoint& from,
                                                    SourceBuckets& strangers, TrafficCounters& counters);

// Whether a datagram begins as a greeting does, open or sealed, and as no peer's datagram.
[[nodiscard]] bool looks_like_greeting(std::span<const std::byte> bytes);

}  // namespace peerd::net
