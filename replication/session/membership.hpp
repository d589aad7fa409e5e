#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/session/delay_meter.hpp"
#include "replication/session/echo_state.hpp"
#include "replication/session/offset_interval.hpp"
#include "replication/settings/grid/region_grid.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/loss_meter.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The last hello that a peer has sent to all of a large session. The peer that leads echoes it.
struct FarHello {
  std::uint32_t number = 0;  // 0: none
  HostTime rx{};
  std::uint32_t echoed = 0;  // the last number that has been echoed; 0: none
  HostTime echoed_at{};

  void receive(std::uint32_t its_number, HostTime now) {
    rx = now;
    if (its_number != 0) number = its_number;  // 0 is not counted, and nobody can echo it
  }
};

// All that is known of a far peer, and of a member besides much else.
struct OtherPeer {
  std::uint64_t incarnation = 0;
  HostTime since{};  // the first datagram of that incarnation
  std::string name;
  bool synchronised = false;     // it has session time
  std::uint32_t sessions = 0;    // as its hellos say
  std::optional<SimTime> start;  // the start that it announces
  FarHello far_hello;
  bool promises_hellos = false;  // its last hello to all has said when the next one comes
  HostTime expected_until{};     // its next far hello comes by then, unless several are lost
};

// A peer of a large session that is not near: nothing is known of it but that it is here, and what it owns.
struct FarPeer : OtherPeer {
  std::vector<ObjectId> owned;  // by its introductions, ascending
};

// The most other peers that are kept, near and far: there are no more on one network, unless a forger invents them.
inline constexpr std::size_t kMembersMax = 4096;

// A far peer is lost when so many of its hellos have not come in the time that they were promised for, and would not
// have been promised for by now, since more peers may have come.
inline constexpr int kFarHellosMissed = 2;

// One other peer, as far as its datagrams are received.
struct Member : OtherPeer {
  HostTime last_received{};  // on this host's clock
  std::uint64_t datagrams_in = 0, bytes_in = 0;
  std::map<std::string, std::uint64_t> drops;  // its records that were dropped, by reason
  std::uint32_t hello = 0;                     // the number of its last hello's datagram; 0: none
  HostTime hello_rx{};                         // arrival of that hello, on this host's clock
  bool awaits_our_decision = false;            // it defers a contact that this peer may be the one to decide
  OffsetInterval clock;                        // its session time minus this host's clock
  bool leads = false;                          // it says that it leads the session's time
  Duration clock_error{0};              // the greatest distance of its time from the leader's, where it does not lead
  std::optional<OsClockNote> os_clock;  // as of hello_rx
  bool os_clock_doubted = false;        // its OS clock and this host's contradict the hellos' stamps
  std::map<RegionId, LossMeter> received;  // its datagrams, which are numbered by region
  EchoState echo;
  DelayMeter delays;
  Duration latency{0};  // the latency that it publishes: how late it receives others
  std::optional<Viewpoint> viewpoint;
  std::unordered_map<ObjectId, std::uint32_t> last_sequence;     // of the updates that were applied
  std::uint64_t ghosts_differ = 0, ghosts_differ_explained = 0;  // own objects of the member (GhostCheck)
  bool has_scene_states = false;    // by its last hello's digest, which may differ from this peer's
  std::uint32_t scene_differs = 0;  // its last hellos in a row whose digest of the scene's states differs
  // In a large session:
  bool is_near = true;  // else it is a member because it leads, led, or may lead next, and only its far hellos come
  RegionId channel = kWholeScene;    // the region by which its last datagram is numbered: kNearby where it was `nearby`
  RegionId echoes_on = kWholeScene;  // the region by which the datagrams are numbered that its last echo acknowledges
  HostTime echoing{};                // its last far hello that echoed anybody; else when it became a member

  // Which of its datagrams that count there have come; null: none.
  [[nodiscard]] const LossMeter* received_on(RegionId numbered_by) const {
    const auto at = received.find(numbered_by);
    return at == received.end() ? nullptr : &at->second;
  }

  // Its last datagram, of that number, is not acknowledged: it comes again.
  void mark_as_missing(std::uint32_t number) { received[channel].mark_as_missing(number); }

  // The loss of its datagrams in all regions together.
  [[nodiscard]] LossMeter received_in_all() const;
};

// The other peers that are here. Silence makes a peer lost, a higher incarnation makes it a new one.
//
// In a large session (LargeSession) the members are those that are near, and the peer that leads; of the others only
// FarPeer is known. A far peer of which anything but a far hello arrives is near from then on, and a member that falls
// silent is far as long as its far hellos come.
class Membership {
 public:
  // kNear: a far peer, of the same incarnation, is a member from now on. kFar: it is, or remains, no member.
  enum class Admission : std::uint8_t { kKnown, kJoined, kRestarted, kStale, kNear, kFar };

  explicit Membership(Duration lost_after, LargeSession large = {}) : lost_after_(lost_after), large_(large) {}

