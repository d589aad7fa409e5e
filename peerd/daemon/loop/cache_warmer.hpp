#pragma once
#include <array>
#include <cstdint>
#include <expected>
#include <memory>

#include <boost/asio/io_context.hpp>

#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/multicast_socket.hpp"
#include "peerd/peer/feed/pose_feeds.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd {

// Keeps the processor's caches and branch predictors warm for the path of an update while a daemon polls. A peer that
// polls for milliseconds executes nothing else, and by the next update the instructions of that path have left the
// caches. So two private peers send each other updates, from PeerNode::on_poses() through the kernel to
// PeerNode::on_packet().
//
// Both peers live in this object, in a time of their own that only run() advances. Their datagrams stay on this
// computer: they go over lo, with a TTL of 0, to a port that the system has chosen.
class CacheWarmer {
 public:
  // After so many runs, 2.5 days of permanent polling, the two peers are made anew, which takes some milliseconds: the
  // sequence numbers of updates are finite.
  static constexpr std::uint64_t kRunsPerSession = std::uint64_t{1} << 30;

  // The two peers publish by `policy`, except for the settings that would silence them: its byte budget, and thresholds
  // beyond those of scenes. It is an error, too, if no datagram comes back.
  [[nodiscard]] static std::expected<std::unique_ptr<CacheWarmer>, net::NetError> make(
      replication::PublishPolicy policy, std::uint64_t runs_per_session = kRunsPerSession);
  CacheWarmer(const CacheWarmer&) = delete;
  CacheWarmer& operator=(const CacheWarmer&) = delete;

  // One of the two peers, in turn, gets a pose of its object and sends the update to the other.
  void run();

  // Updates that both peers have received from each other, in this session.
  [[nodiscard]] std::uint64_t updates_received() const;
  [[nodiscard]] std::uint64_t sessions() const { return sessions_; }

 private:
  CacheWarmer(const replication::PublishPolicy& policy, std::uint64_t runs_per_session);
  void begin();
  void send_all(PeerNode& node);

  replication::PublishPolicy policy_;
  std::uint64_t runs_per_session_;
  net::HostClock clock_;
  boost::asio::io_context io_{1};  // never run: send_all() reads the socket itself
  std::unique_ptr<const SharedWorld> shared_;
  std::array<std::unique_ptr<PeerNode>, 2> nodes_;
  std::unique_ptr<net::MulticastSocket> socket_;
  HostTime now_{};
  std::uint64_t runs_ = 0, sessions_ = 0;  // runs_ counts those of this session
  feed::FedPose pose_;
};

}  // namespace peerd
