// Collisions between two peers' objects under every policy, on bad networks: one outcome everywhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::policies_test {

using namespace test;

using testing::SizeIs;

using Outcomes = std::set<std::tuple<ObjectId, ObjectId, SimTime>>;

// The decisions that a peer holds at the end: decided or applied, and not overruled since.
Outcomes outcomes(Lan& lan, std::size_t i) {
  Outcomes held;
  for (const auto& [at, out] : lan.node(i).outputs) {
    if (const auto* c = std::get_if<ContactSeen>(&out)) {
      if (c->kind == ContactKind::kDecided || c->kind == ContactKind::kApplied) {
        held.emplace(c->contact.collider, c->contact.collidee, c->contact.at);
      }
    } else if (const auto* o = std::get_if<Overruled>(&out)) {
      EXPECT_EQ(held.erase({o->collider, o->collidee, o->contact}), 1u) << "overruled what was never held";
    }
  }
  return held;
}

// The peers that the decisions of a peer's contacts name, each once.
std::set<PeerId> deciders(Lan& lan, std::size_t i) {
  std::set<PeerId> named;
  for (const auto& [at, out] : lan.node(i).outputs) {
    const auto* c = std::get_if<ContactSeen>(&out);
    if (c != nullptr && (c->kind == ContactKind::kDecided || c->kind == ContactKind::kApplied))
      named.insert(c->decider);
  }
  return named;
}

struct Way {
  DecisionPolicy policy;
  Duration latency;
};
void PrintTo(const Way& w, std::ostream* os) {
  *os << int(w.policy) << " at " << w.latency.count() / 1'000'000 << " ms";
}

std::vector<Way> every_way() {
  std::vector<Way> ways;
  for (std::uint8_t policy = 1; policy <= 5; ++policy) {
    for (const Duration latency : {Duration(0ms), Duration(100ms), Duration(500ms)}) {
      ways.push_back({static_cast<DecisionPolicy>(policy), latency});
    }
  }
  return ways;
}
std::string name_of(const testing::TestParamInfo<Way>& info) {
  constexpr std::array names{"Id", "Velocity", "FieldOfView", "ExpectedError", "Server"};
  return names[static_cast<std::size_t>(info.param.policy) - 1] +
         std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(info.param.latency).count());
}

