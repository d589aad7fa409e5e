// Small worlds in which something carries something: each contact that CollisionWatch finds at 1,000 Hz is found by
// every peer, whoever owns what.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "collision/scene/collision_watch.hpp"
#include "core/motion/scene_motion.hpp"
#include "core/scene/reader.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::carriers_test {

using peerd::testing_support::ScratchFolder;
using testing_support::Ran;
using testing_support::run_scenario;

constexpr double kDuration_s = 8.0, kReference_hz = 1000.0, kLatency_s = 0.1, kAgreed_s = 0.002;

// ---- worlds ----

std::string box(const std::string& name, const std::string& size, const std::string& at, const std::string& fields = "",
                const std::string& children = "") {
  return "DEF " + name + " Transform { translation " + at + " " + fields + " children [ Shape { geometry Box { size " +
         size + " } } " + children + "] }\n";
}
std::string interest(const std::string& collider, const std::string& collidees, int type = 1) {
  return "CollisionInterest { objectPath \"" + collider + "\" interests [ " + collidees + " ] collisionType " +
         std::to_string(type) + " }\n";
}
const std::string kClock = "DEF CLOCK TimeSensor { cycleInterval 4 loop TRUE }\n";
std::string slides(const std::string& object, const std::string& there, const std::string& back) {
  return "DEF PATH PositionInterpolator { key [ 0 0.5 1 ] keyValue [ " + there + ", " + back + ", " + there + " ] }\n" +
         "ROUTE CLOCK.fraction_changed TO PATH.set_fraction\nROUTE PATH.value_changed TO " + object +
         ".set_translation\n";
}
std::string turns(const std::string& object) {
  return "DEF ROUND OrientationInterpolator { key [ 0 0.25 0.5 0.75 1 ] keyValue [ 0 1 0 0, 0 1 0 1.5707963, "
         "0 1 0 3.1415926, 0 1 0 4.712389, 0 1 0 6.2831853 ] }\n"
         "ROUTE CLOCK.fraction_changed TO ROUND.set_fraction\nROUTE ROUND.value_changed TO " +
         object + ".set_rotation\n";
}

const std::string kWheel = box("CAR", "4 1 2", "0 2 0", "velocityVector 3 0 0", box("WHEEL", "1 1 0.4", "1 -1 0")) +
                           box("CURB", "0.5 0.6 4", "8 0.5 0") + interest("WHEEL", "\"CURB\"");

const std::string kPlatform = box("PLATFORM", "2 0.2 2", "0 0 0") + box("WALL", "1 4 4", "5 0 0") + kClock +
                              slides("PLATFORM", "0 0 0", "6 0 0") + interest("PLATFORM", "\"WALL\"");

const std::string kFlyer = box("FLYER", "1 1 1", "0 0 0", "velocityVector 2 0 0") + box("WALL", "1 4 4", "5 0 0") +
                           interest("FLYER", "\"WALL\"");

const std::string kBus = box("BUS", "8 0.2 3", "0 0 0", "velocityVector 5 0 0",
                             box("DOOR", "1 2 0.1", "0 1 1.5") + box("POST", "0.1 2 0.1", "2 1 1.5")) +
                         box("LAMP", "0.2 5 0.2", "12 1 1.6") + kClock + slides("DOOR", "0 1 1.5", "3 1 1.5") +
                         interest("DOOR", "\"POST\" \"LAMP\"");

// The door slides by its velocity in the bus.
const std::string kSlidingDoor =
    box("BUS", "8 0.2 3", "0 0 0", "velocityVector 5 0 0",
        box("DOOR", "1 2 0.1", "-3 1 1.5", "velocityVector 1 0 0") + box("POST", "0.1 2 0.1", "2 1 1.5")) +
    box("LAMP", "0.2 5 0.2", "12 1 1.6") + interest("DOOR", "\"POST\" \"LAMP\"");

const std::string kArm = "DEF ARM Transform { scale 1 2 -1 children " + box("HAND", "0.5 0.5 0.5", "3 0.2 0.5") +
                         "}\n" + box("BALL", "0.6 0.6 0.6", "0 0.4 3") + kClock + turns("ARM") +
                         interest("HAND", "\"BALL\"");

