#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

#include "core/ids.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// How much of each log the other members hold, as far as they have said so.
class MemberLogs {
 public:
  // The lengths of one member that are kept; more are ignored and counted.
  static constexpr std::size_t kAuthorsMax = 65'536;

  // A member that is new has not said yet what it holds.
  void on_joined(PeerId peer) { members_[peer] = {}; }
  void on_lost(PeerId peer) { members_.erase(peer); }
  // A member says how long its logs are. It may leave some out. Of a peer that is no member nothing is kept.
  void on_lengths(PeerId peer, std::span<const LogLength> logs);
  // A member has sent a part that ends there.
  void at_least(PeerId peer, const LogLength& log);

  [[nodiscard]] bool empty() const { return members_.empty(); }
  [[nodiscard]] std::size_t size() const { return members_.size(); }
  [[nodiscard]] std::uint64_t length(PeerId peer, AuthorId author) const;
  // The length of the longest log of that author that a member holds.
  [[nodiscard]] std::uint64_t longest(AuthorId author) const;
  // The number of members that may lack bytes before that length.
  [[nodiscard]] std::size_t lacking(const LogLength& log) const;
  // The place of `self` among those that hold a range, which is in that block of its log: an order by hash, another one
  // for each block, so that blocks come from different peers. 0: all others come later.
  [[nodiscard]] std::size_t rank(PeerId self, const OperationRange& range, std::uint64_t block) const;
  // The number of members that have not said yet what they hold.
  [[nodiscard]] std::size_t silent() const;
  [[nodiscard]] std::uint64_t ignored() const { return ignored_; }

 private:
  struct Logs {
    std::map<AuthorId, std::uint64_t> lengths;
    bool has_spoken = false;
  };
  void set(Logs& logs, const LogLength& log);

  std::map<PeerId, Logs> members_;
  std::uint64_t ignored_ = 0;
};

}  // namespace peerd::replication
