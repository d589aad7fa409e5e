#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <span>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/peer/early_records.hpp"
#include "replication/peer/operation_keeper.hpp"
#include "replication/peer/peer_parts.hpp"
#include "replication/peer/scene_keeper.hpp"
#include "replication/peer/session_keeper.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::replication {

// The way in: datagrams become messages, and their records go to the parts that they concern.
class Intake {
 public:
  Intake(PeerParts& parts, SessionKeeper& keeper, SceneKeeper& scene, OperationKeeper& operations)
      : p_(parts), keeper_(keeper), scene_(scene), operations_(operations) {}

  // A datagram from the network: hostile until proven otherwise. The error says why it changed nothing.
  std::expected<void, Drop> on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram);
  // Takes the records that wait for an instant up to t, each at its own instant: both worlds are advanced to that
  // first.
  void take_early(HostTime now, SimTime t);

 private:
  [[nodiscard]] std::unexpected<Drop> dropped(RegionId region, Drop why);
  // Returns whether the sender is a member: else it is far.
  [[nodiscard]] std::expected<bool, Drop> admit(HostTime now, RegionId region, const Message& message);
  void count(RegionId region, const Message& message, std::size_t size_bytes);
  // A datagram of a peer that is far, or a far hello.
  void on_far(HostTime now, PeerId sender, const Message& message);
  void give_back_left_behind(PeerId sender, std::span<const ObjectId> owned);
  void on_far_hello(HostTime now, PeerId sender, Member& member, const Message& message);
  void on_hello(HostTime now, PeerId sender, std::uint32_t number, const Hello& hello);
  // A peer has said its name, which may be that of another one.
  void report_same_name(PeerId sender, const std::string& name);
  void on_introduction(HostTime now, PeerId sender, Member& member, const Hello& hello);
  void on_echo(HostTime now, PeerId sender, Member& member, const Hello& hello, const Echo* echo);
  // A member claims objects, some of which may have an owner: such claims are limited.
  [[nodiscard]] bool may_claim(HostTime now, PeerId sender, std::span<const ObjectId> objects);
  void on_ghost_checks(RegionId region, const Message& message, SimTime session_now);
  void on_records(HostTime now, PeerId sender, Message& message, SimTime session_now);
  [[nodiscard]] bool is_tick_due(HostTime now) const;
  // Whether the worlds have reached that instant; they are advanced to it where no tick comes before it.
  [[nodiscard]] bool reach(HostTime now, SimTime at);
  // The record is of an instant that the worlds have not reached.
  void wait(PeerId sender, std::uint32_t number, SimTime at, decltype(EarlyRecord::record) record);
  // Whether the worlds may be advanced once more, for a record, before the next tick.
  [[nodiscard]] bool may_advance() const;
  void advance(SimTime at);
  void on_decision(HostTime now, PeerId sender, std::uint32_t number, const DecisionRecord& decision,
                   SimTime session_now);
  void take_decision(HostTime now, PeerId sender, std::uint32_t number, const DecisionRecord& decision,
                     SimTime session_now);
  void on_scene_states(HostTime now, PeerId sender, std::uint32_t number, SceneStates& scene, SimTime session_now);
  // A record more than a second ahead of session time is dropped. It is false where hellos that its sender has said
  // since the first such record share this peer's time: until then the sender may have stepped into another session.
  void drop_of_the_future(HostTime now, PeerId sender, const char* reason);
  void on_update(PeerId sender, std::uint32_t number, UpdateRecord& update, SimTime session_now);
  void take_overtaken(const UpdateRecord& update);
  void take_until_decision(const UpdateRecord& update, SimTime session_now);

  PeerParts& p_;
  SessionKeeper& keeper_;
  SceneKeeper& scene_;
  OperationKeeper& operations_;
  Codec codec_;
  EarlyRecords early_;
  std::int64_t advanced_since_ = 0;         // a tick's number
  int advances_ = 0;                        // of the worlds, for records, since that tick
  std::uint64_t early_life_ = 0;            // of the worlds that `early_` waits for (Replica::lives())
  std::map<PeerId, HostTime> ahead_since_;  // the first record of the future, of members whose clocks are not ahead
};

}  // namespace peerd::replication
