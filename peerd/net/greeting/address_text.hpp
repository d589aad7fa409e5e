#pragma once
#include <boost/asio/ip/udp.hpp>
#include <string>

namespace peerd::net {

// An address as people write it: "192.0.2.7:47480" or "[2001:db8::7]:47480".
[[nodiscard]] inline std::string address_text(const boost::asio::ip::udp::endpoint& at) {
  const std::string address = at.address().to_string(), port = ":" + std::to_string(at.port());
  return at.address().is_v6() ? "[" + address + "]" + port : address + port;
}

}  // namespace peerd::net
