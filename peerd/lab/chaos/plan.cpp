#include "peerd/lab/chaos/plan.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <limits>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/lab/chaos/random_stream.hpp"

namespace peerd::chaos {
namespace {

constexpr std::size_t kPeersMin = 5, kPeersMax = 9;
constexpr double kSettled_s = 3.0;     // the first peers have found each other, most often
constexpr double kHealedMax_s = 15.0;  // at the end of a run, or half of it where that is shorter
constexpr double kFaultEvery_s = 2.0, kEditEvery_s = 0.7;
constexpr std::int64_t kSkewMax_ppm = 500;
constexpr double kWallStepMax_s = 10.0;
constexpr std::array kOfOneThing{EditKind::kOneField, EditKind::kOneOwner, EditKind::kOneDatum, EditKind::kOneRemoval};
constexpr double kRareChance = 0.25, kUncheckedChance = 0.06;
constexpr double kRareBranchMax = 0.2;                      // each time that the code could take it
constexpr double kStoresChance = 0.7, kStoreChance = 0.85;  // of a seed, and of a peer in such a seed
constexpr std::uint64_t kDiskWritesMax = 60, kRoomMax_bytes = 8192;
constexpr double kDiskErrorsMax = 0.3;

LinkFaults draw_links(Random& random, double loss_max) {
  LinkFaults links;
  links.link.latency_ms = random.uniform(0.2, 80.0);
  links.link.jitter_ms = random.uniform(0.0, 40.0);
  links.link.loss = random.uniform(0.0, loss_max);
  links.link.duplication = random.uniform(0.0, 0.1);
  links.link.reordering = random.uniform(0.0, 0.2);
  if (random.chance(0.3)) links.link.loss_burst = random.uniform(2.0, 10.0);
  links.damage = random.uniform(0.0, 0.05);
  return links;
}

DiskFaults draw_disk(Random& random) {
  DiskFaults disk;
  disk.dies_at_write = 1 + random.below(kDiskWritesMax);
  disk.power_fails = random.chance(0.5);
  disk.room_bytes = random.below(kRoomMax_bytes);
  disk.error_rate = random.uniform(0.01, kDiskErrorsMax);
  return disk;
}

LinkFaults draw_healed_links(Random& random) {
  LinkFaults links;
  links.link.latency_ms = random.uniform(0.2, 60.0);
  links.link.jitter_ms = random.uniform(0.0, 5.0);
  links.link.loss = random.uniform(0.0, 0.02);
  return links;
}

class PlanDrawer {
 public:
  PlanDrawer(std::uint64_t seed, const ChaosLimits& limits) : random_(stream_of(seed, Stream::kGeneral)) {
    assert(limits.seconds >= ChaosLimits::kSecondsMin);
    plan_.seed = seed;
    plan_.limits = limits;
    plan_.heal_s = limits.seconds - std::min(kHealedMax_s, limits.seconds / 2.0);
  }

  ChaosPlan all() {
    for (std::size_t i = 0; i < kRareCount; ++i) {
      const Rare rare{static_cast<std::uint8_t>(i)};
      if (random_.chance(rare == Rare::kUnchecked ? kUncheckedChance : kRareChance)) plan_.rare.insert(rare);
    }
    for (double& probability : plan_.rare_branches) {
      const bool is_drawn = random_.chance(kRareChance);
      const double drawn = random_.uniform(0.0, kRareBranchMax);
      if (is_drawn) probability = drawn;
    }
    has_stores_ = random_.chance(kStoresChance);
    drawn_peers_ = kPeersMin + random_.below(kPeersMax - kPeersMin + 1);
    const std::size_t peers = std::min(drawn_peers_, plan_.limits.peers.value_or(drawn_peers_));
    constexpr std::array<std::uint32_t, 3> kRates{20, 30, 60};
    plan_.tick_hz = kRates[random_.below(kRates.size())];
    constexpr std::array kPolicies{replication::DecisionPolicy::kId, replication::DecisionPolicy::kVelocity,
                                   replication::DecisionPolicy::kExpectedError};
    plan_.policy = kPolicies[random_.below(kPolicies.size())];
    plan_.links = draw_links(random_, 0.1);
    plan_.healed = draw_healed_links(random_);
    for (std::size_t i = 0; i < peers; ++i) plan_.peers.push_back(draw_peer(i));
    plan_.world = draw_world(plan_.seed, peers);
    draw_faults();
    draw_edits();
    return std::move(plan_);
  }

 private:
  PlannedPeer draw_peer(std::size_t i) const {
    Random random = stream_of(plan_.seed, Stream::kPeer, i);
    PlannedPeer peer;
    peer.id = static_cast<std::uint32_t>(i + 1);
    const bool is_late = i >= 2 && random.chance(0.25);
    peer.joins_at_s = is_late ? random.uniform(kSettled_s, 0.9 * plan_.heal_s) : random.uniform(0.0, 0.4);
    peer.skew_ppm = static_cast<std::int64_t>(random.uniform(-1.0, 1.0) * kSkewMax_ppm);
    peer.wall_offset_s = random.uniform(-kWallStepMax_s, kWallStepMax_s);
    peer.has_store = random.chance(kStoreChance) && has_stores_;
    return peer;
  }

