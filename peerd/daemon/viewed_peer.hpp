#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "peerd/daemon/daemon.hpp"
#include "peerd/gateway/gateway_source.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd {

// The peer of a daemon as its gateway shows it. What is asked by the control protocol goes through the daemon, and so
// into its capture; what only looks does not.
class ViewedPeer : public gateway::GatewaySource {
 public:
  // Both outlive it.
  ViewedPeer(Daemon& daemon, PeerNode& node) : daemon_(daemon), node_(node) {}

  api::Answer ask(std::string_view request) override { return daemon_.on_control(request); }
  std::string metrics() override;
  std::uint32_t revision() override;

 private:
  Daemon& daemon_;
  PeerNode& node_;
};

}  // namespace peerd
