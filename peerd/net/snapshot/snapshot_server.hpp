#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>

#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/os/net_error.hpp"
#include "peerd/net/snapshot/snapshot_message.hpp"
#include "replication/edits/log/operation_log.hpp"

namespace peerd::snapshot {

// Gives the key of the session at present; none: connections are open.
using KeyNow = std::function<std::optional<keys::SymmetricKey>()>;

// A SnapshotContent is all that a server gives. It outlives the server.
struct SnapshotContent {
  std::uint64_t session = 0;
  std::string world, settings;  // as in Offer
  std::uint64_t genesis = 0;
  std::string_view archive;
  std::uint64_t archive_digest = 0;  // digest(archive)
  std::function<const replication::OperationLogs&()> logs;
  std::function<std::uint64_t()> line = [] { return 0; };  // of descent, of the logs
  // A log with a later stamp is of a broken clock, and is not offered: a joining peer would have its operations at
  // once.
  std::function<SimTime()> latest_stamp;
  KeyNow key = [] { return std::nullopt; };
};

// Answers joining peers by TCP, in the io_context's one thread: one part of at most kPartMax_bytes at a time of each,
// which costs less than a millisecond. It changes nothing, whatever it is asked.
class SnapshotServer {
 public:
  static constexpr std::size_t kConnectionsMax = 256;

  // Listens at a port that the system chooses where `port` is 0. `serves_at`: whether a connection to that address of
  // this computer is taken, once it has come; none: each is. So a server at the unspecified address goes on where the
  // addresses of this computer change.
  using ServesAt = std::function<bool(const boost::asio::ip::address&)>;
  [[nodiscard]] static std::expected<std::unique_ptr<SnapshotServer>, net::NetError> open(
      boost::asio::io_context& io, const boost::asio::ip::address& address, std::uint16_t port, SnapshotContent content,
      ServesAt serves_at = {});
  SnapshotServer(const SnapshotServer&) = delete;
  SnapshotServer& operator=(const SnapshotServer&) = delete;
  ~SnapshotServer();

  [[nodiscard]] std::uint16_t port() const;

 private:
  class Impl;
  explicit SnapshotServer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

// The reply to a request, which may be anything.
[[nodiscard]] Reply reply_to(std::string_view request, const SnapshotContent& content);

}  // namespace peerd::snapshot
