#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>

#include "core/time.hpp"
#include "peerd/net/discovery/beacon.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/multicast_socket.hpp"

namespace peerd::discovery {

// How peers of a LAN find each other's worlds: whoever wants to know asks a multicast group of its own, and all peers
// answer there. With nobody who asks nothing is sent.

// The group and the port for questions and beacons, the same for all worlds, of the family of a session's group.
[[nodiscard]] net::GroupPlan group_for(const boost::asio::ip::address& session_group);

// Answers questions with this peer's beacon, at most once in kAnswersApart: an answer goes to all who ask.
class Responder {
 public:
  static constexpr Duration kAnswersApart = std::chrono::milliseconds(50);

  // `options`: those of the session's transport, whose group and port do not count. `beacon` is called for each answer.
  [[nodiscard]] static std::expected<std::unique_ptr<Responder>, net::NetError> open(boost::asio::io_context& io,
                                                                                     const net::HostClock& clock,
                                                                                     net::MulticastOptions options,
                                                                                     std::function<Beacon()> beacon);

  // Goes on over the interface that the session's transport goes on over (Transport::follow_interface).
  void follow_interface() { (void)socket_->follow_interface(); }  // the transport says it

 private:
  explicit Responder(std::function<Beacon()> beacon) : beacon_(std::move(beacon)) {}
  void on_datagram(const net::Arrival& arrival);

  std::unique_ptr<net::MulticastSocket> socket_;
  std::function<Beacon()> beacon_;
  std::optional<HostTime> answered_at_;
};

// A peer that has answered.
struct Found {
  Beacon beacon;
  boost::asio::ip::address address;  // of its snapshot_port
};

struct Asked {
  std::vector<Found> found;
  std::string where;  // in words: the group and the interface
};

// Asks for so long, several times, and returns who has answered, by world, session (the sealed ones first) and peer; of
// a peer that was started again in the meantime the later start. Anybody can answer anything. `options` as for
// Responder.
[[nodiscard]] std::expected<Asked, net::NetError> ask_who_is_here(const net::HostClock& clock,
                                                                  net::MulticastOptions options, Duration time);

}  // namespace peerd::discovery
