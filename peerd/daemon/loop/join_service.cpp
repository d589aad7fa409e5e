#include "peerd/daemon/loop/join_service.hpp"

#include <utility>

#include <spdlog/fmt/fmt.h>

#include "replication/wire/codec.hpp"

namespace peerd {

JoinService::JoinService(boost::asio::io_context& io, const net::HostClock& clock, const PeerNode& node,
                         Options options, const std::function<void(const LogLine&)>& log)
    : options_(std::move(options)) {
  if (!options_.archive.empty()) {
    auto server = snapshot::SnapshotServer::open(
        io, options_.address, options_.port,
        {options_.session, options_.world, options_.settings, options_.genesis, options_.archive,
         snapshot::digest(options_.archive),
         [&node]() -> const replication::OperationLogs& { return node.peer().logs(); },
         [&node, &clock] {
           const auto& session = node.peer().clock();
           return session.synchronised() ? session.to_session(clock.now()) + replication::kStampAheadMax
                                         : SimTime::max();
         },
         options_.key});
    if (server) {
      server_ = *std::move(server);
      log({LogLevel::kInfo, fmt::format("gives \"{}\" to who joins, at {} port {} by TCP", options_.world,
                                        options_.address.to_string(), server_->port())});
    } else {
      log({LogLevel::kWarning, "gives its world to nobody who joins: " + server.error().sentence});
    }
  }
  auto responder = discovery::Responder::open(io, clock, options_.multicast, [this, &node] { return beacon(node); });
  if (responder) {
    responder_ = *std::move(responder);
  } else {
    log({LogLevel::kWarning, "peerd ls and peerd join do not find it: " + responder.error().sentence});
  }
}

discovery::Beacon JoinService::beacon(const PeerNode& node) const {
  return {.protocol = replication::kProtocolVersion,
          .session = options_.session,
          .peer = node.peer().id(),
          .incarnation = options_.incarnation,
          .snapshot_port = server_ ? server_->port() : std::uint16_t{0},
          .world = options_.world,
          .name = node.name(),
          .sealed = options_.key().has_value()};
}

}  // namespace peerd
