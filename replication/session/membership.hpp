#pragma once
#include <cstddef>
#include <cstdint>
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
#include "replication/wire/loss_meter.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// One other peer, as far as its datagrams are received.
struct Member {
  std::uint64_t incarnation = 0;
  HostTime since{};  // the first datagram of that incarnation
  std::string name;
  HostTime last_received{};  // on this host's clock
  std::uint64_t datagrams_in = 0, bytes_in = 0;
  std::map<std::string, std::uint64_t> drops;  // its records that were dropped, by reason
  std::uint32_t hello = 0;                     // the number of its last hello's datagram; 0: none
  HostTime hello_rx{};                         // arrival of that hello, on this host's clock
  bool awaits_our_decision = false;            // it defers a contact that this peer may be the one to decide
  bool synchronised = false;
  OffsetInterval clock;                 // its session time minus this host's clock
  bool leads = false;                   // it says that it leads the session's time
  Duration clock_error{0};              // the greatest distance of its time from the leader's, where it does not lead
  std::optional<OsClockNote> os_clock;  // as of hello_rx
  bool os_clock_doubted = false;        // its OS clock and this host's contradict the hellos' stamps
  std::uint32_t sessions = 0;
  std::optional<SimTime> start;
  std::map<RegionId, LossMeter> received;  // its datagrams, which are numbered by region
  EchoState echo;
  DelayMeter delays;
  Duration latency{0};  // the latency that it publishes: how late it receives others
  std::optional<Viewpoint> viewpoint;
  std::unordered_map<ObjectId, std::uint32_t> last_sequence;  // of the updates that were applied
  bool has_scene_states = false;    // by its last hello's digest, which may differ from this peer's
  std::uint32_t scene_differs = 0;  // its last hellos in a row whose digest of the scene's states differs

  // The loss of its datagrams in all regions together.
  [[nodiscard]] LossMeter received_in_all() const;
};

// The other peers that are here. Silence makes a peer lost, a higher incarnation makes it a new one.
class Membership {
 public:
  enum class Admission : std::uint8_t { kKnown, kJoined, kRestarted, kStale };

  explicit Membership(Duration lost_after) : lost_after_(lost_after) {}

  // Any datagram of a peer. kStale: it belongs to an earlier incarnation of that peer and must be dropped.
  Admission on_datagram(HostTime now, PeerId peer, std::uint64_t incarnation);
  // Removes the peers that have been silent for longer than lost_after and returns them, ascending.
  [[nodiscard]] std::vector<std::pair<PeerId, Member>> expire(HostTime now);
  std::optional<Member> remove(PeerId peer);
  // Counts the silence of all members anew from now on.
  void restart_silence_of_all(HostTime now);
  // Forgets how other clocks compare with this host's, which has jumped.
  void forget_clocks();

  [[nodiscard]] Member* find(PeerId peer);
  [[nodiscard]] const std::map<PeerId, Member>& all() const { return members_; }
  [[nodiscard]] bool contains(PeerId peer) const { return members_.contains(peer); }
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
  Duration lost_after_;
  std::map<PeerId, Member> members_;  // ordered: output must not depend on hashing
};

}  // namespace peerd::replication