const std::string kArmOnABus =
    box("BUS", "2 0.2 1", "0 0 0", "velocityVector 1 0 0",
        "DEF ARM Transform { translation 0 1 0 children " + box("HAND", "0.5 0.5 0.5", "3 0.2 0.5") + "}\n") +
    box("NEAR", "0.6 0.6 0.6", "5 1.4 3") + box("FAR", "0.6 0.6 0.6", "10 1.4 3") + kClock + turns("ARM") +
    interest("BUS", "\"NEAR\" \"FAR\"") + interest("BUS", "\"FAR\"", 0) + interest("HAND", "\"NEAR\" \"FAR\"", 2);

// ---- what happens in them ----

struct Contact {
  ObjectId collider, collidee;
  double began_s = 0.0, ended_s = INFINITY;
};

// All contacts, tick by tick. Those of two interests in one pair are several.
std::vector<Contact> contacts_of(const std::string& text) {
  const ReadResult read = read_world(text);
  const Scene& scene = read.scene.value();
  collision::CollisionWatch watch(scene);
  SceneMotion motion(scene);
  std::vector<Contact> contacts;
  std::map<std::uint32_t, std::size_t> open;  // by interest, into contacts
  for (int k = 0; k / kReference_hz <= kDuration_s; ++k) {
    const double t_s = k / kReference_hz;
    watch.set_transforms(motion.transforms_at(t_s));
    const auto& tick = watch.tick();
    EXPECT_TRUE(tick.refused.empty());
    for (const std::uint32_t i : tick.ended) {
      contacts[open.at(i)].ended_s = t_s;
      open.erase(i);
    }
    for (const std::uint32_t i : tick.began) {
      open.emplace(i, contacts.size());
      contacts.push_back({watch.interests()[i].collider, watch.interests()[i].collidee, t_s, INFINITY});
    }
  }
  return contacts;
}

std::string scenario_of(const std::vector<std::vector<std::string>>& owned) {
  std::string text =
      "world = \"w.wrl\"\nduration_s = " + std::to_string(kDuration_s) + "\n[network]\nlatency_ms = 100\n";
  for (std::size_t i = 0; i < 3; ++i) {
    text += "[peer." + std::string(1, static_cast<char>('a' + i)) + "]\nid = " + std::to_string(i + 1) + "\nowns = [";
    if (i < owned.size()) {
      for (const std::string& path : owned[i]) text += " \"" + path + "\",";
    }
    text += " ]\n";
  }
  return text;
}

struct Case {
  const char* name;
  std::string world;
  std::vector<std::vector<std::string>> owned;  // by peer
  std::size_t contacts;                         // that have to be found
};
class CarriedWorlds : public testing::TestWithParam<Case> {};

TEST_P(CarriedWorlds, EveryPeerFindsWhatCollideFindsAndNoMore) {
  const Case& c = GetParam();
  const std::string text = "#VRML V2.0 utf8\n" + c.world;
  const ScratchFolder folder;
  folder.write("w.wrl", text);
  const Ran ran = run_scenario(folder.write("s.toml", scenario_of(c.owned))).front();
  std::size_t expected = 0;
  const auto contacts = contacts_of(text);
  for (const Contact& contact : contacts) {
    // Until an update has arrived, a peer does not know how what another one owns has begun to move.
    ASSERT_GT(contact.began_s, kLatency_s + 0.01) << "the world is made so that it does not depend on this";
    if (contact.began_s > kDuration_s - 0.1) continue;
    ASSERT_GE(contact.ended_s - contact.began_s, 0.0015) << "and its contacts last";
    ++expected;
    for (const std::uint32_t peer : {1u, 2u, 3u}) {
      double nearest_s = INFINITY;
      for (const measure::ContactRow& row : ran.record.contacts) {
        const bool same = row.collider == contact.collider && row.collidee == contact.collidee;
        const bool turned = row.collider == contact.collidee && row.collidee == contact.collider;
        if (row.peer != PeerId{peer} || !(same || turned)) continue;
        if (std::abs(row.t_s - contact.began_s) < std::abs(nearest_s)) nearest_s = row.t_s - contact.began_s;
      }
      EXPECT_LE(std::abs(nearest_s), kAgreed_s) << "peer " << peer << ": " << contact.collider.number << " against "
                                                << contact.collidee.number << " at " << contact.began_s << " s";
    }
  }
  EXPECT_EQ(expected, c.contacts);
  for (const measure::ContactRow& row : ran.record.contacts) {
    const bool there = std::ranges::any_of(contacts, [&](const Contact& contact) {
      const bool same = row.collider == contact.collider && row.collidee == contact.collidee;
      const bool turned = row.collider == contact.collidee && row.collidee == contact.collider;
      return (same || turned) && std::abs(row.t_s - contact.began_s) <= kAgreed_s;
    });
    EXPECT_TRUE(there) << "peer " << row.peer.value << " has " << row.kind << " of " << row.collider.number
                       << " against " << row.collidee.number << " at " << row.t_s << " s";
  }
}