  // Any datagram of a peer. kStale: it belongs to an earlier incarnation of that peer and must be dropped.
  Admission on_datagram(HostTime now, PeerId peer, std::uint64_t incarnation);
  // Removes the peers that have been silent for longer than lost_after and returns them, ascending. Those whose far
  // hellos are still expected, for one or a `nearby` datagram has come, are far from now on, and are appended to `far`;
  // they are lost where `is_due` says that this peer would hear them. `followed`, the leader, remains, and so does the
  // peer that may lead next.
  [[nodiscard]] std::vector<std::pair<PeerId, Member>> expire(HostTime now,
                                                              const std::function<bool(PeerId)>& is_due = {},
                                                              std::optional<PeerId> followed = std::nullopt,
                                                              std::vector<PeerId>* far = nullptr);
  std::optional<Member> remove(PeerId peer);
  // Counts the silence of all members anew from now on.
  void restart_silence_of_all(HostTime now);
  // Forgets how other clocks compare with this host's, which has jumped.
  void forget_clocks();

  [[nodiscard]] Member* find(PeerId peer);
  [[nodiscard]] const std::map<PeerId, Member>& all() const { return members_; }
  // Whether the peer is here, near or far.
  [[nodiscard]] bool contains(PeerId peer) const { return members_.contains(peer) || far_.contains(peer); }

  [[nodiscard]] const std::map<PeerId, FarPeer>& far() const { return far_; }
  [[nodiscard]] FarPeer* find_far(PeerId peer);
  [[nodiscard]] std::size_t count() const { return members_.size() + far_.size(); }
  // A far peer of that incarnation is here from now on, or goes on to be. Returns it, and whether it is new.
  std::pair<FarPeer*, bool> note_far(HostTime now, PeerId peer, std::uint64_t incarnation);
  std::optional<FarPeer> remove_far(PeerId peer);
  // The far peer that has introduced itself as the object's owner; kNobody: none has.
  [[nodiscard]] PeerId far_owner(ObjectId object) const;
  // The peer, near or far; null: it is not here.
  [[nodiscard]] const OtherPeer* find_any(PeerId peer) const;
  // Calls `function` with each peer, near or far.
  void for_each(const std::function<void(PeerId, OtherPeer&)>& function);
  // The start that the lowest of those that know one announces; none: nobody does.
  [[nodiscard]] std::optional<SimTime> announced_start() const;
  // Whether a peer says hello that has no session time yet.
  [[nodiscard]] bool has_joining(HostTime now) const;
  // The far peer is a member from now on. `is_near`: else because it leads.
  Member& promote(HostTime now, PeerId peer, bool is_near);
  // The lowest of all other peers that have session time; none: nobody has.
  [[nodiscard]] std::optional<PeerId> lowest() const;
  // Removes far peers of which several hellos have not come (kFarHellosMissed) and returns them. It looks once a second
  // at most.
  [[nodiscard]] std::vector<std::pair<PeerId, FarPeer>> expire_far(HostTime now);

  // The interval at which each peer says a far hello, on average, so that all together say LargeSession::hellos_per_s.
  [[nodiscard]] Duration mean_far_interval() const;
  // How long after a far hello its sender is lost at the earliest, by how many peers are here.
  [[nodiscard]] Duration far_patience() const;

  // Whether the session is large, by how many peers are here; it remains so until a quarter less are, and is so from
  // there on where others take it for large. `may_be`: this peer is in the session, whose scene is cut into regions.
  // True where that has changed.
  bool follow_size(bool may_be);
  [[nodiscard]] bool is_large() const { return is_large_; }
  // The numbers by which datagrams for all count, and are acknowledged.
  [[nodiscard]] RegionId channel() const { return is_large_ ? kNearby : kWholeScene; }
  [[nodiscard]] std::optional<HostTime> next_expiry() const;

  // The mean loss of all members' datagrams on their way here.
  [[nodiscard]] double mean_loss() const;
  // The worst loss of this peer's datagrams that any reachable member reports. 0 without members.
  [[nodiscard]] double worst_loss_to_peers() const;
  // Counts a region's datagrams anew: what was sent while this peer did not listen to it was not lost.
  void reset_loss_of(RegionId region);

  // The latency with which this peer receives others, as it publishes it; at most kLatencyMax.
  [[nodiscard]] Duration own_latency() const;
  // The longest latency that any peer of the session publishes, this one included.
  [[nodiscard]] Duration longest_latency() const;
  // The longest mean delay of any member.
  [[nodiscard]] Duration longest_mean_delay() const;
  // The number of hellos in which a peer names all others, >= 1.
  [[nodiscard]] std::size_t hellos_in_a_turn() const { return hellos_to_name(members_.size()); }
  // The time within which a member's hello says whether a datagram that is sent now has come there, if neither is lost.
  [[nodiscard]] Duration acknowledged_within(Duration hello_period) const {
    return 2 * longest_latency() + static_cast<std::int64_t>(hellos_in_a_turn()) * hello_period;
  }

 private:
  // The lowest peer, near or far, that is so; its pointer is null where there is none.
  [[nodiscard]] std::pair<PeerId, const OtherPeer*> lowest_that(
      const std::function<bool(const OtherPeer&)>& is_so) const;
  // Until when the next far hello is waited for.
  [[nodiscard]] HostTime far_hello_until(const OtherPeer& peer) const;
  [[nodiscard]] HostTime far_hello_until(const Member& member) const;

  Duration lost_after_;
  LargeSession large_;
  std::map<PeerId, Member> members_;  // ordered: output must not depend on hashing
  std::map<PeerId, FarPeer> far_;     // nobody who is a member
  bool is_large_ = false;
  HostTime far_checked_at_{};
};

}  // namespace peerd::replication
