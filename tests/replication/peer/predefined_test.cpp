// Objects that the world moves by itself, on several peers: they move the same everywhere, without an update.
#include <gmock/gmock.h>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::test::predefined_test {

using testing::IsEmpty;
using testing::SizeIs;

// PLATE goes from x = 10 towards the origin and back, 1 m/s; ARM turns about its middle.
const std::string kMachine =
    box("PLATE", "1 20 20", "10 0 0") + box("ARM", "4 1 1", "0 40 0") + shuttles("PLATE") +
    "DEF O OrientationInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 1 0, 0 0 1 3.14159265, 0 0 1 6.2831853 ] }\n"
    "ROUTE T.fraction_changed TO O.set_fraction ROUTE O.value_changed TO ARM.rotation\n";

TEST(Predefined, IsTheSameOnAllPeersWithoutTraffic) {
  const World world(kMachine + box("BALL", "1 1 1", "-30 0 0") + interest("BALL", "\"PLATE\" \"ARM\""));
  ASSERT_EQ(world.model->moving, (std::vector<ObjectId>{world["PLATE"], world["ARM"]}));
  Lan lan(world, {20ms, 5ms, 0.05, 0});
  for (const std::uint32_t id : {1u, 2u, 3u}) lan.add(config(id), id * 137s);
  lan.run_until(2s);
  lan.peer(0).announce_start(lan.session_now(0) + 1s);
  lan.run_until(5s);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(lan.peer(i).world_zero(), lan.peer(0).world_zero()) << i;
  const std::size_t late = lan.add(config(4), 999s);  // hears of it when it comes
  lan.run_until(12s);
  ASSERT_EQ(lan.peer(late).world_zero(), lan.peer(0).world_zero());
  const SimTime zero = *lan.peer(0).world_zero();
  const SimTime newest = std::min(lan.session_now(0), lan.session_now(late)) - 100ms;
  for (const char* name : {"PLATE", "ARM"}) {
    for (SimTime t = newest - 2s; t < newest; t += 7ms) {
      const KinematicState first = lan.peer(0).ghost(world[name], t);
      for (const std::size_t i : {std::size_t{1}, std::size_t{2}, late}) {
        const KinematicState other = lan.peer(i).ghost(world[name], t);
        ASSERT_EQ(other.position, first.position) << name << " of peer " << i;
        ASSERT_EQ(other.velocity, first.velocity);
        ASSERT_EQ(other.orientation.coeffs(), first.orientation.coeffs());
      }
    }
  }
  const double s = to_seconds(newest - zero);  // 6 s down, 6 s up, from the file's own time 0
  EXPECT_NEAR(lan.peer(1).ghost(world["PLATE"], newest).position.x(), s < 6 ? 10 - s : s - 2, 1e-6);
  for (std::size_t i = 0; i < lan.size(); ++i) EXPECT_EQ(lan.peer(i).counters().updates_out, 0u);
}

// Peer 1 comes into a later session through peer 5, which leaves, or restarts, before it has announced when world time
// began there.
TEST(Predefined, WorldTimeContinuesWhenItsSourceLeaves) {
  for (const auto& [size, restarts] : {std::pair(2u, false), {3u, false}, {2u, true}, {3u, true}}) {
    SCOPED_TRACE(testing::Message() << size << (restarts ? " restarts" : ""));
    const World world(kMachine + box("BALL", "1 1 1", "-30 0 0") + interest("BALL", "\"PLATE\" \"ARM\""));
    Lan lan(world, {20ms, 0ms, 0, 0});
    lan.add(config(1));
    for (std::uint32_t id = 5; lan.size() < size; id += 2) lan.add(config(id), 30s);
    lan.part({0});
    lan.run_until(3s);
    for (const std::size_t i : {0u, 1u}) lan.peer(i).announce_start(lan.session_now(i) + 1s);
    lan.run_until(9500ms);
    lan.part({});
    while (lan.now() < 20s && lan.seen<ClockStepped>(0).empty()) lan.run_until(lan.now() + 10ms);
    ASSERT_FALSE(lan.peer(0).world_zero());
    lan.kill(1);
    if (restarts) {
      PeerConfig anew = config(5);
      ++anew.incarnation;
      lan.restart(1, std::move(anew));
    }
    lan.run_until(lan.now() + 15s);
    ASSERT_TRUE(lan.peer(0).world_zero());
    EXPECT_EQ(lan.peer(0).world_zero(), lan.peer(size - 1 == 1 ? 0 : 2).world_zero());
    const SimTime t = lan.session_now(0);
    EXPECT_NE(lan.peer(0).ghost(world["PLATE"], t).position, lan.peer(0).ghost(world["PLATE"], t - 1s).position);
  }
}

// BALL flies at PLATE, which comes to meet it: both peers predict the time, and the one that only watches needs no
// update.
TEST(Predefined, BouncesWhatItMeets) {
  const World world(kMachine + box("BALL", "1 1 1", "-2 0 0", std::string(kBounces) + "velocityVector 1 0 0 ") +
                    interest("BALL", "\"PLATE\""));
  Lan lan(world, {5ms, 0ms, 0, 0});
  for (const std::uint32_t id : {1u, 2u}) {
    PeerConfig c = config(id, id == 1 ? std::vector<OwnedObject>{{world["BALL"], false}} : std::vector<OwnedObject>{});
    c.wait_for_start = true;
    lan.add(std::move(c));
  }
  lan.run_until(2s);
  const SimTime start = lan.session_now(0) + 1s;
  lan.peer(0).announce_start(start);
  lan.peer(0).start_motions(lan.host_now(0), start);
  lan.run_until(11s);
  const auto met = lan.contacts(0, ContactKind::kOwner);
  ASSERT_THAT(met, SizeIs(1));
  // The fronts are at -1.5 + t and 9.5 - t.
  EXPECT_NEAR(to_seconds(met[0].contact.at - start), 5.5, 1e-8);
  // The response INVERSE against an object that does not answer mirrors the relative velocity: 1 becomes -1 - 2 = -3.
  EXPECT_NEAR(met[0].contact.collider_after.velocity.x(), -3.0, 1e-7);
  const auto predicted = lan.contacts(1, ContactKind::kPredicted);
  ASSERT_THAT(predicted, SizeIs(1));
  EXPECT_LE(std::chrono::abs(predicted[0].contact.at - met[0].contact.at), 1us);
  for (const Published& p : lan.seen<Published>(0)) {
    EXPECT_NE(p.reason, PublishReason::kError) << "everybody saw the bounce coming";
  }
}

TEST(Predefined, ABodyThatChangesItsShapeIsAFlexiblePart) {
  const World world(
      "DEF PRESS Transform { children [ Shape { geometry Box { } } DEF PLUNGER Transform { children Shape { geometry "
      "Box { } } } ] }" +
      box("BALL", "1 1 1", "-30 0 0") + interest("BALL", "\"PRESS\"") +
      "DEF T TimeSensor { loop TRUE } DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0 0 1 0 ] }"
      "ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO PLUNGER.scale");
  EXPECT_THAT(world.model->unsupported, IsEmpty());
  ASSERT_THAT(world.model->flexible, SizeIs(1));
  EXPECT_EQ(world.scene.path_of(world.model->flexible[0].shape), "PRESS/PLUNGER/0");
}

}  // namespace peerd::replication::test::predefined_test
