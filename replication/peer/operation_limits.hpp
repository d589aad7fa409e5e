#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/session/member_limits.hpp"
#include "replication/session/membership.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The limits of what members may make this peer hold and send of operations. A part that comes too fast is left out,
// and comes again when it is asked for: peers differ in when they have it, and not in what.
class OperationLimits {
 public:
  // The most authors that one member may name of whom nothing has come.
  static constexpr std::size_t kUnknownMax = 16'384;

  // They outlive this object.
  OperationLimits(const OperationLogs& logs, const Membership& members, MemberLimits& limits);

  // Whether the logs may take a part from that sender. What is behind the greatest length of a log nobody takes.
  [[nodiscard]] bool admit(HostTime now, PeerId sender, const OperationPart& part);
  // Returns the lengths that count, of those that a member says: of few authors of whom nothing has come, or it could
  // make this peer ask for any number of logs.
  [[nodiscard]] std::vector<LogLength> admit(HostTime now, PeerId sender, std::span<const LogLength> lengths);
  // Whether the sender may ask for these. False for none.
  [[nodiscard]] bool admit(HostTime now, PeerId sender, std::span<const OperationRange> ranges);
  // Whether the log has room for any operation more.
  [[nodiscard]] bool has_room(AuthorId author) const;
  // An operation has come from that sender: one that is stamped far ahead waits for its time, and is named.
  void note_stamp(HostTime now, PeerId sender, SimTime stamp, SimTime session_now);

 private:
  [[nodiscard]] bool admit_author(HostTime now, PeerId sender, AuthorId author);
  [[nodiscard]] bool is_too_long(const OperationPart& part);

  const OperationLogs& logs_;
  const Membership& members_;
  MemberLimits& limits_;
  std::map<PeerId, std::set<AuthorId>> unknown_;  // the authors that members have named, of whom nothing has come
  std::uint64_t counted_bytes_ = 0;               // of all logs, when they were counted last
  std::uint64_t since_bytes_ = 0;                 // of the parts since then
};

}  // namespace peerd::replication
