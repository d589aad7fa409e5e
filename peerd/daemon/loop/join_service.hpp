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
    net::MulticastOptions multicast;                        // of the session; group and port do not count
    std::function<boost::asio::ip::address()> own_address;  // of the session's datagrams, at present
    std::uint16_t port = 0;                                 // TCP; 0: the system chooses one
    std::uint64_t session = 0, incarnation = 0;
    std::string world, settings;  // as in snapshot::Offer
    std::uint64_t genesis = 0;
    std::string_view archive;  // outlives it; empty: the world cannot be handed out
    snapshot::KeyNow key;
  };

  // All references outlive it. What cannot be opened is said in `log`, and the peer runs without, until it can be.
  JoinService(boost::asio::io_context& io, const net::HostClock& clock, const PeerNode& node, Options options,
              std::function<void(const LogLine&)> log);

  // Goes on where addresses have changed, and where the interface is another one. To be called about once a second,
  // after the transport has followed.
  void follow_network();

 private:
  void open_server();
  void open_responder();
  void say_where();
  [[nodiscard]] discovery::Beacon beacon(const PeerNode& node) const;

  boost::asio::io_context& io_;
  const net::HostClock& clock_;
  const PeerNode& node_;
  Options options_;
  std::function<void(const LogLine&)> log_;
  boost::asio::ip::address said_;                     // where joining peers were last said to be served
  std::string why_no_responder_;                      // as last said
  std::unique_ptr<snapshot::SnapshotServer> server_;  // null: there is none
  std::unique_ptr<discovery::Responder> responder_;   // null: there is none
};

}  // namespace peerd