using Owned = std::vector<std::vector<std::string>>;
INSTANTIATE_TEST_SUITE_P(
    Table, CarriedWorlds,
    testing::Values(
        // The wheel of a car against a curb (Ohlenburg 2003, 3.3).
        Case{"WheelOfNobody", kWheel, {}, 1}, Case{"WheelOfAnOwnedCar", kWheel, {{"CAR"}}, 1},
        Case{"OwnedWheelOfNobodysCar", kWheel, {{}, {"CAR/WHEEL"}}, 1},
        Case{"CarAndWheelOfTwo", kWheel, {{"CAR"}, {"CAR/WHEEL"}}, 1},
        Case{"WheelAndCarOfTwo", kWheel, {{"CAR/WHEEL"}, {"CAR"}}, 1},
        Case{"CarWheelAndCurbOfThree", kWheel, {{"CAR"}, {"CAR/WHEEL"}, {"CURB"}}, 1},
        Case{"CarAndWheelOfOne", kWheel, {{}, {"CAR", "CAR/WHEEL"}}, 1},
        // A platform that a ROUTE moves against a wall.
        Case{"PlatformOfNobody", kPlatform, {}, 2}, Case{"PlatformAndOwnedWall", kPlatform, {{}, {"WALL"}}, 2},
        // What a velocityVector moves against a wall.
        Case{"FlyerOfNobody", kFlyer, {}, 1}, Case{"OwnedFlyer", kFlyer, {{"FLYER"}}, 1},
        Case{"FlyerAndWallOfTwo", kFlyer, {{"WALL"}, {"FLYER"}}, 1},
        // A door that slides in a moving bus against a post of the bus, and against a lamp outside.
        Case{"BusOfNobody", kBus, {}, 5}, Case{"OwnedBus", kBus, {{"BUS"}}, 5},
        Case{"BusAndLampOfTwo", kBus, {{"BUS"}, {"LAMP"}}, 5},
        Case{"OwnedPostInAnothersBus", kBus, {{"BUS/POST"}, {"BUS"}}, 5},
        Case{"SlidingDoorOfNobody", kSlidingDoor, {}, 2},
        Case{"OwnedDoorInAnothersBus", kSlidingDoor, {{"BUS"}, {"BUS/DOOR"}}, 2},
        Case{"OwnedDoorInALaterPeersBus", kSlidingDoor, {{"BUS/DOOR"}, {"BUS"}}, 2},
        Case{"DoorPostAndLampOfThree", kSlidingDoor, {{"BUS/DOOR"}, {"BUS", "LAMP"}, {"BUS/POST"}}, 2},
        // The hand of a turning, unevenly scaled, mirrored arm against a ball.
        Case{"ArmOfNobody", kArm, {}, 2}, Case{"ArmAndOwnedBall", kArm, {{"BALL"}}, 2},
        Case{"OwnedHandOfNobodysArm", kArm, {{}, {"ARM/HAND"}}, 2},
        Case{"HandAndBallOfTwo", kArm, {{"BALL"}, {"ARM/HAND"}}, 2},
        // An arm on a bus: parts of an end, boxes of an end of several parts, all pairs.
        Case{"ArmOnABusOfNobody", kArmOnABus, {}, 5}, Case{"ArmOnAnOwnedBus", kArmOnABus, {{"BUS"}}, 5},
        Case{"ArmOnABusAndItsHandOfTwo", kArmOnABus, {{"BUS"}, {"BUS/ARM/HAND"}}, 5},
        Case{"ArmOnABusAndWhatItMeets", kArmOnABus, {{"BUS"}, {"NEAR"}, {"FAR"}}, 5}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace peerd::sim::carriers_test
