#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/time.hpp"
#include "peerd/net/keys/symmetric_key.hpp"
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
  // A log with a later stamp is of a broken clock, and is not offered: a joining peer would have its operations at
  // once.
  std::function<SimTime()> latest_stamp;
  KeyNow key = [] { return std::nullopt; };
  std::function<std::uint64_t()> line = [] { return 0; };  // of descent, of the logs
};

// Makes the reply to a request, which may be anything, in steps. A step reads at most kStep_bytes of logs, or
// kStepLogs short ones, so that a peer's ticks wait for a fraction of a millisecond, whatever somebody asks.
class ReplyWork {
 public:
  static constexpr std::size_t kStep_bytes = kPartMax_bytes, kStepLogs = 64;

  // The content outlives this.
  ReplyWork(std::string_view request, const SnapshotContent& content);

  // Takes a step. Returns the reply once it is made, after which there is no further step.
  [[nodiscard]] std::optional<Reply> step();

 private:
  [[nodiscard]] bool add_digests(const DigestRequest& asked);

  const SnapshotContent* content_;
  std::optional<Refusal> refused_;
  Request request_;
  Digests digests_;
  std::optional<Digester> digester_;  // of the log whose turn it is; none: it has not begun
  std::uint64_t digested_ = 0;        // bytes of that log
};

// The reply to a request, all of whose steps are taken at once.
[[nodiscard]] Reply reply_to(std::string_view request, const SnapshotContent& content);

}  // namespace peerd::snapshot
