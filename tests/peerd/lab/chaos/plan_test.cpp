#include "peerd/lab/chaos/plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "core/mixed_bits.hpp"

namespace peerd::chaos::plan_test {

constexpr std::uint64_t kSeeds = 200;

TEST(ChaosPlan, HasWhatAUserIsPromised) {
  std::set<std::size_t> peers;
  std::set<Rare> rare;
  std::set<FaultKind> kinds;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const ChaosPlan plan = draw_plan(seed);
    peers.insert(plan.peers.size());
    rare.insert(plan.rare.begin(), plan.rare.end());
    for (const Fault& fault : plan.faults) {
      kinds.insert(fault.kind);
      EXPECT_LE(fault.at_s + fault.for_s, plan.heal_s + 1e-9) << "seed " << seed << ": it outlives the heal";
      EXPECT_LT(fault.peer, plan.peers.size());
    }
    for (const PlannedPeer& peer : plan.peers) EXPECT_LT(peer.joins_at_s, plan.heal_s);
    EXPECT_TRUE(std::ranges::is_sorted(plan.faults, {}, &Fault::at_s));
    EXPECT_TRUE(std::ranges::is_sorted(plan.edits, {}, &PlannedEdit::at_s));
  }
  EXPECT_THAT(peers, testing::ElementsAre(5, 6, 7, 8, 9));
  EXPECT_EQ(rare.size(), kRareCount);
  EXPECT_EQ(kinds.size(), 12u);
}

TEST(ChaosPlan, LeavingOneOutChangesNoOther) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ChaosPlan whole = draw_plan(seed);
    ASSERT_GT(whole.faults.size(), 3u);
    ChaosLimits limits;
    limits.without_faults.insert(whole.faults[2].number);
    limits.without_edits.insert(whole.edits[5].number);
    const ChaosPlan part = draw_plan(seed, limits);
    ASSERT_EQ(part.faults.size() + 1, whole.faults.size());
    ASSERT_EQ(part.edits.size() + 1, whole.edits.size());
    for (std::size_t i = 0; i < part.faults.size(); ++i) {
      const Fault& same = whole.faults[i < 2 ? i : i + 1];
      EXPECT_EQ(part.faults[i].number, same.number);
      EXPECT_EQ(part.faults[i].at_s, same.at_s);
      EXPECT_EQ(part.faults[i].side, same.side);
    }
    for (std::size_t i = 0; i < part.edits.size(); ++i) {
      EXPECT_EQ(part.edits[i].seed, whole.edits[i < 5 ? i : i + 1].seed);
    }
  }
}

TEST(ChaosPlan, FewerPeersAreTheFirstOnes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ChaosPlan whole = draw_plan(seed);
    ChaosLimits limits;
    limits.peers = 3;
    const ChaosPlan part = draw_plan(seed, limits);
    ASSERT_EQ(part.peers.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(part.peers[i].joins_at_s, whole.peers[i].joins_at_s);
    for (const Fault& fault : part.faults) EXPECT_LT(fault.peer, 3u);
    for (const PlannedEdit& edit : part.edits) EXPECT_LT(edit.peer, 3u);
  }
}

TEST(ChaosPlan, OfTheShortestRunLeavesTheTimeThatPeersMayTake) {
  ChaosLimits limits;
  limits.seconds = ChaosLimits::kSecondsMin;
  EXPECT_GT(limits.seconds - draw_plan(1, limits).heal_s, kOneWorldWithin_s);
}

// All that is drawn for a seed, as text. It is the same with every compiler, in whichever order that evaluates the
// arguments of a call.
std::string text_of(const ChaosPlan& plan) {
  std::string text = fmt::format("{} {} {}\n", plan.tick_hz, static_cast<int>(plan.policy), plan.heal_s);
  const auto add = [&](const LinkFaults& f) {
    text += fmt::format("{} {} {} {} {} {} {}\n", f.link.latency_ms, f.link.jitter_ms, f.link.loss, f.link.loss_burst,
                        f.link.duplication, f.link.reordering, f.damage);
  };
  for (const Rare rare : plan.rare) text += fmt::format("{}\n", to_string(rare));
  for (const PlannedPeer& p : plan.peers) {
    text += fmt::format("{} {} {} {} {}\n", p.id, p.joins_at_s, p.skew_ppm, p.wall_offset_s, p.has_store);
  }
  add(plan.links);
  add(plan.healed);
  for (const Fault& f : plan.faults) {
    text += fmt::format("{} {} {} {} {} {}\n", f.number, to_string(f.kind), f.at_s, f.for_s, f.peer, f.step_s);
    for (const bool side : f.side) text += side ? '1' : '0';
    add(f.links);
    text +=
        fmt::format("{} {} {} {}\n", f.disk.dies_at_write, f.disk.power_fails, f.disk.room_bytes, f.disk.error_rate);
  }
  for (const double probability : plan.rare_branches) text += fmt::format("{}\n", probability);
  for (const PlannedEdit& e : plan.edits) {
    text += fmt::format("{} {} {} {} {}\n", e.number, e.at_s, e.peer, static_cast<int>(e.kind), e.seed);
  }
  return text + plan.world.text;
}

TEST(ChaosPlan, IsTheSameWithEveryCompiler) {
  std::uint64_t hash = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const char c : text_of(draw_plan(seed))) hash = mixed_bits(hash ^ static_cast<unsigned char>(c)) + 1;
  }
  EXPECT_EQ(hash, 16959974469734346254u);
}

TEST(ChaosPlan, OptionsSayWhatALimitIs) {
  EXPECT_EQ(options_of(7, {}), "--chaos 7");
  const ChaosLimits limits{.seconds = 25.0, .peers = 3, .without_faults = {0, 1, 2, 5}, .without_edits = {4}};
  EXPECT_EQ(options_of(8, limits), "--chaos 8 --chaos-seconds 25 --chaos-peers 3 --chaos-without f0-2,f5,e4");
  ChaosLimits again;
  ASSERT_TRUE(read_without("f0-2,f5,e4", again));
  EXPECT_EQ(again.without_faults, limits.without_faults);
  EXPECT_EQ(again.without_edits, limits.without_edits);
}

TEST(ChaosPlan, OtherListsAreRefused) {
  for (const char* list :
       {"f", "7", "g3", "f3-", "f3-2", "f3,,e4", "f-3", "f3x", "e99999999999", "f0-4000000000", "f3,", ","}) {
    ChaosLimits limits;
    EXPECT_FALSE(read_without(list, limits)) << list;
  }
}

}  // namespace peerd::chaos::plan_test
