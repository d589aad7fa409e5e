#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "peerd/lab/baselines/command.hpp"
#include "peerd/lab/baselines/snapshot.hpp"
#include "replication/physics/world/motion_event.hpp"

namespace peerd::baselines {

inline constexpr std::size_t kMessageMax_bytes = 1 << 16;

// A client sends this at each tick: its last inputs, and which of the server's messages it has.
struct ClientMessage {
  std::uint32_t player = 0;
  std::uint64_t first_tick = 0;
  std::vector<Command> commands;      // of this tick and those after it
  std::uint64_t last_event = 0;       // it has all events up to this one
  SimTime seen{};                     // the time as of which it shows the others
  std::vector<std::uint64_t> blocks;  // the last snapshot of each block; 0: none
};
std::size_t write(const ClientMessage& message, SimTime start, std::span<std::byte> out);
// None: it is cut off or no such message. `objects`: the number of driven objects of each player.
[[nodiscard]] std::optional<ClientMessage> read_client_message(std::span<const std::byte> in, SimTime start,
                                                               std::span<const std::size_t> objects,
                                                               std::size_t blocks);

// A contact as the server publishes it.
struct GameEvent {
  std::uint64_t number = 0;  // from 1 on
  bool shared = false;       // of objects of two players
  replication::ContactEvent contact;
};
void put(replication::BitWriter& out, SimTime start, const GameEvent& event);
[[nodiscard]] bool take(replication::BitReader& in, SimTime start, GameEvent& event);

// The begin of what the server sends to one client of one block; the changes follow, and with block 0 the events.
struct SnapshotHead {
  std::uint64_t tick = 0;
  std::uint64_t commands = 0;  // of this client that have been carried out: all ticks before this one
  std::uint32_t block = 0;
  std::uint64_t number = 0, base = 0;  // of the snapshots of this block, from 1 on; base 0: nothing is known
};
void put(replication::BitWriter& out, const SnapshotHead& head);
[[nodiscard]] bool take(replication::BitReader& in, SnapshotHead& head);

}  // namespace peerd::baselines
