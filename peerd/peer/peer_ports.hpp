#pragma once
#include <memory>

#include <boost/asio/io_context.hpp>

#include "peerd/config/run_settings.hpp"
#include "peerd/control/control_server.hpp"
#include "peerd/daemon/daemon.hpp"
#include "peerd/daemon/viewed_peer.hpp"
#include "peerd/gateway/gateway.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/log/log.hpp"
#include "peerd/os/udp_port.hpp"
#include "peerd/peer/peer_options.hpp"
#include "peerd/peer/peer_parts.hpp"

namespace peerd {

// PeerPorts are where other programs reach a peer: its control socket, its page for browsers, its port for poses. Each
// is there where somebody wants it.
class PeerPorts {
 public:
  // All references outlive it.
  [[nodiscard]] static Result<std::unique_ptr<PeerPorts>> open(boost::asio::io_context& io, const PeerOptions& options,
                                                               const PeerParts& parts, Daemon& daemon, PeerNode& node,
                                                               Log& log);
  ~PeerPorts();
  PeerPorts(const PeerPorts&) = delete;
  PeerPorts& operator=(const PeerPorts&) = delete;

  // Logs requests and poses that were refused or lost, and closes what clients are connected to.
  void close();

 private:
  PeerPorts(boost::asio::io_context& io, const PeerOptions& options, const PeerParts& parts, Daemon& daemon,
            PeerNode& node, Log& log);

  Log& log_;
  std::unique_ptr<api::ControlServer> control_;  // null: there is none
  ViewedPeer viewed_;
  std::unique_ptr<gateway::Gateway> gateway_;  // null: there is none
  std::unique_ptr<feed::UdpPort> poses_;       // null: there is none
};

}  // namespace peerd