  // Faults begin and end while the network is not healed yet.
  void draw_faults() {
    const auto count = static_cast<std::uint32_t>(std::max(0.0, plan_.heal_s - kSettled_s) / kFaultEvery_s);
    for (std::uint32_t number = 0; number < count; ++number) {
      Random random = stream_of(plan_.seed, Stream::kFault, number);
      add(draw_fault(random, number));
    }
    std::uint32_t number = count;
    Random random = stream_of(plan_.seed, Stream::kRareFault);
    const auto add_rare = [&](FaultKind kind, double at_s, double for_s, std::size_t peer) {
      Fault fault{number++, kind, at_s, for_s, peer, {}, {}, 0.0, {}};
      if (kind == FaultKind::kPartition) fault.side = draw_side(random);
      add(fault);
    };
    if (plan_.has(Rare::kAuthorDies)) {
      for (int i = 0; i < 3; ++i) {
        const double at_s = a_time(random), for_s = random.uniform(1.0, 6.0);
        add_rare(FaultKind::kAuthorDies, at_s, for_s, a_peer(random));
      }
    }
    if (plan_.has(Rare::kLongPartition)) {
      const double at_s = a_time(random), for_s = random.uniform(6.0, 15.0);
      add_rare(FaultKind::kPartition, at_s, for_s, 0);
    }
    if (plan_.has(Rare::kFlapping)) {
      const std::size_t peer = a_peer(random);
      double at_s = a_time(random);
      for (int i = 0; i < 6; ++i, at_s += random.uniform(0.3, 2.5)) add_rare(FaultKind::kCrash, at_s, 0.1, peer);
    }
    if (plan_.has(Rare::kLoneSurvivor)) {
      const std::size_t survivor = a_peer(random);
      const double at_s = a_time(random);
      for (std::size_t peer = 0; peer < plan_.peers.size(); ++peer) {
        if (peer != survivor) add_rare(FaultKind::kCrash, at_s, random.uniform(0.5, 4.0), peer);
      }
    }
    if (plan_.has(Rare::kBlackout)) {
      const double at_s = a_time(random);
      for (std::size_t peer = 0; peer < plan_.peers.size(); ++peer) {
        add_rare(FaultKind::kPowerCut, at_s, random.uniform(0.5, 4.0), peer);
      }
    }
    std::ranges::stable_sort(plan_.faults, {}, &Fault::at_s);
  }

  Fault draw_fault(Random& random, std::uint32_t number) const {
    Fault fault;
    fault.number = number;
    fault.kind = static_cast<FaultKind>(random.below(static_cast<std::uint64_t>(FaultKind::kAuthorDies)));
    fault.at_s = a_time(random);
    fault.for_s = random.uniform(0.2, 5.0);
    fault.peer = a_peer(random);
    fault.side = draw_side(random);
    fault.links = draw_links(random, 0.5);
    fault.step_s = random.uniform(-kWallStepMax_s, kWallStepMax_s);
    fault.disk = draw_disk(random);
    return fault;
  }

  [[nodiscard]] double a_time(Random& random) const {
    return random.uniform(std::min(kSettled_s, plan_.heal_s), plan_.heal_s);
  }
  // Draws from all peers of the seed, so that a limit changes no draw. The plan leaves out what concerns others.
  [[nodiscard]] std::size_t a_peer(Random& random) const { return random.below(drawn_peers_); }
  [[nodiscard]] static std::vector<bool> draw_side(Random& random) {
    std::vector<bool> side(kPeersMax);
    for (std::size_t i = 0; i < kPeersMax; ++i) side[i] = random.chance(0.5);
    return side;
  }

  void add(Fault fault) {
    if (plan_.limits.without_faults.contains(fault.number) || fault.peer >= plan_.peers.size()) return;
    fault.for_s = std::min(fault.for_s, plan_.heal_s - fault.at_s);
    if (fault.for_s >= 0.0) plan_.faults.push_back(std::move(fault));
  }

