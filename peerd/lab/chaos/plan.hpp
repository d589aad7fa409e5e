#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/lab/chaos/world_text.hpp"
#include "peerd/peer/config/link_settings.hpp"
#include "replication/settings/policy/rare_branches.hpp"
#include "replication/wire/decision_policy.hpp"

namespace peerd::chaos {

// Conditions that are rare by themselves. Each seed draws some of them.
enum class Rare : std::uint8_t {
  kLargeEdits,     // texts that fill many datagrams
  kBurst,          // hundreds of edits of one peer in one go
  kOneField,       // several peers set one field or value, or take one object, at one instant
  kAuthorDies,     // an author crashes as soon as another peer holds what it wrote
  kLongPartition,  // so long that operations of the other side are later than peers go back
  kFlapping,       // a peer crashes and comes back again and again
  kLoneSurvivor,   // all peers but one crash
  kBlackout,       // the power of all peers fails at one instant
  kUnchecked,      // damaged datagrams reach peers, as no checksum of UDP holds them back
};
inline constexpr std::size_t kRareCount = 9;
[[nodiscard]] std::string_view to_string(Rare rare);

[[nodiscard]] std::string_view to_string(replication::RareBranch branch);

struct PlannedPeer {
  std::uint32_t id = 0;
  double joins_at_s = 0.0;
  std::int64_t skew_ppm = 0;
  double wall_offset_s = 0.0;  // of its wall clock, by which its host clock begins
  bool has_store = false;
};

enum class FaultKind : std::uint8_t {
  kCrash,       // `peer` stops without a word, and comes back
  kLeave,       // it says goodbye, and comes back
  kPartition,   // nothing crosses between the peers of `side` and the others
  kOneWay,      // nothing comes from the peers of `side` to the others
  kLinks,       // all links are as bad as `links` says
  kSuspend,     // `peer` does not run; its clock goes on, and what comes meanwhile waits
  kClockStep,   // the wall clock of `peer` is set by `step_s`
  kPowerCut,    // the power of `peer` fails: its disk loses what was not synchronised; it comes back
  kDiskDeath,   // `peer` crashes in the middle of a write of its disk, with or without the power; it comes back
  kDiskFull,    // the disk of `peer` has hardly room
  kDiskErrors,  // some writes of its disk fail
  kAuthorDies,  // `peer` edits, and crashes once another holds that; it comes back
};
[[nodiscard]] std::string_view to_string(FaultKind kind);

struct LinkFaults {
  config::LinkSettings link;
  double damage = 0.0;  // probability that a datagram arrives with other bytes
};

struct DiskFaults {
  std::uint64_t dies_at_write = 1;  // from then on
  bool power_fails = false;         // with that
  std::uint64_t room_bytes = 0;
  double error_rate = 0.0;
};

struct Fault {
  std::uint32_t number = 0;  // in the plan as it was drawn
  FaultKind kind{};
  double at_s = 0.0, for_s = 0.0;
  std::size_t peer = 0;
  std::vector<bool> side;  // by peer
  LinkFaults links;
  double step_s = 0.0;
  DiskFaults disk;
};

enum class EditKind : std::uint8_t {
  kAny,
  kLarge,
  kBurst,
  kOneField,
  kOneOwner,    // as kOneField: several peers take one object
  kOneDatum,    // several peers set one value of an application
  kOneRemoval,  // some of several peers remove what the others change
};

struct PlannedEdit {
  std::uint32_t number = 0;  // in the plan as it was drawn
  double at_s = 0.0;
  std::size_t peer = 0;
  EditKind kind{};
  std::uint64_t seed = 0;  // what is edited depends on the scene then
};

// After so long without a fault all peers are to have one scene [s].
inline constexpr double kOneWorldWithin_s = 10.0;

// The part that a run leaves out of what its seed draws.
struct ChaosLimits {
  // A run has that time behind the healing, and a second more in which it is checked. In a shorter one peers would be
  // blamed for what they had no time to do.
  static constexpr double kSecondsMin = 2.0 * (kOneWorldWithin_s + 1.0);

  double seconds = 60.0;             // of the run; the network heals 15 s before the end, or at half of it
  std::optional<std::size_t> peers;  // the first ones
  std::set<std::uint32_t> without_faults, without_edits;  // by number
};

// All that happens in a run, but for what it leads to.
struct ChaosPlan {
  std::uint64_t seed = 0;
  ChaosLimits limits;
  std::set<Rare> rare;
  // The probability that the code takes a rare branch where it could, by RareBranch.
  std::array<double, replication::kRareBranchCount> rare_branches{};
  std::vector<PlannedPeer> peers;
  ChaosWorld world;
  std::uint32_t tick_hz = 60;
  replication::DecisionPolicy policy{};
  LinkFaults links;   // between faults
  LinkFaults healed;  // from heal_s on
  double heal_s = 0.0;
  std::vector<Fault> faults;       // by time
  std::vector<PlannedEdit> edits;  // by time

  [[nodiscard]] bool has(Rare r) const { return rare.contains(r); }
};
[[nodiscard]] ChaosPlan draw_plan(std::uint64_t seed, const ChaosLimits& limits = {});

// The options of `peerd sim` that run this plan again.
[[nodiscard]] std::string options_of(std::uint64_t seed, const ChaosLimits& limits);
// Reads a list such as f3,e7,e10-20 into the limits; false: it is none.
[[nodiscard]] bool read_without(std::string_view list, ChaosLimits& limits);

}  // namespace peerd::chaos
