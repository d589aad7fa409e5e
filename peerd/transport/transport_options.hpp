#pragma once
#include "peerd/config/peer_settings.hpp"
#include "peerd/transport/open_transport.hpp"

namespace peerd {

// The options of the configuration's table [transport]; `key` is TransportOptions::key.
[[nodiscard]] Result<net::TransportOptions> transport_options(const config::TransportSettings& settings,
                                                              const net::SipKey& key);

// 128 random bits of the kernel, for one start of a process. Throws std::system_error if the kernel has none.
[[nodiscard]] net::SipKey random_key();

// Converts an error of the network to one of a command, with exit code 2 where a setting is wrong, else 3.
[[nodiscard]] InputError input_error(const net::NetError& error);

// The warning that the kernel grants a smaller receive buffer than requested, with advice; empty where it does not.
[[nodiscard]] std::string buffer_warning(const config::TransportSettings& settings, int granted_bytes);

}  // namespace peerd
