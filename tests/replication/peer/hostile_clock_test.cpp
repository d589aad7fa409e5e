// One member says false times to all others, whose session time stays within its published reach.
#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::hostile_clock_test {

using namespace test;

// Host clocks show 2030, and so are not surely wrong.
constexpr Duration k2030 = std::chrono::seconds(1'893'456'000) - kEpoch;
constexpr Duration kReach = 2s, kForgedFrom = 6s;
constexpr std::size_t kHonest = 3;  // nodes 0 to 2; the last node is hostile

struct Forgery {
  const char* name;
  Duration (*ahead)(Duration forged_for);  // of the time that it would say
  std::uint32_t id;                        // of the hostile peer; the others are 10, 11 and 12
  bool leads = true;                       // it says so; the stamps of who does not may be slewed
  bool is_refused = true;                  // else it contradicts itself, and is not followed at all
  bool echoes = true;
};

Duration by_part(Duration elapsed, double part) { return from_seconds(to_seconds(elapsed) * part); }

class FalseClock : public testing::TestWithParam<Forgery> {
 protected:
  void run(Duration until, Duration reach = kReach) {
    for (const std::uint32_t id : {10u, 11u, 12u, GetParam().id}) {
      PeerConfig c = config(id);
      c.clock_ahead_max = reach;
      lan.add(c, k2030 + (id == 11 ? 300ms : 0ms));
    }
    lan.forge = [this](std::size_t from, const Message& sent) -> std::optional<Message> {
      if (from != kHonest || !sent.hello || !sent.hello->session_tx || lan.now() < kForgedFrom) return std::nullopt;
      Message m = sent;
      m.hello->clock_error = GetParam().leads ? std::nullopt : std::optional<Duration>(1us);
      if (!GetParam().echoes) m.hello->echoes.clear();
      *m.hello->session_tx += GetParam().ahead(lan.now() - kForgedFrom);
      return m;
    };
    lan.run_until(kForgedFrom);
    ASSERT_TRUE(lan.all_in_session());
    for (std::size_t i = 0; i < kHonest; ++i) before.push_back(lan.peer(i).clock().session_minus_host(lan.host_now(i)));
    while (lan.now() < until) {
      lan.run_until(lan.now() + 1s);
      for (std::size_t i = 0; i < kHonest; ++i) {
        EXPECT_TRUE(lan.peer(i).clock().synchronised()) << i << " at " << to_seconds(lan.now()) << " s";
        const Duration moved = lan.peer(i).clock().session_minus_host(lan.host_now(i)) - before[i];
        farthest = std::max(farthest, Duration(std::chrono::abs(moved)));
      }
    }
  }

  World world{box("A", "1 1 1", "0 0 0")};
  Lan lan{world};
  std::vector<Duration> before;
  Duration farthest{0};
};

TEST_P(FalseClock, MovesNobodyBeyondTheReach) {
  run(150s);
  EXPECT_LT(farthest, kReach + 500ms) << "and what clocks may have drifted apart";
  std::uint64_t named = 0;
  for (std::size_t i = 0; i < kHonest; ++i) {
    EXPECT_LT(std::chrono::abs(lan.session_now(i) - lan.session_now(0)), 20ms) << i << ": the others agree";
    EXPECT_EQ(lan.peer(i).follows(), PeerId{10}) << i << ": the lowest of those that agree leads";
    named += lan.seen<LimitMet>(i).size();
    for (const LimitMet& met : lan.seen<LimitMet>(i)) EXPECT_EQ(met.peer, PeerId{GetParam().id});
  }
  EXPECT_EQ(named > 0, GetParam().is_refused);
  EXPECT_LE(named, kHonest * 3) << "once a minute at each";
}

INSTANTIATE_TEST_SUITE_P(
    Table, FalseClock,
    testing::Values(Forgery{"YearsAheadAsLowest", [](Duration) { return Duration(24h * 366 * 31); }, 1},
                    Forgery{"YearsAheadAsHighest", [](Duration) { return Duration(24h * 366 * 31); }, 20},
                    Forgery{"HalfAYearAhead", [](Duration) { return Duration(24h * 183); }, 1},
                    Forgery{"Creeping", [](Duration d) { return by_part(d, 0.04); }, 1, false},
                    Forgery{"CreepingLeader", [](Duration d) { return by_part(d, 0.04); }, 1, true, false},
                    Forgery{"Slowing", [](Duration d) { return -by_part(d, 0.04); }, 1, false},
                    Forgery{"InSteps", [](Duration d) { return Duration(d / Duration(8s) * 700ms); }, 1},
                    Forgery{"ByMoreAndMore", [](Duration d) { return by_part(d, to_seconds(d)); }, 1, true, false},
                    Forgery{"ToAndFro", [](Duration d) { return Duration(d / Duration(1s) % 2 * 24h); }, 1, true,
                            false},
                    Forgery{"WithoutEchoes", [](Duration d) { return Duration(d / Duration(1s) % 2 * 24h); }, 1, true,
                            false, false}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::replication::hostile_clock_test
