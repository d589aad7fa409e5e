#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "replication/wire/operation.hpp"

namespace peerd::snapshot {

// The Parts that a joining peer has to get, of the archive and of each log, and which of them are there. Memory is
// taken for what has come alone, not for what somebody has offered.
class Parts {
 public:
  // Plans to get that archive and these logs. A part that was planned before, too, keeps its state.
  void plan(std::uint64_t archive_bytes, const std::vector<replication::LogLength>& logs);
  // The next part to ask for over a connection. `held`: how much the peer has of each log; `asked`: what the connection
  // was asked for before. A part that no connection awaits comes first, then one that a single other connection awaits,
  // which may be slow.
  [[nodiscard]] std::optional<replication::OperationRange> next(
      const std::map<replication::AuthorId, std::uint64_t>& held, std::set<replication::OperationRange>& asked);
  // Takes the bytes of a part from that peer. False: they are more or fewer than the part has.
  [[nodiscard]] bool take(const replication::OperationRange& part, std::string_view bytes, std::size_t peer);
  // A connection has failed that was asked for the part.
  void give_back(const replication::OperationRange& part);
  // Forgets all parts that a peer has given. The caller has to call plan() after that.
  void drop(std::size_t peer);
  // Forgets the archive, which content() has returned. The caller has to call plan() after that.
  void drop_archive() { contents_.erase(replication::kNoAuthor); }

  [[nodiscard]] bool are_there() const { return unasked_.empty() && awaited_.empty(); }
  // The bytes that a peer has given, unpacked.
  [[nodiscard]] std::uint64_t given_bytes(std::size_t peer) const;
  // The peers that have given parts of a log.
  [[nodiscard]] const std::set<std::size_t>& givers(replication::AuthorId author) { return givers_[author]; }
  // A log, or the archive, all of which is there. From then on it is one text.
  [[nodiscard]] std::string& content(replication::AuthorId author);

 private:
  struct Awaited {
    replication::OperationRange part;
    std::size_t connections = 0;
  };
  struct Held {
    std::string bytes;
    std::size_t giver;  // a peer
  };

  std::deque<replication::OperationRange> unasked_;
  std::vector<Awaited> awaited_;  // in the order of asking
  std::map<replication::OperationRange, Held> held_;
  std::map<replication::AuthorId, std::string> contents_;  // what content() has returned
  std::map<std::size_t, std::uint64_t> given_bytes_;
  std::map<replication::AuthorId, std::set<std::size_t>> givers_;
};

}  // namespace peerd::snapshot
