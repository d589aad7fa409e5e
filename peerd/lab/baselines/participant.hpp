#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "peerd/lab/baselines/game.hpp"
#include "peerd/peer/config/resolve.hpp"
#include "peerd/peer/node/peer_log.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd::baselines {

// All participants of a run know this before it begins.
struct Setup {
  const config::RunSettings& run;  // with the server as its last peer, where the system has one
  const SharedWorld& shared;
  const std::vector<config::PeerObjects>& objects;  // of each of run.peers
  LogRows& rows;
  std::map<ObjectId, std::size_t> owners;  // index in run.peers

  [[nodiscard]] double tick_s() const { return 1.0 / run.replication.tick_hz; }
  // The index of the peer whose object it is; the number of peers where it is nobody's.
  [[nodiscard]] std::size_t owner_of(ObjectId object) const {
    const auto owner = owners.find(object);
    return owner == owners.end() ? objects.size() : owner->second;
  }
};

// One computer of another system, sans-IO as a PeerNode. Times are session times, which all participants know exactly:
// what an agreement about time costs these systems is not part of what is compared.
class Participant {
 public:
  Participant(const Setup& setup, std::size_t self, SimTime start);
  virtual ~Participant() = default;
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  // The regions whose datagrams it gets.
  [[nodiscard]] virtual std::vector<RegionId> regions() const = 0;
  virtual void on_packet(SimTime now, std::span<const std::byte> datagram) = 0;
  // Ticks of all participants are at the same times; tick 0 is at the start.
  virtual void on_tick(SimTime now, std::int64_t tick) = 0;
  // Adds a row for each object that somebody owns, as this participant has it at that time.
  virtual void record(SimTime now) = 0;

  // The datagrams since the last call.
  [[nodiscard]] std::vector<replication::Send> take_sent() { return std::exchange(sent_, {}); }
  [[nodiscard]] const PeerLog& log() const { return log_; }

 protected:
  void send(SimTime now, RegionId region, std::span<const std::byte> datagram);
  void note_update(SimTime now, ObjectId object, std::size_t bytes, const char* what);
  // Adds a row: `shown` is the pose that the participant shows, `state` the truth of an own object, and of another one
  // the ghost.
  void note_sample(SimTime now, ObjectId object, const KinematicState& state, const Pose& shown);
  void note_contact(SimTime now, const char* kind, const replication::ContactEvent& contact);
  void count(const char* name, std::uint64_t by = 1) { log_.counters[name] += by; }

  const Setup& setup_;
  const std::size_t self_;  // the index in run.peers

 private:
  PeerLog log_;
  std::vector<replication::Send> sent_;
};

}  // namespace peerd::baselines
