// Ticks of any length, late ones and none at all: contacts are of the instant at which things meet.
#include <random>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::ticks_test {

using namespace test;

struct Met {
  SimTime at;
  ObjectId collider, collidee;
  Vec3 velocity;
  friend bool operator==(const Met&, const Met&) = default;
};
// Three bodies in a corridor, from one end of the time to the other in steps of `tick`.
std::vector<Met> contacts_in(const World& world, Duration until, Duration tick, KinematicState* end,
                             Duration begin = 0s) {
  MotionWorld motions(*world.model, sim(begin));
  motions.declare(world["BALL"], Role::kAuthoritative);
  motions.declare(world["CUBE"], Role::kAuthoritative);
  motions.set_base(world["BALL"], sim(begin), moving({-1, 0, 0}, {1.7, 0.02, 0}, {0, -0.01, 0}));
  motions.set_base(world["CUBE"], sim(begin), moving({1, 0.1, 0}, {-0.9, 0, 0.01}));
  std::vector<Met> met;
  for (Duration t = 0s; t < until;) {
    t = std::min(t + tick, until);
    motions.advance(sim(begin + t));
    while (auto e = motions.poll_event()) {
      if (const auto* c = std::get_if<ContactEvent>(&*e)) {
        met.push_back({c->at - begin, c->collider, c->collidee, c->collider_after.velocity});
      }
    }
  }
  *end = motions.at(world["BALL"], sim(begin + until));
  return met;
}

TEST(TickLength, FromAMicrosecondToTenSecondsChangesNoContact) {
  const World world(corridor() + box("CUBE", "0.6 0.6 0.6", "1 0 0", kBounces) +
                    interest("CUBE", "\"LEFT\" \"RIGHT\" \"BALL\"") + interest("BALL", "\"CUBE\""));
  for (const auto& [until, ticks] :
       {std::pair{Duration(2s), std::vector<Duration>{1us, 10us, 1ms, 2s}},
        std::pair{Duration(60s), std::vector<Duration>{100us, 1ms, 7ms, 16666667ns, 1s, 10s, 60s}}}) {
    KinematicState expected_end;
    const std::vector<Met> expected = contacts_in(world, until, 16ms, &expected_end);
    EXPECT_GE(expected.size(), until == 2s ? 1u : 25u);
    for (const Duration tick : ticks) {
      KinematicState end;
      EXPECT_EQ(contacts_in(world, until, tick, &end), expected) << tick.count() << " ns";
      EXPECT_TRUE(same_bits(end, expected_end)) << tick.count() << " ns";
    }
  }
}

TEST(TickLength, NorDoesTheTimeOfTheWorld) {
  const World world(corridor() + box("CUBE", "0.6 0.6 0.6", "1 0 0", kBounces) +
                    interest("CUBE", "\"LEFT\" \"RIGHT\" \"BALL\"") + interest("BALL", "\"CUBE\""));
  KinematicState expected_end;
  const std::vector<Met> expected = contacts_in(world, 60s, 16ms, &expected_end);
  for (const Duration tick : {1ms, 16ms, 1000ms}) {
    KinematicState end;
    EXPECT_EQ(contacts_in(world, 60s, tick, &end, 1'000'000s), expected) << tick.count() << " ns";
    EXPECT_TRUE(same_bits(end, expected_end)) << tick.count() << " ns";
  }
}

