#pragma once
#include <cstdint>
#include <optional>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/session/clock_reach.hpp"
#include "replication/session/member_limits.hpp"
#include "replication/session/membership.hpp"
#include "replication/session/session_clock.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::replication {

// Session time as this peer has it, and the peer that it takes it from.
class SessionTime {
 public:
  // After a longer gap between two calls this peer was stopped, or its computer asleep. What would have happened
  // meanwhile is not made up: for all others its objects stood still.
  static constexpr Duration kSuspendedAfter = std::chrono::seconds(4);

  // All arguments outlive this object.
  SessionTime(const PeerConfig& config, Membership& members, Outbox& outbox, PeerCounters& counters,
              MemberLimits& limits);

  [[nodiscard]] const SessionClock& clock() const { return clock_; }
  // The peer whose session time this one takes over; itself: it leads. None: nobody's yet.
  [[nodiscard]] std::optional<PeerId> follows() const { return follows_; }
  [[nodiscard]] const std::optional<OsClock>& os_clock() const { return os_clock_; }
  // How far ahead of where it is, and how far behind, other members may move session time from now on.
  [[nodiscard]] OffsetBounds reach(HostTime now) const;
  [[nodiscard]] std::optional<HostTime> started() const { return started_; }

  // The session that this peer founds begins behind that time, where its host's clock is not there yet: operations that
  // it has from an earlier session took effect by then.
  void begin_behind(SimTime last) { behind_ = last; }
  // The first tick: this peer listens from now on. False where it has started before.
  bool start(HostTime now);

  // The caller calls it first whenever time arrives. Where it was not called for long, this host was suspended, or its
  // clock has jumped; which of them, and how much time has really passed, only the other peers know. So session time
  // continues from where it was, and this peer publishes no time until it has received theirs: a peer that led would
  // otherwise lead all peers into the wrong one. Where no other peer is left, it founds again. Returns the gap; none:
  // there was none, or no peer to be out of step with. `in_session`: this peer has a world.
  [[nodiscard]] std::optional<Duration> check_suspension(HostTime now, bool in_session);

  // A peer has been received that has not introduced itself, and may have a session.
  void on_unintroduced_peer(HostTime now) { unintroduced_peer_at_ = now; }
  // The statement of the operating system on its clock at `now`; none: it does not know how right it is.
  void on_os_clock(HostTime now, std::optional<OsClock> clock);
  // The time stamps of a hello. `exchange`: when this peer's hello that it echoes left and arrived; none: it echoes
  // none that is known.
  void on_stamps(HostTime now, Member& member, const Hello& hello, const std::optional<OffsetInterval::Echo>& exchange);

  // True when this peer has founded a session, or goes on with one in which nobody else is left.
  [[nodiscard]] bool found_session(HostTime now);
  // Follows the right peer. `sender`: the peer whose hello has just come. True when this peer has session time for the
  // first time since it had a world, that is, when it has to enter the session.
  [[nodiscard]] bool follow_leader(HostTime now, std::optional<PeerId> sender, bool in_session);
  // The followed peer has gone.
  [[nodiscard]] bool has_lost_leader() const;

  // A step of session time, forward: into another session, or, after a suspension, to where the same one had got.
  struct Step {
    Duration by;
    bool same_session;
  };
  // The caller calls it at every tick.
  [[nodiscard]] std::optional<Step> adjust(HostTime now);

  // Writes this peer's session time and its errors into a hello.
  void stamp(Hello& hello, HostTime now) const;

 private:
  [[nodiscard]] bool may_respond(HostTime now, const Member& member) const;
  [[nodiscard]] std::optional<OsClockNote> os_clock_note(HostTime now) const;
  [[nodiscard]] std::optional<OffsetBounds> os_bounds(HostTime now, const Member& member) const;
  [[nodiscard]] SessionClock::Estimate estimate(HostTime now, PeerId peer);
  [[nodiscard]] SessionClock::Estimate estimate_by_stamps(HostTime now, PeerId peer);
  enum class Session : std::uint8_t { kUnknown, kEarlier, kSame, kLater };
  [[nodiscard]] Session session_of(HostTime now, const Member& member, Duration own_error) const;
  // The operating system's clock minus the host's, where it knows how right it is.
  [[nodiscard]] std::optional<Duration> os_minus_host(HostTime now) const;
  // Whether no more than those bounds is known to speak against following the member.
  [[nodiscard]] bool is_within(HostTime now, const Member& member, const OffsetBounds& reach) const;
  [[nodiscard]] std::optional<PeerId> choose_first_leader(HostTime now) const;
  [[nodiscard]] std::optional<PeerId> choose_leader(HostTime now);
  [[nodiscard]] bool awaits_lower_leader(HostTime now, Duration own_error) const;
  void name_if_too_far_ahead(HostTime now, PeerId sender);

  const PeerConfig& config_;
  Membership& members_;
  Outbox& outbox_;
  PeerCounters& counters_;
  MemberLimits& limits_;
  SessionClock clock_;
  ClockReach reach_;
  std::optional<PeerId> follows_;
  std::optional<HostTime> started_;
  HostTime listening_since_{};  // since the start, or since this host was suspended
  std::optional<HostTime> called_at_;
  SimTime behind_ = SimTime::min();
  bool was_suspended_ = false;  // since it had session time last
  std::optional<HostTime> unintroduced_peer_at_;
  std::optional<OsClock> os_clock_;
  HostTime os_clock_at_{};
};

}  // namespace peerd::replication
