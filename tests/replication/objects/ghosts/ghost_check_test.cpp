// Whole peers whose ghosts are made to differ (Peer::displace_ghost): the difference is found, mended and said by both.
#include "replication/objects/ghosts/ghost_check.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::ghost_check_test {

using namespace test;

class Displaced : public testing::Test {
 protected:
  static constexpr std::uint32_t kObjects = 40;

  void begin(Link link, std::uint64_t seed = 1) {
    lan.emplace(world, link, seed);
    std::vector<OwnedObject> owned;
    for (std::uint32_t k = 0; k < kObjects; ++k) owned.push_back({world["O" + std::to_string(k)], false});
    for (const std::uint32_t id : {1u, 2u, 3u}) {
      PeerConfig c = config(id);
      if (id == 1) c.owned = owned;
      lan->add(c);
    }
    lan->run_until(8s);
    ASSERT_TRUE(lan->all_in_session());
    ASSERT_GT(lan->peer(1).counters().ghost_checks, 3u);
    EXPECT_EQ(differences(), 0u);
  }
  [[nodiscard]] std::uint64_t differences() const {
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < lan->size(); ++i) {
      const auto& c = lan->peer(i).counters();
      all += c.ghosts_differ + c.ghosts_differ_explained;
    }
    return all;
  }
  [[nodiscard]] double apart_m(ObjectId object) const {
    const SimTime t = lan->session_now(0);
    return (lan->peer(1).ghost(object, t).position - lan->peer(0).ghost(object, t).position).norm();
  }
  // Runs until that is so, for a minute at most; returns how long it took.
  template <class Condition>
  Duration until(Condition condition) {
    const Duration begun = lan->now();
    while (!condition() && lan->now() < begun + 60s) lan->run_until(lan->now() + 5ms);
    return lan->now() - begun;
  }

  World world{field(kObjects)};
  std::optional<Lan> lan;
};

TEST_F(Displaced, IsFoundMendedAndSaidByBoth) {
  ASSERT_NO_FATAL_FAILURE(begin({.latency = 100ms}));
  const ObjectId object = world["O17"];
  lan->peer(1).displace_ghost(object, lan->session_now(1), {0.5, 0, 0});
  EXPECT_LE(until([&] { return lan->peer(1).counters().ghost_questions > 0; }), 1s);
  EXPECT_NEAR(apart_m(object), 0.5, 1e-9);
  EXPECT_LE(until([&] { return apart_m(object) == 0.0; }), 1s);
  lan->run_until(lan->now() + 300ms);
  EXPECT_EQ(lan->peer(1).counters().ghosts_differ, 1u) << "nothing has been lost, nothing is late";
  EXPECT_EQ(lan->peer(1).members().all().at(PeerId{1}).ghosts_differ, 1u);
  EXPECT_EQ(lan->peer(0).counters().ghosts_reported, 1u);
  EXPECT_EQ(lan->peer(2).counters().ghosts_differ, 0u);
  EXPECT_NEAR(lan->peer(0).ghost_difference_m(object, lan->host_now(0)).value_or(0.0), 0.5, 1e-6);
  EXPECT_NEAR(lan->peer(1).ghost_difference_m(object, lan->host_now(1)).value_or(0.0), 0.5, 1e-9);
  EXPECT_FALSE(lan->peer(1).ghost_difference_m(world["O18"], lan->host_now(1)).has_value());
  const auto said = lan->seen<GhostDiffers>(1);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].object, object);
  EXPECT_EQ(said[0].owner, PeerId{1});
  EXPECT_EQ(said[0].by, PeerId{2});
  EXPECT_FALSE(said[0].explained);
  lan->run_until(lan->now() + 20s);
  EXPECT_EQ(differences(), 1u) << "it stays mended";
  EXPECT_FALSE(lan->peer(0).ghost_difference_m(object, lan->host_now(0)).has_value());
}

TEST_F(Displaced, IsMendedWhereDatagramsGetLost) {
  std::size_t in_time = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ASSERT_NO_FATAL_FAILURE(begin({.latency = 100ms, .loss = 0.05}, seed));
    const ObjectId object = world["O17"];
    lan->peer(1).displace_ghost(object, lan->session_now(1), {0.5, 0, 0});
    const Duration found = until([&] { return lan->peer(1).counters().ghost_questions > 0; });
    const Duration mended = found + until([&] { return apart_m(object) == 0.0; });
    in_time += found <= 1s && mended <= 2s ? 1 : 0;
  }
  EXPECT_EQ(in_time, 20u);
}

