#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/edits/log/exchange_timing.hpp"
#include "replication/edits/log/member_logs.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/log/operation_requests.hpp"
#include "replication/edits/log/operation_sender.hpp"
#include "replication/settings/policy/rare_branches.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// An OperationMessage goes into one datagram to all: parts, or ranges that are asked for. It fits beside the header.
struct OperationMessage {
  std::vector<OperationPart> operations;
  std::vector<OperationRange> operation_requests;
};

// The exchange of logs with the other members, by multicast: new operations go out at once; hellos say how long the
// logs are; whoever lacks something asks for it, and any holder answers. It sends nothing where nobody lacks anything.
//
// Times are those of this host, and do not descend. A part goes to the logs first, then here.
class OperationExchange {
 public:
  // How many bytes go out: a token bucket. More waits.
  struct Rate {
    double bytes_per_s = 2e6;
    double burst_bytes = 64.0 * 1024.0;
  };
  // A link is worth at most so many copies of a new operation.
  static constexpr std::uint32_t kCopiesMax = 4;

  // The logs outlive this. `own`: the author of the operations of this peer. `seed`: of the random waiting times.
  OperationExchange(const OperationLogs& logs, PeerId self, AuthorId own, std::uint64_t seed, Rate rate,
                    RareBranches rare = {});
  OperationExchange(const OperationLogs& logs, PeerId self, AuthorId own, std::uint64_t seed)
      : OperationExchange(logs, self, own, seed, Rate{}) {}

  // Sets what is known of the links: the delay until others have what this peer sends and act on it, ticks included,
  // and the worst loss on the way to one of them.
  void set_link(Duration delay, double loss);

  void on_joined(PeerId peer);  // a member that is new or begins anew
  void on_lost(PeerId peer);
  // The logs have taken an operation of this peer.
  void on_append(HostTime now, OperationId id);
  // A member's hello says how long its logs are. Call this for hellos without logs, too.
  void on_lengths(HostTime now, PeerId from, std::span<const LogLength> logs);
  void on_requests(HostTime now, PeerId from, std::span<const OperationRange> ranges);
  // A member has sent a part. The logs have taken it, or refused it.
  void on_part(HostTime now, PeerId from, const OperationPart& part);

  // The messages that are due now, each for one datagram. They may be fewer than are due, as the rate allows.
  [[nodiscard]] std::vector<OperationMessage> on_tick(HostTime now);
  [[nodiscard]] std::optional<HostTime> next_deadline() const;

  // The own operations of which another member has been found to hold all since the last call, ascending.
  [[nodiscard]] std::vector<OperationId> newly_held();

  // The lengths for a hello with room for so many bytes (the header of the list included): those that have changed
  // since the last hello, and the others in turns.
  [[nodiscard]] std::vector<LogLength> lengths_for_hello(std::size_t room_bytes);
  // Whether a length has changed since the last hello.
  [[nodiscard]] bool has_news() const { return has_news_; }

  struct Counters {
    std::uint64_t messages_out = 0, parts_out = 0, part_bytes_out = 0, ranges_requested = 0;
    std::uint64_t requests_suppressed = 0, answers_cancelled = 0, answers_dropped = 0;
  };
  [[nodiscard]] Counters counters() const;

 private:
  struct Unheld {
    OperationId id;
    std::uint64_t end = 0;  // of the operation in the log
  };

  void refill(HostTime now);
  void spend(const OperationMessage& message);
  void note_held(std::uint64_t length);

  const OperationLogs& logs_;
  AuthorId own_;
  Rate rate_;
  RareBranches rare_;
  double loss_ = 0.0;
  ExchangeTiming timing_;
  MemberLogs members_;
  OperationRequests requests_;
  OperationSender sender_;
  double tokens_;
  std::optional<HostTime> filled_;
  std::uint64_t own_length_ = 0;  // of what on_append() has seen
  std::deque<Unheld> unheld_;
  std::vector<OperationId> newly_held_;
  std::map<AuthorId, std::uint64_t> published_;  // by hellos
  std::optional<AuthorId> last_published_;
  bool has_news_ = false;
  Counters counters_;
};

}  // namespace peerd::replication