// Whole peers, whose drivers call them when they please: the contacts of a's ball, as each of two knows them.
struct Shared {
  std::uint64_t updates = 0;  // updates of the ball
  std::set<SimTime> owner, predicted;
  KinematicState owners, observers;
};
Shared share(const World& world, std::uint32_t owner_hz, std::uint32_t observer_hz, Duration longest_pause,
             std::uint64_t seed, Duration time_threshold = PublishPolicy{}.time_threshold) {
  Lan lan(world, {5ms, 0ms, 0, 0});
  for (const std::uint32_t id : {1u, 2u}) {
    PeerConfig c = config(id);
    c.tick_hz = id == 1 ? owner_hz : observer_hz;
    c.wait_for_start = true;
    c.policy.time_threshold = time_threshold;
    c.lost_after = 10s;  // nobody is, by pauses that add up
    if (id == 1) c.owned = {{world["BALL"], false}};
    lan.add(c);
  }
  lan.run_until(3s);
  const SimTime start = SimTime{kEpoch + 4s};
  for (const std::size_t i : {0u, 1u}) {
    lan.peer(i).announce_start(start);
    lan.peer(i).start_motions(lan.host_now(i), start);
  }
  std::mt19937_64 rng(seed);
  while (lan.now() < 20s) {
    if (longest_pause == 0s) {
      lan.run_until(20s);
      break;
    }
    lan.run_until(lan.now() + 1ms * (1 + rng() % 400));
    const std::size_t late = rng() % 2;  // its driver has other things to do, and reads nothing
    lan.kill(late);
    lan.run_until(lan.now() +
                  Duration{static_cast<std::int64_t>(rng() % static_cast<std::uint64_t>(longest_pause.count()))});
    lan.node(late).running = true;
  }
  lan.run_until(23s);
  Shared shared;
  shared.updates = lan.peer(0).counters().updates_out;
  for (const ContactSeen& c : lan.contacts(0, ContactKind::kOwner)) {
    if (c.contact.at < SimTime{kEpoch + 20s}) shared.owner.insert(c.contact.at);
  }
  for (const ContactSeen& c : lan.contacts(1, ContactKind::kPredicted)) {
    if (c.contact.at < SimTime{kEpoch + 20s}) shared.predicted.insert(c.contact.at);
  }
  const SimTime then = SimTime{kEpoch + 21s};
  shared.owners = lan.peer(0).truth(world["BALL"], then);
  shared.observers = lan.peer(1).ghost(world["BALL"], then);
  return shared;
}

TEST(TickLength, OfPeersChangesNoOutcome) {
  const World world(corridor(std::string(kBounces) + "velocityVector 2 0.1 0 "));
  const Shared expected = share(world, 60, 60, 0s, 1);
  EXPECT_EQ(expected.owner.size(), 5u);
  for (const auto& [owner_hz, observer_hz] : {std::pair{1u, 60u}, std::pair{60u, 1u}, std::pair{1000u, 7u}}) {
    SCOPED_TRACE(testing::Message() << owner_hz << " and " << observer_hz << " Hz");
    const Shared got = share(world, owner_hz, observer_hz, 0s, 1);
    EXPECT_EQ(got.owner, expected.owner);
    EXPECT_TRUE(same_bits(got.owners, expected.owners));
    EXPECT_TRUE(same_bits(got.observers, expected.observers));
  }
}

// Pauses shorter than what counts as sleep: ticks come late, and several at once.
TEST(TickLength, PausesChangeNoOutcome) {
  const World world(corridor(std::string(kBounces) + "velocityVector 2 0.1 0 "));
  const Shared expected = share(world, 60, 60, 0s, 1, 1min);
  int heard = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    const Shared got = share(world, 60, 60, 1s, seed, 1min);
    if (got.updates != expected.updates) continue;  // one more, for a peer that was away: see the next test
    EXPECT_EQ(got.owner, expected.owner);
    EXPECT_TRUE(same_bits(got.owners, expected.owners));
    if (got.predicted.empty()) continue;  // it was away when the ball was published
    ++heard;
    EXPECT_TRUE(same_bits(got.observers, expected.observers));
  }
  EXPECT_GE(heard, 5);
}

// Pauses delay acknowledgements, so that the ball is published again, at a late tick. There its law begins anew, for
// its owner as for all others. Contact times are whole nanoseconds and round differently than in a run without pauses:
// each differs by at most one, and places by the way of two.
TEST(TickLength, RepublishingAtALateTickIsTheSameForAllPeers) {
  const World world(corridor(std::string(kBounces) + "velocityVector 2 0.1 0 "));
  const Shared expected = share(world, 60, 60, 0s, 1);
  bool rounded_otherwise = false;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    const Shared got = share(world, 60, 60, 1s, seed);
    EXPECT_EQ(got.owner.size(), expected.owner.size());
    EXPECT_TRUE(std::ranges::includes(got.owner, got.predicted)) << "those that an update did not come before";
    EXPECT_TRUE(same_bits(got.owners, got.observers));
    EXPECT_LT((got.owners.position - expected.owners.position).norm(), 5 * 2 * 2.1e-9);
    EXPECT_EQ(got.owners.velocity, expected.owners.velocity);
    rounded_otherwise |= got.owner != expected.owner;
  }
  EXPECT_TRUE(rounded_otherwise) << "no update separated a ghost from its truth";
}

}  // namespace peerd::replication::ticks_test
