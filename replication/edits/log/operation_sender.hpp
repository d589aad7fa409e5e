#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/edits/log/exchange_timing.hpp"
#include "replication/edits/log/member_logs.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/log/range_history.hpp"
#include "replication/settings/policy/rare_branches.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The parts of logs that this peer sends: new ones of its own log at once, and what others ask for in an order in which
// most often one peer answers.
class OperationSender {
 public:
  // A longer range is sent once: what gets lost of it is asked for.
  static constexpr std::uint64_t kCopied_bytes = 8 * 1024;
  static constexpr Duration kBetweenCopies = std::chrono::milliseconds(5);
  // Blocks of a log are answered for by one peer each, so that several peers share a long log.
  static constexpr std::uint64_t kBlock_bytes = 64 * 1024;
  static constexpr std::size_t kWaitingMax = 1024;

  // They outlive this. `own`: the author that this peer is.
  OperationSender(const OperationLogs& logs, const MemberLogs& members, ExchangeTiming& timing, PeerId self,
                  AuthorId own, const RareBranches& rare)
      : logs_(logs), members_(members), timing_(timing), self_(self), own_(own), rare_(rare) {}

  // The own log has grown by that range. `copies` >= 1.
  void on_append(HostTime now, const OperationRange& range, std::uint32_t copies);
  // Another member asks for a range.
  void on_request(HostTime now, const OperationRange& range);
  // Another member has sent a part.
  void on_part(HostTime now, PeerId from, const OperationRange& range);
  // Nobody is here any more who could want anything.
  void clear() { waiting_.clear(); }

  // The parts for one datagram that are due now; none: nothing is.
  [[nodiscard]] std::vector<OperationPart> due(HostTime now);
  [[nodiscard]] std::optional<HostTime> next_deadline() const;

  // The answers that were not given because another peer gave them, and those that had no place in the queue.
  [[nodiscard]] std::uint64_t cancelled() const { return cancelled_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  struct Waiting {
    OperationRange range;  // what is still to be sent
    HostTime due{};
    std::uint64_t begin = 0;  // of the whole range
    std::uint32_t more_copies = 0;
    bool answers = false;  // else it is new
  };

  void wait_for(const Waiting& waiting);
  [[nodiscard]] std::vector<Waiting>::iterator first_due(HostTime now);

  const OperationLogs& logs_;
  const MemberLogs& members_;
  ExchangeTiming& timing_;
  PeerId self_;
  AuthorId own_;
  const RareBranches& rare_;
  std::vector<Waiting> waiting_;
  RangeHistory sent_;  // by anybody
  std::uint64_t cancelled_ = 0, dropped_ = 0;
};

}  // namespace peerd::replication