// Exact states of what tumbles and falls are long: twelve of them are more than a datagram.
TEST(GhostAnswers, FitADatagram) {
  constexpr std::uint32_t kTumbling = 64;
  const World world(field(kTumbling));
  Lan lan(world, {.latency = 20ms});
  PeerConfig owner = config(1);
  for (std::uint32_t k = 0; k < kTumbling; ++k) {
    owner.owned.push_back({world["O" + std::to_string(k)],
                           false,
                           {.velocity = Vec3(0.1, 0.7, 0.3),
                            .acceleration = Vec3(0, -1e-3, 0),
                            .angular_velocity = Vec3(0.3, 0.2 + 0.01 * k, 0.1)}});
  }
  lan.add(owner);
  lan.add(config(2));
  lan.run_until(8s);
  for (std::uint32_t k = 0; k < kTumbling; ++k) {
    lan.peer(1).displace_ghost(world["O" + std::to_string(k)], lan.session_now(1), {0, 0.1, 0});
  }
  lan.run_until(14s);
  const SimTime t = lan.session_now(0);
  for (std::uint32_t k = 0; k < kTumbling; ++k) {
    const ObjectId object = world["O" + std::to_string(k)];
    EXPECT_EQ(lan.peer(1).ghost(object, t).position, lan.peer(0).ghost(object, t).position) << k;
  }
}

// A member says digests that are not true. It costs a few questions, ever fewer.
TEST_F(Displaced, FalseDigestsCostLittle) {
  ASSERT_NO_FATAL_FAILURE(begin({.latency = 20ms}));
  lan->forge = [](std::size_t from, const Message& m) -> std::optional<Message> {
    if (from != 0 || !m.ghosts) return std::nullopt;
    Message wrong = m;
    for (std::uint16_t& group : wrong.ghosts->groups) ++group;
    return wrong;
  };
  const std::uint64_t updates = lan->peer(0).counters().updates_out;
  lan->run_until(lan->now() + 60s);
  EXPECT_GT(lan->peer(1).counters().ghost_questions, 0u);
  EXPECT_LE(lan->peer(1).counters().ghost_questions, 4u * 14u);
  EXPECT_EQ(differences(), 0u);
  EXPECT_LE(lan->peer(0).counters().updates_out - updates, 2u * kObjects) << "what does not differ is not published";
}

// A member asks about all groups all the time, by the owner's own numbers, so that no answer is due.
TEST_F(Displaced, WhoAsksInVainKeepsNobodyFromAnswers) {
  ASSERT_NO_FATAL_FAILURE(begin({.latency = 20ms}));
  std::uint32_t number = 1'000'000;
  const auto ask_in_vain = [&] {
    const SimTime at = floor_to(lan->session_now(2) - 500ms, kGhostGrid);
    GhostSums sums;
    for (std::uint32_t k = 0; k < kObjects; ++k) {
      const ObjectId object = world["O" + std::to_string(k)];
      sums.add(object, lan->peer(2).ghost(object, at));
    }
    for (std::uint32_t group = 0; group < kGhostGroups; ++group) {
      Message asks = message_of(3, incarnation_low(100));
      asks.number = ++number;
      asks.ghost_question = {PeerId{1}, kWholeScene, at, group, sums.buckets_of(group)};
      EXPECT_TRUE(lan->inject(0, encode(asks)));
    }
  };
  ask_in_vain();
  const ObjectId object = world["O17"];
  lan->peer(1).displace_ghost(object, lan->session_now(1), {0.5, 0, 0});
  const Duration begun = lan->now();
  while (apart_m(object) != 0.0 && lan->now() < begun + 20s) {
    lan->run_until(lan->now() + 10ms);
    ask_in_vain();
  }
  EXPECT_LE(lan->now() - begun, 2s);
}

TEST_F(Displaced, WhoHasLostDatagramsKnowsWhy) {
  ASSERT_NO_FATAL_FAILURE(begin({.latency = 20ms}));
  lan->filter = [&](std::size_t from, std::size_t to, const Message& m) {
    return from != 0 || to != 1 || m.ghosts.has_value() || !m.ghost_answer.states.empty();
  };
  lan->run_until(lan->now() + 600ms);
  lan->peer(1).displace_ghost(world["O3"], lan->session_now(1), {0, 0.1, 0});
  lan->run_until(lan->now() + 1500ms);
  EXPECT_EQ(lan->peer(1).counters().ghosts_differ, 0u);
  EXPECT_GT(lan->peer(1).counters().ghosts_differ_explained, 0u);
}

}  // namespace peerd::replication::ghost_check_test
