#pragma once
#include <optional>

#include "core/time.hpp"
#include "replication/session/offset_interval.hpp"

namespace peerd::replication {

// How far other members may move the session time of this peer, whatever they say: the bounds of session time minus
// host time within which it follows anybody. A single member that says a false time moves nobody farther, nor do many.
//
// A peer that shares its time with nobody has nothing to lose, and its own clock may be the one that is wrong: it
// follows any session that is less than a year ahead, and any at all where its own clock is surely wrong. Who shares
// its time with others, or knows from its operating system how right its clock is, follows a session that is no more
// than `ahead_max` ahead of what it knows by itself: of its time as it was when it entered, carried on by its host's
// clock, and of the operating system's. Both are its own, so the bound holds however often and in how small steps
// others move it.
//
// Some peers of one session may go a little farther than the others, where a member says a time that is just at
// the bound. The bound widens as clocks may drift, and then the others go there, too.
class ClockReach {
 public:
  // After the last sign of a peer that shares its time, this one counts as alone no sooner.
  static constexpr Duration kCompanyLasts = std::chrono::minutes(1);
  // Session time begins behind the store's stamps where these are ahead by less (SessionTime::begin_behind): a session
  // that went so far ahead goes on after a restart as it was.
  static constexpr Duration kFreeAhead = std::chrono::hours(24 * 366);
  // 2026-01-01: no computer that runs this program has a clock that is right and shows less.
  static constexpr Duration kClockSurelyWrongBefore = std::chrono::seconds(1'767'225'600);

  // `ahead_max` > 0: the same at all peers of a session.
  explicit ClockReach(Duration ahead_max);

  // This peer's session time is of its own choice from now on: it has founded a session, or entered one as a newcomer.
  void enter(HostTime now, Duration session_minus_host);
  [[nodiscard]] bool has_entered() const { return home_.has_value(); }
  // A member shares this peer's time.
  void on_company(HostTime now) { company_at_ = now; }
  // The host's clock went on by `gap` while session time may have stood still.
  void on_gap(Duration gap);

  // `os_minus_host`: the operating system's clock minus the host's, where it knows how right it is.
  [[nodiscard]] OffsetBounds at(HostTime now, std::optional<Duration> os_minus_host) const;
  // The bounds of a newcomer's first choice: of two sessions it prefers one that is not far ahead.
  [[nodiscard]] OffsetBounds preferred(HostTime now, std::optional<Duration> os_minus_host) const;
  // Whether this peer is free to enter another session as a newcomer does.
  [[nodiscard]] bool is_free(HostTime now, bool knows_os_clock) const;

 private:
  struct Home {
    OffsetBounds offsets;
    HostTime at;
  };

  Duration ahead_max_;
  std::optional<Home> home_;
  std::optional<HostTime> company_at_;
};

}  // namespace peerd::replication