  void draw_edits() {
    const auto count = static_cast<std::uint32_t>(std::max(0.0, plan_.limits.seconds - kSettled_s) / kEditEvery_s);
    for (std::uint32_t number = 0; number < count; ++number) {
      Random random = stream_of(plan_.seed, Stream::kEdit, number);
      // The last ones come after the heal, so that the run shows that edits work again.
      const double until_s = plan_.heal_s + 2.0;
      const double at_s = random.uniform(std::min(kSettled_s, until_s), until_s);
      add(draw_edit(random, number, at_s, EditKind::kAny));
    }
    std::uint32_t number = count;
    Random random = stream_of(plan_.seed, Stream::kRareEdit);
    if (plan_.has(Rare::kLargeEdits)) {
      for (int i = 0; i < 4; ++i) {
        const double at_s = a_time(random);
        add(draw_edit(random, number++, at_s, EditKind::kLarge));
      }
    }
    if (plan_.has(Rare::kBurst)) {
      const double at_s = a_time(random);
      add(draw_edit(random, number++, at_s, EditKind::kBurst));
    }
    if (plan_.has(Rare::kOneField)) {
      for (int i = 0; i < 5; ++i) {
        const double at_s = a_time(random);
        const std::uint64_t seed = random.bits();
        const EditKind kind = kOfOneThing[static_cast<std::size_t>(i) % kOfOneThing.size()];
        for (std::size_t peer = 0; peer < kPeersMin; ++peer) {
          add(PlannedEdit{number++, at_s, peer, kind, seed + peer});
        }
      }
    }
    std::ranges::stable_sort(plan_.edits, {}, &PlannedEdit::at_s);
  }

  [[nodiscard]] PlannedEdit draw_edit(Random& random, std::uint32_t number, double at_s, EditKind kind) const {
    const std::size_t peer = a_peer(random);
    return {number, at_s, peer, kind, random.bits()};
  }

  void add(const PlannedEdit& edit) {
    if (plan_.limits.without_edits.contains(edit.number) || edit.peer >= plan_.peers.size()) return;
    plan_.edits.push_back(edit);
  }

  ChaosPlan plan_;
  Random random_;
  std::size_t drawn_peers_ = 0;
  bool has_stores_ = false;
};

// Writes numbers as f3,f5-9.
void append_ranges(char letter, const std::set<std::uint32_t>& numbers, std::string& list) {
  for (auto at = numbers.begin(); at != numbers.end();) {
    const std::uint32_t first = *at;
    std::uint32_t last = first;
    for (++at; at != numbers.end() && *at == last + 1; ++at) last = *at;
    list += fmt::format("{}{}{}", list.empty() ? "" : ",", letter, first);
    if (last != first) list += fmt::format("-{}", last);
  }
}

}  // namespace

std::string_view to_string(Rare rare) {
  constexpr std::array<std::string_view, kRareCount> kNames{"large edits",   "burst of edits", "one field",
                                                            "author dies",   "long partition", "flapping peer",
                                                            "lone survivor", "blackout",       "unchecked damage"};
  return kNames[static_cast<std::size_t>(rare)];
}

std::string_view to_string(replication::RareBranch branch) {
  constexpr std::array<std::string_view, replication::kRareBranchCount> kNames{
      "an answer without a place", "a small part", "the exchange waits", "no checkpoint"};
  return kNames[static_cast<std::size_t>(branch)];
}

std::string_view to_string(FaultKind kind) {
  constexpr std::array<std::string_view, 12> kNames{
      "crash",       "leave",      "partition", "one-way partition",     "bad links",
      "suspend",     "clock step", "power cut", "death at a disk write", "disk full",
      "disk errors", "author dies"};
  return kNames[static_cast<std::size_t>(kind)];
}

ChaosPlan draw_plan(std::uint64_t seed, const ChaosLimits& limits) { return PlanDrawer(seed, limits).all(); }

std::string options_of(std::uint64_t seed, const ChaosLimits& limits) {
  std::string options = fmt::format("--chaos {}", seed);
  if (limits.seconds != ChaosLimits{}.seconds) options += fmt::format(" --chaos-seconds {}", limits.seconds);
  if (limits.peers) options += fmt::format(" --chaos-peers {}", *limits.peers);
  std::string list;
  append_ranges('f', limits.without_faults, list);
  append_ranges('e', limits.without_edits, list);
  return list.empty() ? options : options + " --chaos-without " + list;
}

bool read_without(std::string_view list, ChaosLimits& limits) {
  constexpr std::uint32_t kNumberMax = 1'000'000;
  while (!list.empty()) {
    const std::string_view item = list.substr(0, list.find(','));
    list.remove_prefix(item.size());
    if (list.size() == 1) return false;  // a comma with nothing behind it
    list.remove_prefix(std::min<std::size_t>(list.size(), 1));
    if (item.size() < 2 || (item[0] != 'f' && item[0] != 'e')) return false;
    std::uint32_t first = 0;
    const char* const end = item.data() + item.size();
    auto read = std::from_chars(item.data() + 1, end, first);
    std::uint32_t last = first;
    if (read.ec == std::errc{} && read.ptr != end && *read.ptr == '-') read = std::from_chars(read.ptr + 1, end, last);
    if (read.ec != std::errc{} || read.ptr != end || last < first || last > kNumberMax) return false;
    auto& numbers = item[0] == 'f' ? limits.without_faults : limits.without_edits;
    for (std::uint32_t n = first; n <= last; ++n) numbers.insert(n);
  }
  return true;
}

}  // namespace peerd::chaos
