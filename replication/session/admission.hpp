#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/session/line_of_descent.hpp"
#include "replication/session/member_limits.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Decides whether a sound message is one for this peer: of another peer, in its present incarnation, with the same
// world and line of descent. A message that does not introduce its sender counts if the sender is known.
class Admission {
 public:
  // Called for a peer that is lost by an admission, after it has been removed.
  using OnLost = std::function<void(PeerId, const OtherPeer&)>;

  // All arguments outlive this object.
  Admission(const PeerConfig& config, Membership& members, Outbox& outbox, MemberLimits& limits);

  // This peer's line of descent, which is another one where a meeting says so.
  [[nodiscard]] std::uint64_t line() const { return line_.line; }
  // This peer holds edits, and is in a session: both decide whose line stays. To be called before admit().
  void follow(bool has_edits, bool in_session);

  // Returns how the sender is known, never kStale, or why the message is dropped. `started`: when this peer was
  // started; none: not yet. `on_lost` is called for a member that turns out to have another world, before that is
  // reported. kFar: the message is of a peer of a large session that is not near, and says nothing but that it is here;
  // a peer that restarts so has been removed, and reported to `on_lost`. `leads`: this peer is the leader, which
  // answers joining peers.
  [[nodiscard]] std::expected<Membership::Admission, Drop> admit(HostTime now, RegionId region, const Message& message,
                                                                 bool leads, std::optional<HostTime> started,
                                                                 const OnLost& on_lost);
  // A member says goodbye, which is its last word in this incarnation: it is removed and returned.
  [[nodiscard]] Member dismiss(PeerId peer);
  // No datagram of that incarnation counts any more.
  void note_departed(PeerId peer, std::uint64_t incarnation);
  // Somebody asks whether a peer is alive, or says so: a question for this one is answered. Returns how the datagram is
  // counted.
  [[nodiscard]] Drop on_identity_check(HostTime now, const Message& message);
  // A datagram of another protocol version.
  void on_other_version(PeerId sender, std::uint32_t version);
  // Whether that peer is known to have another world.
  [[nodiscard]] bool has_other_world(PeerId peer) const { return other_worlds_.contains(peer); }
  // Whether that peer's edits were of another line when it introduced itself last, and nobody gave way.
  [[nodiscard]] bool has_other_line(PeerId peer) const { return other_lines_.contains(peer); }

 private:
  [[nodiscard]] std::expected<Membership::Admission, Drop> admit_far(HostTime now, const Message& message,
                                                                     const OnLost& on_lost);
  [[nodiscard]] std::unexpected<Drop> admit_own(HostTime now, const Message& message, std::optional<HostTime> started);
  [[nodiscard]] std::unexpected<Drop> reject_other_world(const Message& message);
  [[nodiscard]] std::expected<void, Drop> check_line(const Message& message, const OnLost& on_lost);
  [[nodiscard]] std::unexpected<Drop> reject_earlier_life(HostTime now, const Message& message);

  const PeerConfig& config_;
  LineOfDescent line_;
  Membership& members_;
  Outbox& outbox_;
  MemberLimits& limits_;
  std::set<PeerId> other_worlds_;                   // each is reported once
  std::map<PeerId, std::uint64_t> other_lines_;     // each is reported once
  std::set<std::uint32_t> other_versions_;          // each is reported once
  std::map<PeerId, std::uint64_t> departed_peers_;  // the incarnation of each peer that has said goodbye
  std::set<PeerId> ids_in_use_;                     // of two programs; each is reported once
  std::optional<HostTime> answered_at_;
  std::optional<std::uint64_t> rival_;  // the incarnation of another program that was heard last as this peer
  HostTime rival_heard_{};              // first
};

}  // namespace peerd::replication
