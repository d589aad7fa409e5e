#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "replication/edits/log/exchange_timing.hpp"
#include "replication/edits/log/member_logs.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/log/range_history.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// Decides which missing ranges this peer asks for, and when. A long log is asked for window by window, so that what
// arrives behind gaps has room.
class OperationRequests {
 public:
  static constexpr std::uint64_t kWindow_bytes = 256 * 1024;
  static constexpr std::size_t kRangesOfOneMax = 8;

  // They outlive this.
  OperationRequests(const OperationLogs& logs, const MemberLogs& members, ExchangeTiming& timing)
      : logs_(logs), members_(members), timing_(timing) {}

  // A member holds a log that long.
  void on_length(HostTime now, const LogLength& log);
  // A part has been received, and the logs have taken it if they could.
  void on_part(HostTime now, AuthorId author);
  // Another member has asked for these.
  void on_requests(HostTime now, std::span<const OperationRange> ranges);

  // The ranges to ask for now, of all members.
  [[nodiscard]] std::vector<OperationRange> due(HostTime now);
  [[nodiscard]] std::optional<HostTime> next_deadline() const;
  // The times at which nothing was left to ask for, because others had just done so.
  [[nodiscard]] std::uint64_t suppressed() const { return suppressed_; }

 private:
  struct Missing {
    HostTime due{};
    std::uint32_t asked = 0;       // so often since the log has last grown
    std::uint64_t length = 0;      // of the log then
    std::uint64_t window_end = 0;  // of the last question
  };

  [[nodiscard]] std::vector<OperationRange> gaps(AuthorId author) const;

  const OperationLogs& logs_;
  const MemberLogs& members_;
  ExchangeTiming& timing_;
  std::map<AuthorId, Missing> missing_;
  RangeHistory asked_;
  std::uint64_t suppressed_ = 0;
};

}  // namespace peerd::replication
