#pragma once
#include <array>
#include <cstdint>
#include <expected>
#include <memory>

#include <boost/asio/io_context.hpp>

#include "peerd/feed/pose_feeds.hpp"
#include "peerd/os/host_clock.hpp"
#include "peerd/transport/multicast_socket.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd {

// An update's whole way from PeerNode::on_poses() to the other's on_packet(), through the kernel and back, walked for
// its own sake by two peers of nobody's session. A peer that looks for datagrams for milliseconds does nothing else
// meanwhile, and by the next update the processor has neither those instructions at hand nor a guess where they branch.
//
// Both live here, in a time of their own that only run() moves. What they send stays on this computer: over lo, with a
// TTL of 0, to a port that the system has chosen for this.
class CacheWarmer {
 public:
  // An update's number is finite, and these two live fast: after so many runs, 2.5 days of a peer that polls all the
  // time, they begin anew, which takes some milliseconds.
  static constexpr std::uint64_t kRunsPerSession = std::uint64_t{1} << 30;

  // They publish as `policy` has it, but for what would keep them silent: its budget of bytes, thresholds beyond those
  // of scenes. An error, too, where nothing of what is sent comes back.
  [[nodiscard]] static std::expected<std::unique_ptr<CacheWarmer>, net::NetError> make(
      replication::PublishPolicy policy, std::uint64_t runs_per_session = kRunsPerSession);
  CacheWarmer(const CacheWarmer&) = delete;
  CacheWarmer& operator=(const CacheWarmer&) = delete;

  // One of them, by turns, ticks and is told where its object is, which it tells the other.
  void run();

  // Updates that one has had from the other, in this session.
  [[nodiscard]] std::uint64_t updates_received() const;
  [[nodiscard]] std::uint64_t sessions() const { return sessions_; }

 private:
  CacheWarmer(const replication::PublishPolicy& policy, std::uint64_t runs_per_session);
  void begin();
  void send_all(PeerNode& node);

  replication::PublishPolicy policy_;
  std::uint64_t runs_per_session_;
  net::HostClock clock_;
  boost::asio::io_context io_{1};  // never run: the socket is read where something has been sent
  std::unique_ptr<const SharedWorld> shared_;
  std::array<std::unique_ptr<PeerNode>, 2> nodes_;
  std::unique_ptr<net::MulticastSocket> socket_;
  HostTime now_{};
  std::uint64_t runs_ = 0, sessions_ = 0;  // runs_: of this one
  feed::FedPose pose_;
};

}  // namespace peerd
