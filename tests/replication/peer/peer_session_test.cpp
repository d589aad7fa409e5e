#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/replication/peer/lan.hpp"

// Joining, leaving, clocks: several peers on one network.
namespace peerd::replication::peer_session_test {

using namespace test;
using testing::IsEmpty;

std::string three_boxes() {
  return box("A", "1 1 1", "0 0 0", "velocityVector 1 0 0") + box("B", "1 1 1", "0 5 0", "velocityVector 0 0 2") +
         box("C", "1 1 1", "0 9 0");
}

// The largest difference of two peers' session times.
Duration spread(const Lan& lan) {
  SimTime low = SimTime::max(), high = SimTime::min();
  for (std::size_t i = 0; i < lan.size(); ++i) {
    low = std::min(low, lan.session_now(i));
    high = std::max(high, lan.session_now(i));
  }
  return high - low;
}

struct Case {
  const char* name;
  Link link;
  Duration ahead;  // of each next peer's clock
};
class Session : public testing::TestWithParam<Case> {};

TEST_P(Session, ThreePeersMeetAndAgreeOnTheTime) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Lan lan(world, GetParam().link, seed);
    lan.add(config(1, {{world["A"], false}}));
    lan.add(config(2, {{world["B"], false}}), GetParam().ahead);
    lan.add(config(3, {{world["C"], false}}), -GetParam().ahead);
    lan.run_until(5s);
    ASSERT_TRUE(lan.all_in_session());
    lan.run_until(30s);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(lan.peer(i).members().all().size(), 2u);
      EXPECT_EQ(lan.peer(i).owners().size(), 3u);
      EXPECT_THAT(lan.seen<ClockStepped>(i), IsEmpty());
      EXPECT_EQ(lan.seen<Synchronised>(i).size(), 1u);
      EXPECT_TRUE(std::holds_alternative<Join>(lan.node(i).outputs[0].second)) << "the group is joined before all else";
      const Duration off = lan.session_now(i) - lan.session_now(0);
      EXPECT_LE(std::chrono::abs(off), *lan.peer(i).clock().error_bound(lan.host_now(i))) << i;
      EXPECT_LE(*lan.peer(i).clock().error_bound(lan.host_now(i)),
                GetParam().link.latency + GetParam().link.jitter + 5ms);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Table, Session,
                         testing::Values(Case{"OneHost", {5ms, 0ms, 0, 0}, 0s},
                                         Case{"ClocksApart", {5ms, 0ms, 0, 0}, 3s},
                                         Case{"FarApart", {200ms, 0ms, 0, 0}, 3s},
                                         Case{"Jitter", {20ms, 80ms, 0, 0}, 3s}, Case{"Loss", {20ms, 20ms, 0.2, 0}, 3s},
                                         Case{"Duplicates", {20ms, 80ms, 0.05, 0.3}, 3s}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(Founder, IsTheLowestIdOfThoseThatStartTogether) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Lan lan(world, {20ms, 20ms, 0.2, 0}, seed);
    for (const std::uint32_t id : {3, 1, 2}) {
      PeerConfig c = config(id);
      c.owned_by_founder = {{world["A"]}};
      lan.add(c);
    }
    for (; lan.now() < 20s; lan.run_until(lan.now() + 10ms)) {
      int owners = 0;
      for (std::size_t i = 0; i < 3; ++i) owners += lan.peer(i).owns_any();
      ASSERT_LE(owners, 1);
    }
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(lan.peer(i).owner(world["A"]), PeerId{1}) << i;
    const SimTime t = lan.session_now(1);
    EXPECT_GT(lan.peer(1).truth(world["A"], t).position.x(), 1.0) << "its velocityVector launches it";
    EXPECT_NEAR(lan.peer(0).ghost(world["A"], t).position.x(), lan.peer(1).truth(world["A"], t).position.x(), 0.5);
  }
}

TEST(PeerSession, SilenceFreezesWithinTwoSeconds) {
  const World world(three_boxes());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Lan lan(world, {50ms, 20ms, 0.2, 0}, seed);
    lan.add(config(1, {{world["A"], false}}));
    lan.add(config(2, {{world["B"], false}}));
    lan.run_until(8s);
    ASSERT_TRUE(lan.seen<PeerLost>(0).empty());
    lan.kill(1);
    lan.run_until(10s);
    ASSERT_EQ(lan.seen<PeerLost>(0).size(), 1u);
    EXPECT_FALSE(lan.seen<PeerLost>(0)[0].left_gracefully);
    ASSERT_EQ(lan.seen<ObjectOrphaned>(0).size(), 1u);
    EXPECT_TRUE(lan.peer(0).ghost(world["B"], lan.session_now(0)).velocity.isZero(0.0));
  }
}

