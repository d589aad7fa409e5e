#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "core/ids.hpp"

namespace peerd::replication {

// Record sizes that counters tell apart [bytes].
inline constexpr std::array<std::size_t, 4> kRecordSizes{16, 24, 32, 64};

// Why a datagram, or a record in it, was not used.
enum class Drop : std::uint8_t {
  kOwn,          // multicast loopback brings back what this peer sent
  kUndecodable,  // see codec.hpp
  kIdInUse,      // our id, another boot
  kStaleIncarnation,    // from before that peer's restart
  kOtherWorld,
  kTooMany,          // more peers than can be
  kUnintroduced,         // no hello of that peer has named its world yet
  kNotYetInSession,  // this peer has no session time yet
  kRegion,           // said in one region what concerns everybody
};
[[nodiscard]] const char* to_string(Drop);

// Of what one peer has done since it was made.
struct PeerCounters {
  std::uint64_t datagrams_in = 0, datagrams_out = 0, bytes_in = 0, bytes_out = 0;
  std::map<std::string, std::uint64_t> drops;  // by reason
  std::uint64_t ticks = 0, ticks_missed = 0;
  std::uint64_t updates_in = 0, updates_out = 0;
  std::uint64_t updates_at_once = 0;                                      // of updates_out: between two ticks
  std::uint64_t update_bytes_out = 0;                                     // of updates_out
  std::array<std::uint64_t, kRecordSizes.size() + 1> update_sizes_out{};  // how many of updates_out fit each; longer
  std::uint64_t updates_repeated = 0;                                     // second copies sent; not in updates_out
  std::uint64_t updates_duplicate = 0;                                    // copies of what was applied already
  std::uint64_t updates_relayed = 0;
  std::uint64_t updates_withheld = 0;     // due, and beyond the budget of bytes; a tick each
  std::uint64_t states_out_of_range = 0;  // told as standing, for receivers would refuse them
  std::uint64_t convergence_blocked = 0;  // ways of what is shown that would have led through something
  std::uint64_t convergence_detours = 0;  // those that followed the ghost's own way past it
  std::uint64_t objects_looked_at = 0;    // own ones, a tick each; of those that physics moves what rests need not be
  std::uint64_t proximity_tests = 0;
  std::uint64_t proximity_refined = 0;                 // those that spheres didn't settle
  std::uint64_t decisions = 0;                         // made here, fallback included
  std::uint64_t decisions_fallback = 0;                // because nobody else did
  std::uint64_t decisions_repeated = 0;                // copies sent after the first ones
  std::uint64_t decisions_overruled = 0;               // known here that no longer stand
  std::uint64_t contacts_held = 0;                     // left to another peer to decide
  std::uint64_t contacts_refuted = 0;                  // of those, which that peer did not find
  std::uint64_t contacts_too_late = 0;                 // found so late that nobody decides them
  std::uint64_t regions_joined = 0, regions_left = 0;  // kWholeScene aside
  std::uint64_t handovers = 0;                         // updates in another region than the last one
  std::uint64_t sights_lost = 0;                       // objects that this peer no longer hears of
  std::uint64_t predictions_skipped = 0;  // pairs without prediction, as this peer hears nothing of one; a tick each
  // By region: what came and was used, what was not and why, what went.
  struct Traffic {
    std::uint64_t datagrams_in = 0, bytes_in = 0, datagrams_out = 0, bytes_out = 0;
    std::map<std::string, std::uint64_t> drops;
  };
  std::map<RegionId, Traffic> regions;
  std::uint64_t clock_steps = 0;           // of session time
  std::uint64_t clock_contradictions = 0;  // stamps that cannot be true together: some clock jumped
  std::uint64_t os_clocks_doubted = 0;     // two OS clocks that contradict the stamps
};

}  // namespace peerd::replication