// CAR of peer 1 and CUBE of peer 2 meet once; peer 9 watches, and is the server. The cube is faster and its owner looks
// at it, so every policy but `id` leaves the collision to peer 2 or 9.
class HeadOn : public testing::TestWithParam<Way> {
 protected:
  void begin(Link link = {}, std::uint64_t seed = 1, double cube_speed = -3.0, const DecisionSettings& settings = {}) {
    link.latency = GetParam().latency;
    world.emplace(box("CAR", "1 1 1", "0 0 0", std::string("velocityVector 2 0 0") + kBounces) +
                  box("CUBE", "1 1 1", "26 0 0",
                      "velocityVector " + std::to_string(cube_speed) + " 0 0" + std::string(kBounces)) +
                  interest("CAR", "\"CUBE\"") + interest("CUBE", "\"CAR\""));
    lan.emplace(*world, link, seed);
    for (const std::uint32_t id : {1u, 2u, 9u}) {
      PeerConfig c = config(id);
      if (id == 1) c.owned = {{(*world)["CAR"], false}};
      if (id == 2) c.owned = {{(*world)["CUBE"], false}};
      c.policy.time_threshold = time_threshold;
      c.decisions = settings;
      c.decisions.policy = GetParam().policy;
      c.decisions.server = PeerId{9};
      if (id == 2) c.decisions.viewpoint = Viewpoint{std::nullopt, {Vec3(10, 0, 60), Quat::Identity()}, 1.0, 1.0};
      lan->add(c, id == 2 ? Duration(3s) : Duration(0s));
    }
  }
  [[nodiscard]] std::size_t policys_choice() const {
    return GetParam().policy == DecisionPolicy::kId ? 0 : GetParam().policy == DecisionPolicy::kServer ? 2 : 1;
  }
  // Runs until a peer has found the contact.
  void run_to_contact() {
    const auto found = [&] {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& c = lan->peer(i).counters();
        if (c.decisions + c.contacts_held > 0) return true;
      }
      return false;
    };
    while (!found() && lan->now() < 30s) lan->run_until(lan->now() + 1ms);
  }
  // The objects meet once, and part.
  void settle() {
    settle_on_anything();
    EXPECT_THAT(outcomes(*lan, 0), SizeIs(1));
    const SimTime t = lan->session_now(0);
    EXPECT_LT(lan->peer(0).truth((*world)["CAR"], t).velocity.x(), 0.0);
    EXPECT_GT(lan->peer(1).truth((*world)["CUBE"], t).velocity.x(), 0.0);
  }
  // All peers hold the same decisions in the end, whichever these are.
  void settle_on_outcomes() {
    lan->run_until(lan->now() + 12s);
    const Outcomes held = outcomes(*lan, 0);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(outcomes(*lan, i), held) << i;
  }
  // All peers also see the objects where they are.
  void settle_on_anything() {
    settle_on_outcomes();
    const SimTime t = lan->session_now(0) - 1s;
    for (std::size_t i = 0; i < 3; ++i) {
      for (const auto& [object, owner] : {std::pair{"CAR", 0u}, {"CUBE", 1u}}) {
        const KinematicState truth = lan->peer(owner).truth((*world)[object], t);
        const KinematicState ghost = lan->peer(i).ghost((*world)[object], t);
        EXPECT_LT((ghost.position - truth.position).norm(), 0.1) << object << " at " << i;
        EXPECT_LT((ghost.velocity - truth.velocity).norm(), 1e-6) << object << " at " << i;
      }
    }
  }
  [[nodiscard]] std::uint64_t sum(std::uint64_t Peer::Counters::*counter) const {
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < lan->size(); ++i) all += lan->peer(i).counters().*counter;
    return all;
  }

  Duration time_threshold = 5s;
  std::optional<World> world;
  std::optional<Lan> lan;
};

TEST_P(HeadOn, ThePolicysChoiceDecides) {
  begin();
  run_to_contact();
  settle();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_THAT(lan->contacts(i, ContactKind::kDecided), SizeIs(i == policys_choice() ? 1 : 0)) << i;
    EXPECT_THAT(deciders(*lan, i), testing::ElementsAre(lan->peer(policys_choice()).id())) << i;
  }
  EXPECT_EQ(sum(&Peer::Counters::decisions), 1u);
  EXPECT_EQ(sum(&Peer::Counters::decisions_fallback), 0u);
  EXPECT_EQ(sum(&Peer::Counters::decisions_overruled), 0u);
  EXPECT_EQ(sum(&Peer::Counters::decisions_repeated), 0u) << "all have acknowledged it";
}

// With a third of the datagrams many hellos are lost, and with them the notes of decisions and the latencies.
TEST_P(HeadOn, LossJitterAndCopies) {
  for (const auto& [link, seeds] : {std::pair(Link{0ms, 30ms, 0.05, 0.05}, 12u), {Link{0ms, 20ms, 0.33, 0.0}, 4u}}) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      SCOPED_TRACE(testing::Message() << seed << ", loss " << link.loss);
      begin(link, seed);
      run_to_contact();
      settle();
    }
  }
}

// Every decision, whoever sends it, is lost until `lost_for` after the contact.
TEST_P(HeadOn, TheDecisionsPacketsAreLost) {
  for (const Duration lost_for : {300ms, 1000ms, 2000ms}) {
    SCOPED_TRACE(lost_for.count());
    begin();
    Duration until = Duration::max();
    lan->filter = [&](std::size_t, std::size_t, const Message& m) {
      return m.decisions.empty() || lan->now() >= until;
    };
    run_to_contact();
    until = lan->now() + lost_for;
    settle();
    EXPECT_GT(sum(&Peer::Counters::decisions_repeated), 0u);
  }
}

