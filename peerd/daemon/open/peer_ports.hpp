#pragma once
#include <memory>

#include <boost/asio/io_context.hpp>

#include "peerd/daemon/log/log.hpp"
#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/daemon/loop/viewed_peer.hpp"
#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/daemon/open/peer_parts.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/net/os/udp_port.hpp"
#include "peerd/peer/config/run_settings.hpp"
#include "peerd/peer/control/control_server.hpp"
#include "peerd/view/gateway/gateway.hpp"

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
  std::unique_ptr<control::ControlServer> control_;  // null: there is none
  ViewedPeer viewed_;
  std::unique_ptr<gateway::Gateway> gateway_;  // null: there is none
  std::unique_ptr<net::UdpPort> poses_;        // null: there is none
};

}  // namespace peerd