// Updates of a successor that arrive before its predecessor is lost do not count, neither as its own nor as received.
TEST(PeerSession, ASuccessorIsAcceptedAsSoonAsItsPredecessorIsLost) {
  const World world(box("A", "1 1 1", "0 0 0"));
  const auto at = [](double y) { return [y](SimTime) { return moving({0, y, 0}); }; };
  Lan lan(world);
  lan.add(config(2));
  const std::size_t watcher = lan.add(config(3));
  const std::size_t first = lan.add(config(5, {{world["A"], true}}), 0s, {{world["A"], at(5.0)}});
  lan.run_until(20s);
  lan.kill(first);
  lan.run_until(20100ms);
  lan.add(config(7, {{world["A"], true}}), 0s, {{world["A"], at(9.0)}});
  lan.run_until(28s);
  EXPECT_GT(lan.drops(watcher, "not_owner"), 0u);
  EXPECT_NEAR(lan.peer(watcher).ghost(world["A"], lan.session_now(watcher)).position.y(), 9.0, 1e-2);
}

// The others do not send it everything three times, nor an introduction with every hello.
TEST(PeerSession, APeerThatReceivesNothingCostsNothingAfterAWhile) {
  const World world(three_boxes());
  std::array<std::uint64_t, 2> bytes{};
  for (const bool unreachable : {false, true}) {
    Lan lan(world);
    const auto weaves = [](SimTime t) {
      std::mt19937_64 random(static_cast<std::uint64_t>(t.time_since_epoch().count()));
      return moving({static_cast<double>(random() % 3), 0, 0});
    };
    lan.add(config(1, {{world["A"], true}}), 0s, {{world["A"], weaves}});
    lan.add(config(2));
    lan.add(config(9));
    lan.filter = [=](std::size_t from, std::size_t to, const Message&) { return !unreachable || to != 2 || from == 2; };
    lan.run_until(40s);
    const std::uint64_t before = lan.peer(0).counters().bytes_out;
    lan.run_until(60s);
    bytes[unreachable ? 1 : 0] = lan.peer(0).counters().bytes_out - before;
  }
  EXPECT_LT(static_cast<double>(bytes[1]), 1.1 * static_cast<double>(bytes[0]));
}

// An object has no owner once its owner has left, even if that was before this peer had a session.
TEST(PeerSession, APeerLostBeforeTheSessionOwnsNothing) {
  const World world(three_boxes());
  Lan lan(world);
  lan.add(config(5));
  lan.run_until(100ms);
  lan.inject(0, encode(hello_of(7, lan.host_now(0), {world["B"]})));
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{7});
  lan.run_until(4s);  // never heard again
  EXPECT_EQ(lan.seen<PeerLost>(0).size(), 1u);
  EXPECT_EQ(lan.peer(0).owner(world["B"]), PeerId{0});
}

// The stamps come from a broken or hostile clock: their differences must not overflow, and time must continue.
TEST(PeerSession, StampsFromTheEndsOfTimeDoNoHarm) {
  constexpr Duration far{std::int64_t{1} << 62};
  const World world(three_boxes());
  for (int signs = 0; signs < 16; ++signs) {
    SCOPED_TRACE(signs);
    Lan lan(world);
    lan.add(config(5, {{world["A"], false}}));
    std::uint32_t last_hello = 0;
    lan.filter = [&](std::size_t, std::size_t, const Message& m) {
      if (m.hello) last_hello = m.number;
      return true;
    };
    lan.run_until(2s);
    for (int i = 0; i < 8; ++i) {
      Message m = hello_of(1, HostTime{signs & 1 ? far : -far});
      const std::uint32_t echoed = signs & 2 ? last_hello : last_hello / 2;
      m.hello->echoes = {
          {PeerId{5}, echoed, signs & 4 ? 10s : 0s, {signs & 8 ? 0xFFFF'FFFF : echoed, 1, ~std::uint64_t{2}}, 0.0}};
      lan.inject(0, encode(m));
      lan.run_until(lan.now() + 50ms);
    }
    const std::uint64_t ticks = lan.peer(0).counters().ticks;
    lan.run_until(lan.now() + 3s);
    EXPECT_GT(lan.peer(0).counters().ticks, ticks + 100);
  }
}

// A computer that slept wakes up with hours to catch up on: it must do so in bounded work and be in step soon after.
TEST(PeerSession, LongSuspensionsAreSurvived) {
  const World world(corridor("velocityVector 2 0 0 collisionResponse CollisionResponse { }"));
  Lan lan(world);
  lan.add(config(1, {{world["BALL"], false}}));
  lan.add(config(2), 3s);
  lan.run_until(5s);
  for (const Duration sleep : {Duration(1min), Duration(10min), Duration(24h * 3)}) {
    lan.skip(sleep);
    lan.run_until(lan.now() + 5s);
    EXPECT_LE(spread(lan), 11ms);
    EXPECT_EQ(lan.peer(1).owner(world["BALL"]), PeerId{1});
    const SimTime t = lan.session_now(0);
    EXPECT_LT((lan.peer(1).ghost(world["BALL"], t).position - lan.peer(0).truth(world["BALL"], t).position).norm(),
              0.5);
  }
  EXPECT_GT(lan.peer(0).counters().ticks_missed, 60u * 60u);
}

}  // namespace peerd::replication::peer_session_test
