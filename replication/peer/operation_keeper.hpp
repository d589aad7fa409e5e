#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/peer/operation_limits.hpp"
#include "replication/peer/peer_parts.hpp"
#include "replication/peer/session_keeper.hpp"
#include "replication/wire/operation.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The operations of this peer and of the others: makes them, exchanges them, and lets each take effect at its stamp.
class OperationKeeper {
 public:
  // It goes on behind what the author's log has, by the parts' configuration.
  OperationKeeper(PeerParts& parts, SessionKeeper& keeper);

  // Makes an operation of this peer, which takes effect once all others have had the time to receive it. The keeper
  // chooses the ids of what it adds, and resolves the names of its text. The error says why it cannot be.
  [[nodiscard]] std::expected<OperationId, std::string> edit(HostTime now, OperationBody body);

  // Undoes or redoes this author's last edit (LivingScene::next_undo()).
  [[nodiscard]] std::expected<UndoneEdit, std::string> undo(HostTime now, bool redoes);
  // Gives the object to a peer, or to nobody.
  [[nodiscard]] std::expected<OperationId, std::string> give(HostTime now, ObjectId object, PeerId to);
  // Takes the object where it is nobody's or its owner is not here; else asks its owner for it.
  [[nodiscard]] std::expected<Taking, std::string> own(HostTime now, ObjectId object, bool steals);

  // Some writers may do more than they might (LogSigner::writer()).
  void follow_writers() { p_.living.follow_writers(); }
  // A datagram of a member has come.
  void on_message(HostTime now, PeerId sender, const Message& message);
  // Says where objects stand that owners have left behind. The peer of the lowest id that is here does; where regions
  // cut the world, the lowest one that knows.
  void place_left_behind(HostTime now, SimTime t);
  // Lets what takes effect until t do so: both worlds are advanced to each such instant, of which `before_advancing` is
  // told first.
  void apply_until(SimTime t, const std::function<void(SimTime)>& before_advancing);
  // Sends what is due, and says which own operations are held by others.
  void send(HostTime now);
  // The lengths of the logs, as far as they fit into the message, which has a hello.
  void add_lengths(Message& message);

 private:
  // The owner of the object, by operations or else at present.
  [[nodiscard]] PeerId owner_of(ObjectId object) const;
  [[nodiscard]] std::optional<Placement> placement_at(SimTime t, ObjectId object) const;
  [[nodiscard]] std::optional<Placement> placement_of_state(ObjectId object, const KinematicState& state) const;
  [[nodiscard]] std::optional<SetField> place_to_drift_from(HostTime now, const SetField& set) const;
  [[nodiscard]] std::set<ObjectId> going_on(const LeftObjects& left) const;
  void on_request(const Operation& operation, SimTime session_now);
  [[nodiscard]] std::expected<OperationId, std::string> append(HostTime now, LivingScene::Draft draft);
  void publish_data(const LivingScene::Change& change);
  [[nodiscard]] SimTime stamp(HostTime now) const;
  // The exchange goes by how the links are now.
  void follow_link();
  [[nodiscard]] std::uint64_t withhold_far_stamps(AuthorId author, std::uint64_t from);
  void give_withheld();
  // Says that the log has more whole operations than it had.
  void note_growth(AuthorId author, std::uint64_t whole_before);

  PeerParts& p_;
  SessionKeeper& keeper_;
  OperationLimits limits_;
  // The part of a log that the store does not get yet, because the stamp of its first operation is far ahead.
  struct Withheld {
    std::uint64_t from = 0;
    SimTime stamp{};
    std::uint32_t operations = 0;  // when it began
  };
  std::map<AuthorId, Withheld> withheld_;
  SimTime far_ahead_ = SimTime::max();  // stamps after it are
  SimTime applied_until_ = SimTime::min();
  std::uint32_t next_object_ = 0, next_node_ = 0;  // of this author
};

}  // namespace peerd::replication
