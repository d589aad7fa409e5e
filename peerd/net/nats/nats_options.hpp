#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <string>

#include "peerd/net/settings/nats_settings.hpp"

namespace peerd::nats {

// A NatsTransport needs to know this.
struct NatsOptions {
  net::NatsSettings settings;           // with one server at least
  std::string world;                    // its name, of which subjects are made; not empty
  std::uint64_t session = 0;            // the session's hash
  std::string name = "peerd";           // of this connection, in the servers' monitoring
  std::size_t receive_bytes = 1 << 20;  // of datagrams that wait to be read; further ones are lost
  // Stands for the sender of what comes, which a server does not say; of the family that captures are to have.
  boost::asio::ip::udp::endpoint nobody{};
};

}  // namespace peerd::nats
