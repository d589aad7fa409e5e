#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/peer/peer_parts.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Scene objects that contacts have moved: what this peer lets go, what others have let go or lost, and that all peers,
// also those that come later, know where these are.
class SceneKeeper {
 public:
  explicit SceneKeeper(PeerParts& parts) : p_(parts) {}

  // At the tick at t, to which both worlds have been advanced: lets go of what rests, and takes back what ghosts have
  // predicted and nobody has decided.
  void maintain(SimTime t);
  // The owner is gone: the object goes on as all peers predict it from its last update.
  void orphan(ObjectId object, SimTime t);
  // An update of the sender says that the object is its own: false where this peer knows better.
  [[nodiscard]] bool take_over(PeerId sender, const UpdateRecord& update);

  // For a hello that leaves at that session time.
  [[nodiscard]] std::uint64_t digest(SimTime session_tx) const;
  // A hello of a member of the session has come.
  void on_digest(Member& member, const Hello& hello);
  void on_states(PeerId sender, const SceneStates& scene);
  // With each hello: ends loans of which their owners know nothing, and sends the states to peers that do not have
  // them.
  void offer(HostTime now);

 private:
  void let_go_of_resting(SimTime t);
  void reset_ghosts(SimTime t);
  void send_copies();
  std::size_t send(std::span<const UpdateRecord> states);
  void let_go(const UpdateRecord& state);
  void end_unconfirmed_loans(SimTime t);

  PeerParts& p_;
  std::optional<HostTime> offered_at_;
  std::size_t next_offered_ = 0;  // the states that go next, where one turn does not take all
};

}  // namespace peerd::replication
