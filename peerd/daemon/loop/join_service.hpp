#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>

#include "peerd/net/discovery/discovery.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/snapshot/snapshot_server.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd {

// The JoinService of a peer for joining peers: it answers questions in this LAN who is here, and hands out its world.
class JoinService {
 public:
  struct Options {
    net::MulticastOptions multicast;   // of the session; group and port do not count
    boost::asio::ip::address address;  // at which joining peers are served
    std::uint16_t port = 0;            // TCP; 0: the system chooses one
    std::uint64_t session = 0, incarnation = 0;
    std::string world, settings;  // as in snapshot::Offer
    std::uint64_t genesis = 0;
    std::string_view archive;  // outlives it; empty: the world cannot be handed out
    snapshot::KeyNow key;
  };

  // All references outlive it. What cannot be opened is said in `log`, and the peer runs without.
  JoinService(boost::asio::io_context& io, const net::HostClock& clock, const PeerNode& node, Options options,
              const std::function<void(const LogLine&)>& log);

 private:
  [[nodiscard]] discovery::Beacon beacon(const PeerNode& node) const;

  Options options_;
  std::unique_ptr<snapshot::SnapshotServer> server_;  // null: there is none
  std::unique_ptr<discovery::Responder> responder_;   // null: there is none
};

}  // namespace peerd
