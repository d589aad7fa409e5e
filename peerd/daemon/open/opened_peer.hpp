#pragma once
#include <memory>
#include <optional>

#include <boost/asio/io_context.hpp>

#include "peerd/daemon/log/log.hpp"
#include "peerd/daemon/loop/cache_warmer.hpp"
#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/daemon/loop/join_service.hpp"
#include "peerd/daemon/loop/network_watch.hpp"
#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/daemon/open/peer_parts.hpp"
#include "peerd/daemon/open/peer_ports.hpp"
#include "peerd/daemon/open/peer_service.hpp"
#include "peerd/daemon/open/session_seal.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/open_transport.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "peerd/peer/record/capture.hpp"
#include "peerd/peer/record/recording_signer.hpp"

namespace peerd {

// An OpenedPeer is one real peer with all that belongs to it: world, seal, network, store, capture, ports, log.
class OpenedPeer {
 public:
  // Opens all of it; the peer takes part from run() on, or from Daemon::begin(). Errors: wrong settings, a world that
  // can't be read, no network, a store that is damaged.
  [[nodiscard]] static Result<std::unique_ptr<OpenedPeer>> open(const PeerOptions& options, const WarnPerson& warn);
  ~OpenedPeer();
  OpenedPeer(const OpenedPeer&) = delete;
  OpenedPeer& operator=(const OpenedPeer&) = delete;

  // Runs until the peer leaves, and closes it; the manager knows how it is. Returns the exit code.
  [[nodiscard]] Result<int> run(const net::ServiceManager& manager);
  [[nodiscard]] std::optional<std::uint64_t> goes_over() const { return node_->goes_over(); }  // as PeerNode
  // Closes a peer that has left: writes its last lines, and what it was to record.
  [[nodiscard]] Result<void> close();

  [[nodiscard]] boost::asio::io_context& io() { return io_; }
  [[nodiscard]] Daemon& daemon() { return *daemon_; }
  [[nodiscard]] PeerNode& node() { return *node_; }
  [[nodiscard]] const net::HostClock& clock() const { return clock_; }
  [[nodiscard]] const config::PeerSettings& settings() const { return *parts_.settings; }

 private:
  OpenedPeer(PeerOptions options, PeerParts parts);
  [[nodiscard]] Result<void> open_network();
  [[nodiscard]] Result<void> open_node();
  [[nodiscard]] Result<void> open_capture(PeerNode::Options& node);
  [[nodiscard]] Result<void> open_daemon(const PeerNode::Options& node);
  void begin_log();
  [[nodiscard]] Result<config::RunSettings> read_again() const;

  PeerOptions options_;
  PeerParts parts_;
  net::HostClock clock_;
  Log log_;
  SayLine say_;
  boost::asio::io_context io_{1};
  std::optional<keys::Identity> identity_;
  std::unique_ptr<SessionSeal> session_seal_;
  std::optional<net::TransportOptions> reach_;
  std::unique_ptr<record::CaptureWriter> capture_, sealed_capture_;  // null: there is none
  std::optional<net::OpenedTransport> reached_;
  std::optional<record::RecordingSigner> signer_;
  std::unique_ptr<PeerNode> node_;
  std::unique_ptr<CacheWarmer> cache_warmer_;  // null: there is none
  std::unique_ptr<Daemon> daemon_;
  std::unique_ptr<PeerPorts> ports_;
  std::optional<JoinService> join_service_;
  std::optional<NetworkWatch> network_watch_;
  std::unique_ptr<PeerService> service_;  // null: another program has the process
};

}  // namespace peerd
