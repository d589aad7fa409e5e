#pragma once
#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "peerd/lab/baselines/game_message.hpp"
#include "peerd/lab/baselines/participant.hpp"
#include "peerd/lab/baselines/rewinding.hpp"

namespace peerd::baselines {

// The regions of a server and its clients: one for what goes to the server, and one for each client.
inline constexpr RegionId kToServer{0};
[[nodiscard]] inline RegionId to_client(std::size_t client) { return RegionId{static_cast<std::uint32_t>(client) + 1}; }

// The objects that a server's snapshots are of: what the peers own, and what answers contacts.
[[nodiscard]] std::vector<ObjectId> objects_of_snapshots(const Setup& setup);
// The objects of one block of them.
[[nodiscard]] std::span<const ObjectId> block_of(const std::vector<ObjectId>& objects, std::size_t block);
[[nodiscard]] std::size_t blocks_of(const std::vector<ObjectId>& objects);
// How many snapshots of a block both sides keep as bases: those of four seconds.
[[nodiscard]] inline std::size_t snapshots_kept(const Setup& setup) {
  return std::max<std::size_t>(64, std::size_t{4} * setup.run.baseline.snapshots_hz);
}

// The server of Quake (id Software, 1996) and Half-Life (Bernier, "Latency compensating methods in client/server
// in-game protocol design and optimization", 2001; Ohlenburg 2003, sections 4.2.1 and 4.3): clients send inputs, the
// server alone runs the game, an input as soon as it comes, and sends snapshots of what has changed. With lag
// compensation it decides what a player's object hits of other players' by how that player saw them (Rewinding). It
// sends everything to everybody: no potentially visible set.
class GameServer final : public Participant {
 public:
  // It is the last peer of the run.
  GameServer(const Setup& setup, std::unique_ptr<Game> game);

  [[nodiscard]] const Game& game() const { return *game_; }
  [[nodiscard]] std::vector<RegionId> regions() const override { return {kToServer}; }
  void on_packet(SimTime now, std::span<const std::byte> datagram) override;
  void on_tick(SimTime now, std::int64_t tick) override;
  void record(SimTime) override {}  // it owns nothing, and shows nothing

 private:
  struct Client {
    std::map<std::uint64_t, Command> pending;  // inputs that have not been carried out
    std::uint64_t done = 0;                    // those before this tick have
    std::vector<Pose> at;                      // its driven objects
    SimTime seen{};
    std::uint64_t last_event = 0;
    std::vector<std::uint64_t> acknowledged;           // of each block
    std::vector<std::map<std::uint64_t, Block>> sent;  // of each block, by number, from the acknowledged one on
    std::vector<std::uint64_t> last_number;            // of each block
  };

  void carry_out(std::size_t player, SimTime now, std::vector<replication::OwnSample>& samples);
  void note_contacts(SimTime now);
  void add_event(SimTime now, const replication::ContactEvent& contact, bool seen_late);
  void send_snapshots(SimTime now, std::int64_t tick);
  [[nodiscard]] Block block_now(std::size_t block) const;

  std::unique_ptr<Game> game_;
  Rewinding rewinding_;
  std::vector<ObjectId> objects_;
  std::vector<std::size_t> driven_;  // the number of driven objects of each player
  std::map<ObjectId, Pose> poses_;   // of driven objects, with all inputs that have come
  std::vector<Client> clients_;
  std::deque<GameEvent> events_;  // that some client may not have
  std::uint64_t last_event_ = 0;
  std::int64_t last_snapshot_ = -1;
};

}  // namespace peerd::baselines
