#include "replication/session/member_limits.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

// So many members, each with a few limits, are as many as may be (admission.cpp). Idle states are forgotten whenever
// there are twice as many as were left last time, within these bounds.
constexpr std::size_t kStatesMax = 4 * 4096, kStatesLeast = 256;

// The use of a bucket after so long.
double drained(double used, Duration since, const LimitRate& rate) {
  assert(since >= Duration{0});
  return std::max(0.0, used - rate.per_s * to_seconds(since));
}

}  // namespace

std::optional<LimitRate> rate_of(MemberLimit limit) {
  switch (limit) {
    case MemberLimit::kDatagrams:
      return LimitRate{20e3, 40e3};
    case MemberLimit::kDecisions:
      return LimitRate{4e3, 16e3};
    case MemberLimit::kClaims:
      return LimitRate{100.0, 20e3};
    case MemberLimit::kOperations:
      return LimitRate{8e6, 16e6};
    case MemberLimit::kRequests:
      return LimitRate{4e3, 16e3};
    case MemberLimit::kSubscriptions:
      return LimitRate{2e3, 20e3};
    case MemberLimit::kResends:
      return LimitRate{1.0, 20.0};
    case MemberLimit::kRestarts:
      return LimitRate{0.5, 30.0};
    case MemberLimit::kClockAhead:
    case MemberLimit::kStampAhead:
    case MemberLimit::kOperationAhead:
    case MemberLimit::kDecisionImpossible:
    case MemberLimit::kDecisionElsewhere:
    case MemberLimit::kLogLength:
    case MemberLimit::kAuthors:
      break;
  }
  return std::nullopt;
}

MemberLimits::MemberLimits(Membership& members, Outbox& outbox, PeerCounters& counters)
    : members_(members), outbox_(outbox), counters_(counters), prune_at_(kStatesLeast) {}

// Forgets the states of peers that are no members, have used up nothing, and were not named lately.
void MemberLimits::forget_idle(HostTime now) {
  std::erase_if(states_, [&](const auto& each) {
    const auto& [key, state] = each;
    if (members_.all().contains(key.first)) return false;
    if (state.named_at && now - *state.named_at < kNamedApart) return false;
    const auto rate = rate_of(key.second);
    return !rate || drained(state.used, now - state.used_at, *rate) == 0.0;
  });
}

MemberLimits::State& MemberLimits::state(HostTime now, PeerId peer, MemberLimit limit) {
  if (states_.size() >= prune_at_ && !states_.contains({peer, limit})) {
    forget_idle(now);
    prune_at_ = std::clamp(2 * states_.size(), kStatesLeast, kStatesMax);
  }
  const auto [at, is_new] = states_.try_emplace({peer, limit});
  if (is_new) at->second.used_at = now;
  return at->second;
}

bool MemberLimits::take(HostTime now, PeerId sender, MemberLimit limit, double amount) {
  assert(amount >= 0.0);
  const auto rate = rate_of(limit);
  assert(rate && "it has a rate");
  State& s = state(now, sender, limit);
  s.used = drained(s.used, now - s.used_at, *rate);
  s.used_at = now;
  const double taken = std::min(amount, rate->burst);
  if (s.used + taken > rate->burst) {
    refuse(now, sender, limit);
    return false;
  }
  s.used += taken;
  return true;
}

void MemberLimits::refuse(HostTime now, PeerId sender, MemberLimit limit) {
  const char* const reason = to_string(limit);
  ++counters_.drops[reason];
  if (Member* const member = members_.find(sender)) ++member->drops[reason];
  State& s = state(now, sender, limit);
  ++s.unnamed;
  if (s.named_at && now - *s.named_at < kNamedApart) return;
  s.named_at = now;
  outbox_.push(LimitMet{sender, limit, std::exchange(s.unnamed, 0)});
}

}  // namespace peerd::replication
