#pragma once
#include "core/time.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/net/settings/transport_settings.hpp"
#include "peerd/net/transport/open_transport.hpp"

namespace peerd::net {

// The group of region 0 where only IPv6 is to be had, and nobody has chosen another.
inline constexpr const char* kIpv6Group = "ff15::50:0";

// The options of the configuration's table [transport]; `key` is TransportOptions::key.
[[nodiscard]] Result<TransportOptions> transport_options(const TransportSettings& settings, const SipKey& key);

// Returns whether it has set the IPv6 group: only IPv6 is to be had, and nobody has chosen a group, nor other ways than
// multicast. Looks for IPv4 again during that time, as its lease takes longer than IPv6 after a start.
[[nodiscard]] bool takes_ipv6(TransportSettings& settings, Duration patience);

// The warning that the kernel grants a smaller receive buffer than requested, with advice; empty where it does not.
[[nodiscard]] std::string buffer_warning(const TransportSettings& settings, int granted_bytes);

}  // namespace peerd::net
