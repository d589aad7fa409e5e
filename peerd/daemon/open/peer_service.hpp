#pragma once
#include <functional>
#include <string>

#include <boost/asio/io_context.hpp>

#include "peerd/daemon/log/log.hpp"
#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/daemon/loop/service.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/peer/config/run_settings.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd {

// Ties a peer to whoever has started it: to a service manager, and where no terminal can be closed under it, to SIGHUP,
// which reads the configuration again. It also lets the log say what it has left out.
class PeerService {
 public:
  // All references outlive it, and it outlives the daemon's run.
  struct Parts {
    boost::asio::io_context& io;
    Daemon& daemon;
    const PeerNode& node;
    Log& log;
    net::ServiceManager manager;
    bool verbose;       // by an option, whatever the configuration says
    std::string peer;   // its name
    std::string world;  // that of its file
    config::RunSettings settings;
    // Reads the configuration again; empty: the peer has none.
    std::function<Result<config::RunSettings>()> read;
  };
  explicit PeerService(Parts parts);
  PeerService(const PeerService&) = delete;
  PeerService& operator=(const PeerService&) = delete;

  // The limits of a configuration, for the log.
  [[nodiscard]] static LineLimiter::Limits limits_of(const config::LogSettings& settings) {
    return {static_cast<double>(settings.burst), settings.per_second};
  }

 private:
  void reload();
  void apply(const config::RunSettings& settings);
  [[nodiscard]] std::string status() const;

  Parts parts_;
  Service service_;
};

}  // namespace peerd
