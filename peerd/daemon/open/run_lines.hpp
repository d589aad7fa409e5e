#pragma once
#include <filesystem>

#include "peerd/daemon/log/log.hpp"
#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/daemon/open/peer_parts.hpp"
#include "peerd/net/transport/open_transport.hpp"
#include "peerd/peer/config/peer_settings.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd {

// Logs at the beginning of a run who this is, where, and whom it reaches.
void log_beginning(const config::PeerSettings& peer, const std::filesystem::path& world,
                   const net::TransportSettings& settings, const net::OpenedTransport& reached, Log& log);
// Logs what is odd about the world and the store.
void log_findings(const PeerParts& parts, Log& log);
// Logs at the end of a run what has come and gone.
void log_totals(const PeerNode& node, const PeerLog& record, const net::Transport& transport, const Daemon& daemon,
                Log& log);

}  // namespace peerd
