#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/ip/tcp.hpp>

#include "core/time.hpp"
#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/snapshot/snapshot_message.hpp"

namespace peerd::snapshot {

// A peer that gives snapshots.
struct Provider {
  std::string name;
  boost::asio::ip::tcp::endpoint at;
};

struct Snapshot {
  Offer offer;  // whose logs are as long as those below
  std::string archive;
  std::vector<replication::OperationPart> logs;
  std::string provided_by;   // the peer that made the offer
  std::string checked_with;  // another one that has the same, as far as it has as much; empty: there was none
  std::size_t connections = 0;
  std::vector<std::string> notes;  // for people: peers that failed, or have something else
};

struct FetchOptions {
  // Over so many connections in all, to so many peers at most: where packets get lost, one connection alone is slow.
  std::size_t connections = 32, providers = 4;
  Duration patience = std::chrono::seconds(15);  // without any new part; then it fails
  // If all peers together give a world more slowly than that on average, the one that has given least is given up. The
  // fetch fails once no peer is left.
  double slowest_bytes_per_s = 4.0 * 1024;
  std::optional<keys::SymmetricKey> key{};  // of the session; none: it is open
};

// Gets a snapshot from peers of one session (0: that of the chosen world): parts from all of them at once, and those of
// a peer that fails from the others. Where peers offer different worlds, or different files of one, the offer counts
// that most addresses make. Where several make it, no log is got that one of them alone offers, and of each log as much
// as two of them have. What is held in memory is in proportion to what has come. The error is for people. Blocks.
[[nodiscard]] std::expected<Snapshot, std::string> fetch_snapshot(const std::vector<Provider>& providers,
                                                                  std::uint64_t session,
                                                                  const FetchOptions& options = {});

}  // namespace peerd::snapshot
