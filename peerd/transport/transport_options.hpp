#pragma once
#include "peerd/config/peer_settings.hpp"
#include "peerd/transport/open_transport.hpp"

namespace peerd {

// How to reach other peers, from the table [transport]; `key` as TransportOptions has it. The error is a person's.
[[nodiscard]] Result<net::TransportOptions> transport_options(const config::TransportSettings& settings,
                                                                      const net::SipKey& key);

// 128 bits of the kernel's randomness: once for each start of a process. Throws std::system_error if it has none.
[[nodiscard]] net::SipKey random_key();

// The error of the network as that of a command: 2 where a setting is wrong, else 3.
[[nodiscard]] InputError input_error(const net::NetError& error);

// Empty, or that the kernel grants less of a receive buffer than was asked, and what to do.
[[nodiscard]] std::string buffer_warning(const config::TransportSettings& settings, int granted_bytes);

}  // namespace peerd
