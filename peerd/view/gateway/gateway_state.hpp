#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "peerd/peer/control/event_kind.hpp"
#include "peerd/peer/node/log_line.hpp"
#include "peerd/view/gateway/access.hpp"
#include "peerd/view/gateway/gateway_counters.hpp"
#include "peerd/view/gateway/gateway_source.hpp"
#include "peerd/view/gateway/turns.hpp"
#include "peerd/view/gateway/viewer_assets.hpp"

namespace peerd::gateway {

// A connection of either kind: HTTP, or WebSocket.
class Connection {
 public:
  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  virtual void close() = 0;
  // Which connections make room for a new one where all places are taken: first those that have asked for nothing, then
  // those that have not shown the token, the oldest of them first. Whoever has shown it stays.
  enum class Standing : std::uint8_t { kSilent, kStranger, kOwner };
  [[nodiscard]] virtual Standing standing() const = 0;
  std::uint64_t number = 0;  // in the order in which they came
  // The events that it wants, and one of those. An HTTP connection wants none.
  [[nodiscard]] virtual control::EventKinds wanted() const { return {}; }
  virtual void give(control::EventKind /*kind*/, const std::string& /*line*/) {}
  // The scene has another revision.
  virtual void note_revision(std::uint32_t /*revision*/) {}
};

// All connections of a gateway share this. The io_context may hold handlers that outlive the gateway; `over` tells
// them.
class GatewayState {
 public:
  GatewayState(boost::asio::io_context& io, GatewaySource& peer, ViewerAssets files, std::string secret,
               std::vector<std::string> let_in, std::function<void(const LogLine&)> to_log)
      : source(peer),
        assets(files),
        token(std::move(secret)),
        origins(std::move(let_in)),
        turns(std::make_shared<Turns>(io)),
        log_(std::move(to_log)) {}

  // Counts a refusal, and logs the first of its kind.
  void note(RefusalKind kind) {
    if (counters.refused.at(static_cast<std::size_t>(kind))++ > 0) return;
    log_({LogLevel::kWarning,
          "gateway: " + std::string(text_of(kind).log) + "; it is refused, and more such are only counted"});
  }
  // A connection wants other events from now on.
  void find_wanted() {
    wanted_ = {};
    for (const auto& connection : connections) wanted_.add(connection->wanted());
  }
  [[nodiscard]] control::EventKinds wanted() const { return wanted_; }
  void add(const std::shared_ptr<Connection>& connection) {
    connection->number = ++taken_;
    connections.insert(connection);
  }
  // Closes a connection for a new one. False: all are of owners.
  [[nodiscard]] bool make_room() {
    const auto order = [](const auto& each) { return std::pair(each->standing(), each->number); };
    const auto first = std::ranges::min_element(connections, {}, order);
    if (first == connections.end() || (*first)->standing() == Connection::Standing::kOwner) return false;
    note(RefusalKind::kTooMany);
    const std::shared_ptr<Connection> closed = *first;
    closed->close();
    drop(closed);
    return true;
  }
  void drop(const std::shared_ptr<Connection>& connection) {
    connections.erase(connection);
    if (!connection->wanted().empty()) find_wanted();
  }

  GatewaySource& source;
  const ViewerAssets assets;
  const std::string token;
  const std::vector<std::string> origins;         // whose pages may ask, beside its own
  const std::string start_number = make_token();  // revisions of another start are other scenes
  std::uint16_t port = 0;
  std::shared_ptr<Turns> turns;
  std::set<std::shared_ptr<Connection>> connections;
  GatewayCounters counters;
  bool over = false;

 private:
  std::function<void(const LogLine&)> log_;
  control::EventKinds wanted_;  // by some connection
  std::uint64_t taken_ = 0;     // connections
};

}  // namespace peerd::gateway
