#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Decides when this peer says hello, and which entries of its lists are in a hello: echoes of the peers that it
// receives, and from time to time an introduction. Lists that are too long for one datagram take turns.
class Greeter {
 public:
  // `config` and `members` outlive this.
  Greeter(const PeerConfig& config, const Membership& members);

  // ---- when

  // This peer has started.
  void start(HostTime now) { next_hello_ = now; }
  // Something has begun anew: the next hello goes at once, and hellos are frequent for a while.
  void greet_anew(HostTime now);
  // A peer is new here, which measures clocks and loss by hellos: for so long they are not rare.
  void settle_from(HostTime now);
  [[nodiscard]] bool is_settling(HostTime now) const { return now < settling_until_; }
  // A hello is due after the usual period at the latest, because a peer waits for what it says.
  void hurry();
  [[nodiscard]] bool is_due(HostTime now) const { return now >= next_hello_.value(); }
  // A hello has just been sent. `synchronised`: this peer has session time.
  void schedule_next(HostTime now, bool synchronised);
  // Whether nothing has been sent to all for so long that a datagram has to say that this peer is here.
  // `last_number`: of the datagrams to all.
  [[nodiscard]] bool needs_keepalive(HostTime now, std::uint32_t last_number) const;
  void note_sent(HostTime now, std::uint32_t last_number);
  // A keepalive was due, and has gone to whoever it could go to, if anybody.
  void note_kept_alive(HostTime now) { last_sent_at_ = now; }
  // The time at which a hello or a keepalive is due; HostTime::min() before the start.
  [[nodiscard]] HostTime next_deadline() const;

  // The session is large from now on, or no longer: datagrams to others are numbered elsewhere. `last_number`: there.
  void on_size_changed(HostTime now, std::uint32_t last_number);
  // Whether a far hello is due (LargeSession). Their interval grows with the number of peers, so that those of all
  // together stay as many; it is random, and counted anew when it is over, because peers may have come meanwhile (RFC
  // 3550, 6.2 and 6.3). `leads`: this peer leads, and the others take their time from its far hellos.
  [[nodiscard]] bool is_far_due(HostTime now, bool leads);
  // The far hello that goes now: the time within which the next one comes.
  [[nodiscard]] Duration schedule_next_far(HostTime now, bool leads);

  // ---- what

  // This peer has entered a session, or its time has stepped into another one.
  void on_session_entered(std::size_t own_objects);
  [[nodiscard]] std::uint32_t sessions() const { return sessions_; }
  // The introduction has changed, or is not known to all: the next hellos carry it.
  void reintroduce(std::size_t own_objects);
  // A peer has been received that does not introduce itself: it may not know this one.
  void introduce_once() { introductions_due_ = std::max<std::size_t>(introductions_due_, 1); }
  // Whether a peer waits for an introduction: this peer is new here, or has news, or a peer that may receive it does
  // not know it. `synchronised`: this peer has session time.
  [[nodiscard]] bool must_introduce(bool synchronised) const;
  // Adds the echoes. `cuts_regions`: the scene is cut into regions.
  void fill_echoes(Hello& hello, HostTime now, bool cuts_regions);
  // Adds the echoes of a far hello of the peer that leads: of those to all that it has not echoed yet, those who have
  // no session time first. They are echoed from now on.
  static void fill_far_echoes(Hello& hello, HostTime now, Membership& members);
  // Whether the hello that is made now carries an introduction: it has to, or it is its turn.
  [[nodiscard]] bool introduces(bool synchronised) const;
  // The introduction of the hello that is made now. `own`: the objects that this peer owns, ascending.
  [[nodiscard]] Introduction introduction(std::span<const ObjectId> own, std::optional<SimTime> start,
                                          std::optional<SimTime> world_zero);
  // The hello went out as that datagram.
  void on_hello_sent(HostTime now, RegionId channel, std::uint32_t number);
  // The time at which the hello of that datagram went out; none where that is too long ago.
  [[nodiscard]] std::optional<HostTime> sent_at(RegionId channel, std::uint32_t number) const;

  // A peer is lost: it gets no echo until all other peers have been named once without it, so that it knows.
  void on_peer_lost(PeerId peer);

 private:
  [[nodiscard]] Duration far_interval(HostTime now, bool leads) const;

  const PeerConfig& config_;
  const Membership& members_;
  std::optional<HostTime> next_hello_;
  HostTime last_hello_{};
  HostTime settling_until_{};
  HostTime last_sent_at_{};                  // of any datagram to all
  std::uint32_t last_sent_number_ = 0;       // of that datagram
  std::uint32_t sessions_ = 0;               // entered
  std::size_t hellos_ = 0, echo_turns_ = 0;  // sent; the echoes take turns
  std::optional<ObjectId> last_introduced_;  // own objects take turns, too
  std::size_t introductions_due_ = 0;        // with the next hellos
  HostTime last_far_ = HostTime::min();
  bool led_ = false;              // as is_far_due() was told last
  std::uint64_t far_hellos_ = 0;  // sent
  std::size_t far_at_once_ = 0;   // so many more go soon after each other
  struct SentHello {
    RegionId channel;
    std::uint32_t number;
    HostTime at;
  };
  std::deque<SentHello> sent_hellos_;         // of the last kHeldMax
  std::map<PeerId, std::size_t> lost_peers_;  // and the number of hellos that have left each out since it was lost
};

}  // namespace peerd::replication