// No datagram of the deciding peer arrives around the contact: no hellos, updates or decisions.
TEST_P(HeadOn, TheDecidersDatagramsAreLost) {
  begin();
  Duration from = Duration::max(), until = Duration::max();
  lan->filter = [&](std::size_t sender, std::size_t to, const Message&) {
    return sender == to || sender != policys_choice() || lan->now() < from || lan->now() >= until;
  };
  run_to_contact();
  from = lan->now();
  until = from + 1500ms;
  settle();
}

// The cube changes its speed before the contact, and the other owner learns of it only afterwards. By velocity, both
// owners then take themselves for the decider (faster), or neither does (slower).
TEST_P(HeadOn, TheStatesThatADecisionRestsOnAreLost) {
  for (const auto& [before, after] : {std::pair{-1.0, -4.0}, {-4.0, -1.0}, {-2.0, -2.5}, {-2.5, -1.9}}) {
    for (const Duration at : {4000ms, 4700ms, 5100ms}) {
      SCOPED_TRACE(testing::Message() << before << " to " << after << " at " << at.count());
      begin({}, 1, before);
      lan->filter = [&](std::size_t sender, std::size_t to, const Message& m) {
        return !(sender == 1 && to == 0 && !m.updates.empty() && lan->now() > 3900ms && lan->now() < 7s);
      };
      lan->run_until(at);
      ASSERT_TRUE(lan->peer(1).change_velocity(lan->host_now(1), (*world)["CUBE"], {after, 0, 0}, true));
      run_to_contact();
      settle_on_anything();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, HeadOn, testing::ValuesIn(every_way()), name_of);

// ---- each mechanism by itself ----

class ByVelocity : public HeadOn {};
INSTANTIATE_TEST_SUITE_P(Ways, ByVelocity, testing::Values(Way{DecisionPolicy::kVelocity, 100ms}), name_of);

// The ghosts bounce, as all peers predict, and the owner's truth continues until the decision. An update of that truth
// would be retracted soon.
TEST_P(ByVelocity, NothingIsPublishedWhileADecisionIsAwaited) {
  time_threshold = 50ms;
  begin();
  lan->filter = [](std::size_t, std::size_t, const Message& m) { return m.decisions.empty(); };
  run_to_contact();
  while (lan->peer(0).counters().contacts_held == 0) lan->run_until(lan->now() + 1ms);
  const std::uint64_t updates = lan->peer(0).counters().updates_out;
  EXPECT_GT(updates, 20u);
  lan->run_until(lan->now() + 500ms);
  EXPECT_EQ(lan->peer(0).counters().updates_out, updates);
}

// A decision publishes its outcome as an update does: the time threshold counts from the contact.
TEST_P(ByVelocity, ADecisionReplacesUpdatesOfBothObjects) {
  begin();
  run_to_contact();
  const Duration contact = lan->now();
  const auto updates = [&] { return lan->peer(0).counters().updates_out + lan->peer(1).counters().updates_out; };
  const std::uint64_t before = updates();
  lan->run_until(contact + 4900ms);
  EXPECT_THAT(outcomes(*lan, 0), SizeIs(1));
  EXPECT_EQ(updates(), before);
  lan->run_until(contact + 5200ms);
  EXPECT_EQ(updates(), before + 2);
}

// A peer that neither runs one of the two objects nor is the server is not waited for: its hellos stay as rare as
// before.
TEST_P(ByVelocity, OnlyWhoMayDecideIsAskedToHurry) {
  begin();
  std::array<int, 3> hellos{};
  lan->on_send = [&](std::size_t sender, RegionId, const Message& m) { hellos[sender] += m.hello.has_value(); };
  lan->filter = [](std::size_t, std::size_t, const Message& m) { return m.decisions.empty(); };
  run_to_contact();
  hellos = {};
  lan->run_until(lan->now() + 1s);
  EXPECT_EQ(lan->peer(0).counters().decisions_fallback, 0u) << "the contact is still open";
  EXPECT_GE(hellos[0], 3);
  EXPECT_GE(hellos[1], 3);
  EXPECT_LE(hellos[2], 1);
}

// An acknowledgement that proves the decision lost causes its repetition, long before the receiver's silence would (2
// latencies and a second).
TEST_P(ByVelocity, DecisionsProvedLostAreRepeatedAtOnce) {
  begin();
  bool lost = false;
  lan->filter = [&](std::size_t, std::size_t to, const Message& m) {
    return to != 0 || m.decisions.empty() || std::exchange(lost, true);
  };
  run_to_contact();
  lan->run_until(lan->now() + 3s);
  ASSERT_TRUE(lost);
  const auto applied = lan->contacts(0, ContactKind::kApplied);
  ASSERT_THAT(applied, SizeIs(1));
  EXPECT_GT(applied[0].known_at, applied[0].contact.at + 250ms);
  EXPECT_LT(applied[0].known_at, applied[0].contact.at + 1s);
  EXPECT_EQ(sum(&Peer::Counters::decisions_repeated), 1u);
}

// The datagrams before it came in the session that the peer did not take, received or not.
TEST_P(ByVelocity, APeerReturningJustThenReceivesTheDecision) {
  begin();
  run_to_contact();
  const Duration contact = lan->now();
  for (const Duration before : {0ms, 100ms, 200ms, 400ms, 800ms}) {
    SCOPED_TRACE(before.count());
    begin();
    lan->run_until(contact - before);
    PeerConfig again = config(9);
    again.incarnation = 101;
    again.decisions.policy = GetParam().policy;
    lan->restart(2, again);
    lan->run_until(contact + 6s);
    EXPECT_THAT(lan->contacts(2, ContactKind::kApplied), SizeIs(1));
  }
}

// No datagram of peer 2 arrives for a while: the peer with the lower id decides instead, and if peer 2 has decided,
// that counts.
TEST_P(ByVelocity, TheFallbackIsOverruledByThePolicy) {
  for (const bool fallback : {true, false}) {
    DecisionSettings settings;
    settings.fallback = fallback;
    begin({}, 1, -3.0, settings);
    Duration from = Duration::max();
    lan->filter = [&](std::size_t sender, std::size_t, const Message& m) {
      if (sender != 1 || (from != Duration::max() && lan->now() > from + 1400ms)) return true;
      return lan->now() < from && m.decisions.empty();
    };
    run_to_contact();
    from = lan->now();
    settle();
    EXPECT_EQ(lan->peer(0).counters().decisions_fallback, fallback ? 1u : 0u);
    EXPECT_EQ(lan->seen<Overruled>(0).size(), fallback ? 1u : 0u);
    EXPECT_THAT(lan->contacts(1, ContactKind::kDecided), SizeIs(1));
  }
}

// The update after a decision overtakes it: the updated state stays, and the objects do not meet again in the gap
// between.
TEST_P(ByVelocity, AnUpdateThatKnowsOfTheDecisionComesFirst) {
  begin();
  Duration until = Duration::max();
  lan->filter = [&](std::size_t, std::size_t, const Message& m) { return m.decisions.empty() || lan->now() >= until; };
  run_to_contact();
  until = lan->now() + 400ms;
  lan->run_until(lan->now() + 200ms);
  ASSERT_TRUE(lan->peer(1).change_velocity(lan->host_now(1), (*world)["CUBE"], {7, 0, 0}, true));
  lan->run_until(until + 1500ms);
  const SimTime t = lan->session_now(0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_THAT(outcomes(*lan, i), SizeIs(1)) << i;
    EXPECT_EQ(lan->peer(i).ghost((*world)["CUBE"], t).velocity, Vec3(7, 0, 0)) << i;
  }
}

// The decider has never received that the car moves, and says that it has found no contact: it could not. The car's
// owner decides.
TEST_P(ByVelocity, WhatTheDeciderCouldNotFindTheOtherDecides) {
  begin();
  lan->filter = [&](std::size_t sender, std::size_t to, const Message& m) {
    return sender != 0 || to != 1 || m.updates.empty();
  };
  run_to_contact();
  settle_on_outcomes();
  EXPECT_THAT(outcomes(*lan, 0), SizeIs(1));
  EXPECT_EQ(lan->peer(0).counters().contacts_refuted, 0u);
  EXPECT_EQ(lan->peer(0).counters().decisions_fallback, 1u);
}

}  // namespace peerd::replication::policies_test
