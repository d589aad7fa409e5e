#include "peerd/daemon/loop/join_service.hpp"

#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/os/interfaces.hpp"
#include "replication/wire/codec.hpp"

namespace peerd {

JoinService::JoinService(boost::asio::io_context& io, const net::HostClock& clock, const PeerNode& node,
                         Options options, std::function<void(const LogLine&)> log)
    : io_(io), clock_(clock), node_(node), options_(std::move(options)), log_(std::move(log)) {
  if (!options_.archive.empty()) open_server();
  open_responder();
}

// The peer's address may change at any time (a lease, a privacy address): it listens at all of this computer's, and
// takes a connection to one of the interface of its session. Where that is a named lo, it listens there alone.
void JoinService::open_server() {
  const auto own = options_.own_address();
  const auto any = own.is_v4() ? boost::asio::ip::address(boost::asio::ip::address_v4::any())
                               : boost::asio::ip::address(boost::asio::ip::address_v6::any());
  const bool stays = own.is_loopback() && !options_.multicast.interface.empty();
  auto server = snapshot::SnapshotServer::open(
      io_, stays ? own : any, options_.port,
      {.session = options_.session,
       .world = options_.world,
       .settings = options_.settings,
       .genesis = options_.genesis,
       .archive = options_.archive,
       .archive_digest = snapshot::digest(options_.archive),
       .logs = [this]() -> const replication::OperationLogs& { return node_.peer().logs(); },
       .latest_stamp =
           [this] {
             const auto& session = node_.peer().clock();
             return session.synchronised() ? session.to_session(clock_.now()) + replication::kStampAheadMax
                                           : SimTime::max();
           },
       .key = options_.key,
       .line = [this] { return node_.options().line; }},
      [this](const boost::asio::ip::address& at) {
        const auto session_at = options_.own_address();
        return session_at.is_unspecified() || net::are_of_one_interface(at, session_at);
      });
  if (!server) {
    log_({LogLevel::kWarning, "gives its world to nobody who joins: " + server.error().sentence});
    return;
  }
  server_ = *std::move(server);
  say_where();
}

void JoinService::say_where() {
  said_ = options_.own_address();
  log_({LogLevel::kInfo, fmt::format("gives \"{}\" to who joins, at {} port {} by TCP", options_.world,
                                     said_.to_string(), server_->port())});
}

void JoinService::open_responder() {
  auto responder = discovery::Responder::open(io_, clock_, options_.multicast, [this] { return beacon(node_); });
  if (responder) {
    responder_ = *std::move(responder);
    if (!why_no_responder_.empty()) log_({LogLevel::kInfo, "peerd ls and peerd join find it from now on"});
    why_no_responder_.clear();
  } else if (why_no_responder_ != responder.error().sentence) {
    why_no_responder_ = responder.error().sentence;
    log_({LogLevel::kWarning, "peerd ls and peerd join do not find it: " + why_no_responder_});
  }
}

void JoinService::follow_network() {
  if (responder_) {
    responder_->follow_interface();
  } else {
    open_responder();
  }
  if (server_ && options_.own_address() != said_) say_where();
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
