#pragma once
#include <optional>
#include <span>
#include <string>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/peer_parts.hpp"

namespace peerd::replication {

// What concerns all parts of a peer at once: entering a session, stepping into another one, and changes of who is here
// and who owns what.
class SessionKeeper {
 public:
  explicit SessionKeeper(PeerParts& parts) : p_(parts) {}

  // To be called first whenever time arrives. True where this host was suspended: no time of before this call means
  // anything.
  bool check_suspension(HostTime now);
  // At every call of on_tick: silent peers, the session's founding, the clock. False when everything begins anew at this
  // instant, and a tick that was due is not.
  [[nodiscard]] bool maintain(HostTime now);
  // The hello of a peer has come, whose time stamps are known by now: follows whom it has to.
  void follow_leader(HostTime now, std::optional<PeerId> sender);

  // A peer says that it owns these. Nobody owns an object that somebody else owns already; of two that both say so the
  // lower id is believed.
  void claim(PeerId peer, std::span<const ObjectId> objects);
  // A peer has gone.
  void lose(PeerId peer, const std::string& name, HostTime now, bool left_gracefully);
  // A peer has gone, or begins anew: what it owned stands still from now on and belongs to nobody.
  void orphan_objects_of(PeerId peer, HostTime now);
  // An own introduction has changed.
  void reintroduce() { p_.greeter.reintroduce(p_.own.size()); }

 private:
  void enter_session(HostTime now);
  void move_to_session_time(SimTime before, SimTime now);
  void begin_worlds(SimTime now);
  void declare_all();
  void watch_all_pairs();
  void watch_pairs_around(std::span<const ObjectId> objects);

  PeerParts& p_;
};

}  // namespace peerd::replication
