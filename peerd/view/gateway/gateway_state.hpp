#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
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
  using Clock = std::chrono::steady_clock;

  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  virtual void close() = 0;
  // An owner has shown the token, a stranger has asked for something without it, and a silent one has asked for nothing
  // yet.
  enum class Standing : std::uint8_t { kSilent, kStranger, kOwner };
  [[nodiscard]] virtual Standing standing() const = 0;
  std::uint64_t number = 0;       // in the order in which they came
  Clock::time_point active_at{};  // when it last asked for something; a silent one: when it came
  // The events that it wants, and one of those. An HTTP connection wants none.
  [[nodiscard]] virtual control::EventKinds wanted() const { return {}; }
  virtual void give(control::EventKind /*kind*/, const std::string& /*line*/) {}
  // The scene has another revision.
  virtual void note_revision(std::uint32_t /*revision*/) {}
};

// A silent connection is about to ask for so long.
inline constexpr std::chrono::seconds kAsksWithin{1};

// Which connections make room for a new one where all places are taken, the lowest first: silent ones that came more
// than kAsksWithin ago, then strangers, then the other silent ones; of each the one first that was active longest ago.
// None: an owner's, which stays.
using RoomOrder = std::tuple<int, Connection::Clock::time_point, std::uint64_t>;
[[nodiscard]] inline std::optional<RoomOrder> room_order(const Connection& connection,
                                                         Connection::Clock::time_point now) {
  const auto order = [&](int group) { return RoomOrder{group, connection.active_at, connection.number}; };
  switch (connection.standing()) {
    case Connection::Standing::kSilent:
      return order(now - connection.active_at > kAsksWithin ? 0 : 2);
    case Connection::Standing::kStranger:
      return order(1);
    case Connection::Standing::kOwner:
      break;
  }
  return std::nullopt;
}

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
    connection->active_at = Connection::Clock::now();
    connections.insert(connection);
  }
  // Closes a connection for a new one. False: all are of owners.
  [[nodiscard]] bool make_room(Connection::Clock::time_point now) {
    std::optional<RoomOrder> lowest;
    std::shared_ptr<Connection> closed;
    for (const auto& each : connections) {
      const auto order = room_order(*each, now);
      if (!order || (lowest && *lowest <= *order)) continue;
      lowest = order;
      closed = each;
    }
    if (closed == nullptr) return false;
    note(RefusalKind::kTooMany);
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
