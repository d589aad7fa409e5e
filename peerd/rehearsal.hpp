#pragma once
#include <array>
#include <cstdint>
#include <expected>
#include <memory>

#include <boost/asio/io_context.hpp>

#include "peerd/feed/pose_feeds.hpp"
#include "peerd/net/host_clock.hpp"
#include "peerd/net/multicast_socket.hpp"
#include "peerd/peer_node.hpp"

namespace peerd {

// An update's whole way from PeerNode::on_poses() to the other's on_packet(), through the kernel and back, walked for
// its own sake by two peers of nobody's session. A peer that looks for datagrams for milliseconds does nothing else
// meanwhile, and by the next update the processor has neither those instructions at hand nor a guess where they branch.
//
// Both live here, in a time of their own that only run() moves. What they send stays on this computer: over lo, with a
// TTL of 0, to a port that the system has chosen for this.
class Rehearsal {
 public:
  // They publish as `policy` has it, but for its budget of bytes.
  [[nodiscard]] static std::expected<std::unique_ptr<Rehearsal>, net::NetError> make(replication::PublishPolicy policy);
  Rehearsal(const Rehearsal&) = delete;
  Rehearsal& operator=(const Rehearsal&) = delete;

  // One of them, by turns, ticks and is told where its object is, which it tells the other. Every kRunsOfASession they
  // begin anew, which takes some milliseconds.
  void run();
  // An update's number and a session's time are finite, and these two live fast.
  static constexpr std::uint64_t kRunsOfASession = std::uint64_t{1} << 18;

  // Updates that one has had from the other.
  [[nodiscard]] std::uint64_t heard() const { return heard_before_ + heard_now(); }

 private:
  explicit Rehearsal(const replication::PublishPolicy& policy);
  void begin();
  [[nodiscard]] std::uint64_t heard_now() const;
  void send_all(std::size_t from);

  replication::PublishPolicy policy_;
  net::HostClock clock_;
  boost::asio::io_context io_{1};  // never run: the socket is read where something has been sent
  std::unique_ptr<const SharedWorld> shared_;
  std::array<std::unique_ptr<PeerNode>, 2> nodes_;
  std::unique_ptr<net::MulticastSocket> socket_;
  std::size_t listener_ = 0;  // to what the socket hears
  HostTime now_{};
  std::uint64_t runs_ = 0, heard_before_ = 0;  // of this session, before it
  feed::FedPose pose_;
};

}  // namespace peerd
