#include "replication/settings/output/peer_counters.hpp"

namespace peerd::replication {

const char* to_string(Drop drop) {
  switch (drop) {
    case Drop::kOwn:
      return "own";
    case Drop::kUndecodable:
      return "undecodable";
    case Drop::kIdInUse:
      return "id_in_use";
    case Drop::kStaleIncarnation:
      return "stale_boot";
    case Drop::kOtherWorld:
      return "other_world";
    case Drop::kOtherLine:
      return "other_line";
    case Drop::kTooMany:
      return "too_many";
    case Drop::kUnintroduced:
      return "stranger";
    case Drop::kIdentityCheck:
      return "identity_check";
    case Drop::kRegion:
      return "region";
    case Drop::kMemberLimit:
      return "member_limit";
    case Drop::kNotYetInSession:
      return "not_yet_in_session";
  }
  return "?";
}

const char* to_string(MemberLimit limit) {
  switch (limit) {
    case MemberLimit::kClockAhead:
      return "clock_ahead";
    case MemberLimit::kStampAhead:
      return "stamp_ahead";
    case MemberLimit::kOperationAhead:
      return "operation_ahead";
    case MemberLimit::kDecisionImpossible:
      return "decision_impossible";
    case MemberLimit::kDecisionElsewhere:
      return "decision_elsewhere";
    case MemberLimit::kDatagrams:
      return "datagram_rate";
    case MemberLimit::kDecisions:
      return "decision_rate";
    case MemberLimit::kClaims:
      return "claim_rate";
    case MemberLimit::kOperations:
      return "operation_rate";
    case MemberLimit::kLogLength:
      return "log_too_long";
    case MemberLimit::kAuthors:
      return "too_many_unknown_authors";
    case MemberLimit::kRequests:
      return "request_rate";
    case MemberLimit::kResends:
      return "resend_rate";
    case MemberLimit::kSubscriptions:
      return "subscription_rate";
    case MemberLimit::kRestarts:
      return "restart_rate";
  }
  return "?";
}

const char* to_string(DatagramKind kind) {
  switch (kind) {
    case DatagramKind::kHello:
      return "hello";
    case DatagramKind::kFarHello:
      return "far_hello";
    case DatagramKind::kDecisions:
      return "decisions";
    case DatagramKind::kSubscriptions:
      return "subscriptions";
    case DatagramKind::kSceneStates:
      return "scene_states";
    case DatagramKind::kOperations:
      return "operations";
    case DatagramKind::kHandovers:
      return "handovers";
    case DatagramKind::kUpdates:
      return "updates";
    case DatagramKind::kKeepalive:
      return "keepalive";
  }
  return "?";
}

}  // namespace peerd::replication
