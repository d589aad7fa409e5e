#pragma once
#include "peerd/input/input_error.hpp"
#include "peerd/net/settings/transport_settings.hpp"
#include "peerd/net/transport/open_transport.hpp"

namespace peerd::net {

// The options of the configuration's table [transport]; `key` is TransportOptions::key.
[[nodiscard]] Result<TransportOptions> transport_options(const TransportSettings& settings, const SipKey& key);

// The warning that the kernel grants a smaller receive buffer than requested, with advice; empty where it does not.
[[nodiscard]] std::string buffer_warning(const TransportSettings& settings, int granted_bytes);

}  // namespace peerd::net
