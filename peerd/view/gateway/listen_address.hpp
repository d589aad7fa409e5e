#pragma once
#include <string>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>

#include "peerd/input/input_error.hpp"

namespace peerd::gateway {

// The address of "ADDRESS:PORT"; an IPv6 address stands in brackets. Another address than a loopback one is refused
// unless the gateway may be reached by other computers.
[[nodiscard]] Result<boost::asio::ip::tcp::endpoint> listen_address(std::string_view text, bool beyond_loopback);

}  // namespace peerd::gateway
