#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"

namespace peerd::replication {

// A limit of a member's as a bucket that holds `burst` and fills at `per_s`.
struct LimitRate {
  double per_s = 0.0, burst = 0.0;
};
// The rate of a limit; none: nothing of the kind is allowed. At least four times what honest peers have been measured
// to do at their busiest (docs/measurements/security.md).
[[nodiscard]] std::optional<LimitRate> rate_of(MemberLimit limit);

// The limits of what one member can do to the others: what goes beyond is counted by its reason, for the
// member and in all, and named once a minute (LimitMet). What a member has used up outlives its restarts.
class MemberLimits {
 public:
  // A member and a limit are named no more often.
  static constexpr Duration kNamedApart = std::chrono::minutes(1);
  // The greatest length of one author's log, and the most bytes of logs that a peer takes from others. A log that is
  // cut at a length is cut alike by all, so that all hold the same of it.
  static constexpr std::uint64_t kLogMax_bytes = std::uint64_t{256} << 20, kLogsMax_bytes = std::uint64_t{2} << 30;

  // All arguments outlive this object.
  MemberLimits(Membership& members, Outbox& outbox, PeerCounters& counters);

  // The sender uses up so much of a limit that has a rate. False: it has not so much left, which is counted as refused.
  // An amount that is larger than the bucket takes a full one.
  [[nodiscard]] bool take(HostTime now, PeerId sender, MemberLimit limit, double amount = 1.0);
  // The sender has gone beyond the limit.
  void refuse(HostTime now, PeerId sender, MemberLimit limit);

  // How many pairs of a peer and a limit are remembered.
  [[nodiscard]] std::size_t states() const { return states_.size(); }

 private:
  struct State {
    double used = 0.0;  // of the bucket, at used_at
    HostTime used_at{};
    std::uint64_t unnamed = 0;
    std::optional<HostTime> named_at;
  };

  [[nodiscard]] State& state(HostTime now, PeerId peer, MemberLimit limit);
  void forget_idle(HostTime now);

  Membership& members_;
  Outbox& outbox_;
  PeerCounters& counters_;
  std::map<std::pair<PeerId, MemberLimit>, State> states_;
  std::size_t prune_at_;  // the number of states at which idle ones are forgotten next
};

}  // namespace peerd::replication
