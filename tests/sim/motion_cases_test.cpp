// Starts and networks at which motion once went wrong, one scenario each: what rests must rest, what is shut in must
// stay in, no energy comes from nowhere, and peers decide once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::motion_cases_test {

using peerd::testing_support::ScratchFolder;
using testing_support::Ran;
using testing_support::run_scenario;

struct BodyText {
  std::string name, place, velocity, response, geometry;
  std::string fields = "";
};

std::string impulse(double mass_kg, double restitution, double friction) {
  std::ostringstream text;
  text.precision(12);
  text << "responseType 2 mass " << mass_kg << " restitution " << restitution << " friction " << friction;
  return text.str();
}
const char* const kInverse = "responseType 0";
const char* const kZero = "responseType 1";

std::string ball(const std::string& radius) { return "Sphere { radius " + radius + " }"; }

// The bodies, each with an interest in all others and in `walls`.
std::string bodies(const std::vector<BodyText>& all, const std::string& walls, int collision_type = 1) {
  std::ostringstream text;
  for (const BodyText& b : all) {
    text << "DEF " << b.name << " Transform { translation " << b.place << " distanceThreshold 0.01 velocityVector "
         << b.velocity << " collisionResponse CollisionResponse { " << b.response << " } " << b.fields
         << " children Shape { geometry " << b.geometry << " } }\n";
    text << "CollisionInterest { collisionType " << collision_type << " objectPath \"" << b.name << "\" interests ["
         << walls;
    for (const BodyText& other : all) {
      if (other.name != b.name) text << " \"" << other.name << '"';
    }
    text << "] }\n";
  }
  return text.str();
}

const char* const kWalls = R"("W0m" "W0p" "W1m" "W1p" "W2m" "W2p")";

// A closed room of +-3 m, whose walls are that thick.
std::string room(double thick_m) {
  std::ostringstream text;
  const double width = 6.0 + 2.0 * thick_m, at = 3.0 + 0.5 * thick_m;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      std::vector<double> place(3, 0.0), size(3, width);
      place[std::size_t(axis)] = side * at;
      size[std::size_t(axis)] = thick_m;
      text << "DEF W" << axis << (side < 0 ? 'm' : 'p') << " Transform { translation " << place[0] << ' ' << place[1]
           << ' ' << place[2] << " children Shape { geometry Box { size " << size[0] << ' ' << size[1] << ' ' << size[2]
           << " } } }\n";
    }
  }
  return text.str();
}

Ran run(const std::string& world, const std::string& scenario) {
  const ScratchFolder folder;
  folder.write("w.wrl", "#VRML V2.0 utf8\n" + world);
  const auto file = folder.write("s.toml", "world = \"w.wrl\"\n" + scenario);
  return std::move(run_scenario(file).front());
}

// What an owner knows of its own objects.
struct Truth {
  double farthest_m = 0.0;  // the largest coordinate at any time
  double fastest_m_s = 0.0;
  Vec3 last_place = Vec3::Zero(), last_velocity = Vec3::Zero();
};
std::map<std::string, Truth> truths(const Ran& ran, const std::string& world) {
  const auto scene = std::move(read_world("#VRML V2.0 utf8\n" + world).scene.value());
  std::map<std::string, Truth> all;
  for (const PeerLog& log : ran.logs) {
    for (const auto& sample : log.object_samples) {
      if (sample.owner != log.peer) continue;
      Truth& truth = all[std::string(scene.path_of(sample.object))];
      truth.farthest_m = std::max(truth.farthest_m, sample.state.position.cwiseAbs().maxCoeff());
      truth.fastest_m_s = std::max(truth.fastest_m_s, sample.state.velocity.norm());
      truth.last_place = sample.state.position;
      truth.last_velocity = sample.state.velocity;
    }
  }
  return all;
}

void expect_all_inside(const Ran& ran, const std::string& world) {
  const auto all = truths(ran, world);
  EXPECT_FALSE(all.empty());
  for (const auto& [name, truth] : all) EXPECT_LT(truth.farthest_m, 3.0) << name;
  EXPECT_EQ(ran.summary["counters"]["contacts_capped"], 0);
  EXPECT_EQ(ran.summary["collisions"]["shared"]["disagreed"], 0);
}

const std::string kTwoPeers = "[decisions]\npolicy = \"id\"\n[network]\nlatency_ms = 50\n[peer.b]\nid = 2\n";

// A ball on a floor, or a little above it.
void rests_from(const std::string& height) {
  SCOPED_TRACE(height);
  for (const char* const geometry : {"Sphere { radius 0.5 }", "Box { size 1 1 1 }"}) {
    const std::string world =
        "DEF F Transform { translation 0 -0.5 0 children Shape { geometry Box { size 100 1 100 } } }\n" +
        bodies({{"A", "0.2 " + height + " 0.1", "0 0 0", impulse(1, 0.3, 0), geometry}}, "\"F\"");
    const Ran ran =
        run(world, "duration_s = 10\nsample_hz = 10\n[motion.A]\nphysics = { acceleration = [0, -9.81, 0] }\n" +
                       kTwoPeers + "[peer.a]\nid = 1\nowns = [\"A\"]\n");
    const Truth truth = truths(ran, world).at("A");
    EXPECT_NEAR(truth.last_place.y(), 0.5, 1e-6);
    EXPECT_EQ(truth.last_velocity, Vec3::Zero());
    EXPECT_LE(ran.summary["counters"]["contacts"].get<int>(), 3);
  }
}
TEST(MotionCase, ABallALittleAboveAFloorComesToRest) {
  rests_from("0.50000006");
  rests_from("0.5000002");
}
TEST(MotionCase, ABallThatTouchesTheFloorRests) { rests_from("0.5"); }

TEST(MotionCase, TouchingBallsOfEqualVelocityDoNotCollide) {
  const std::string world = bodies({{"B0", "0 0 0", "2 0 0", impulse(1, 1, 0), ball("0.5")},
                                    {"B1", "1 0 0", "2 0 0", impulse(1, 1, 0), ball("0.5")}},
                                   "");
  const Ran ran =
      run(world, "duration_s = 5\nsample_hz = 10\n" + kTwoPeers + "[peer.a]\nid = 1\nowns = [\"B0\", \"B1\"]\n");
  EXPECT_EQ(ran.summary["counters"]["contacts"], 0);
  for (const auto& [name, truth] : truths(ran, world)) EXPECT_EQ(truth.last_velocity, Vec3(2, 0, 0)) << name;
}

TEST(MotionCase, ACradleHandsOverInAHandfulOfContacts) {
  std::vector<BodyText> balls{{"B0", "0 0 0", "2 0 0", impulse(1, 1, 0), ball("0.5")}};
  std::string names = "\"B0\"";
  for (int i = 1; i < 6; ++i) {
    balls.push_back({"B" + std::to_string(i), std::to_string(3 + i) + " 0 0", "0 0 0", impulse(1, 1, 0), ball("0.5")});
    names += ", \"B" + std::to_string(i) + '"';
  }
  const std::string world = bodies(balls, "");
  const Ran ran =
      run(world, "duration_s = 5\nsample_hz = 10\n" + kTwoPeers + "[peer.a]\nid = 1\nowns = [" + names + "]\n");
  const auto all = truths(ran, world);
  EXPECT_EQ(all.at("B5").last_velocity, Vec3(2, 0, 0));
  EXPECT_EQ(all.at("B0").last_velocity, Vec3::Zero());
  EXPECT_LE(ran.summary["counters"]["contacts"].get<int>(), 15) << "five in each world";
  EXPECT_EQ(ran.summary["counters"]["contacts_undone"], 0);
  EXPECT_EQ(ran.summary["counters"]["contacts_capped"], 0);
}

TEST(MotionCase, ALightBallBetweenAWallAndAHeavyOneSendsItBack) {
  const std::string world =
      "DEF W Transform { translation -1 0 0 children Shape { geometry Box { size 2 10 10 } } }\n" +
      bodies({{"A", "2 0 0", "0 0 0", impulse(1, 1, 0), ball("0.5")},
              {"H", "6 0 0", "-1 0 0", impulse(1e5, 1, 0), ball("0.5")}},
             "\"W\"");
  const Ran ran =
      run(world, "duration_s = 60\nsample_hz = 20\n" + kTwoPeers + "[peer.a]\nid = 1\nowns = [\"A\", \"H\"]\n");
  EXPECT_EQ(ran.contacts(PeerId{1}, "owner").size(), 993u);
  EXPECT_EQ(ran.summary["counters"]["jammed"], 0);
  const auto all = truths(ran, world);
  EXPECT_GT(all.at("H").last_velocity.x(), 0.99);
  const double energy = 1e5 * all.at("H").last_velocity.squaredNorm() + all.at("A").last_velocity.squaredNorm();
  EXPECT_NEAR(energy / 1e5, 1.0, 1e-9);
}

TEST(MotionCase, ResponsesOfTwoTypesMakeNoEnergy) {
  const std::string world = room(1.0) + bodies({{"A", "1 0 0", "1 0 0", impulse(1, 1, 0), ball("0.3")},
                                                {"I", "-1 0 0", "10 0 0", kInverse, ball("0.3")}},
                                               kWalls);
  const Ran ran =
      run(world, "duration_s = 8\nsample_hz = 200\n" + kTwoPeers + "[peer.a]\nid = 1\nowns = [\"A\", \"I\"]\n");
  expect_all_inside(ran, world);
  const auto all = truths(ran, world);
  EXPECT_LE(all.at("A").fastest_m_s, 10.0 * (1.0 + 1e-12));
  EXPECT_LE(all.at("I").fastest_m_s, 10.0 * (1.0 + 1e-12));
}

TEST(MotionCase, ADropOfLatencyAppliesNoDecisionTwice) {
  const std::string world =
      room(2.0) + bodies({{"A", "-2 2 -2", "5.7 1.3 7.8", impulse(1, 1, 0), "Box { size 0.75 0.38 0.57 }",
                           "rotation 0.8 1 -0.2 5.6"},
                          {"B", "0 2 -2", "7.4 2.3 -4.8", impulse(1, 1, 2), ball("0.24"), "scale 0.6 0.9 1.1"}},
                         kWalls);
  const Ran ran = run(world,
                      "duration_s = 14\nsample_hz = 20\n[network]\nlatency_ms = 800\n[peer.a]\nid = 1\nowns = [\"A\"]\n"
                      "[peer.b]\nid = 2\nowns = [\"B\"]\n[event.e]\nat_s = 8\nkind = \"network\"\nlatency_ms = 20\n");
  expect_all_inside(ran, world);
}

TEST(MotionCase, ADecisionFromBeforeAnOwnersLifeIsVoid) {
  const std::string world =
      room(1.0) + bodies({{"A", "-1.5 -1.5 -1.5", "-13.9 -35.8 -39.4", impulse(100, 1, 0.3),
                           "Cylinder { radius 0.23 height 0.23 }", "scale 1.16 0.68 1.19"},
                          {"B", "1.5 1.5 -1.5", "0.43 0.35 -0.08", impulse(5, 0, 2), "Box { size 0.78 0.39 0.58 }"}},
                         kWalls, 2);
  const Ran ran = run(
      world,
      "duration_s = 14\nsample_hz = 20\n[motion.A]\nphysics = { acceleration = [0, -9.81, 0] }\n[motion.B]\n"
      "physics = { acceleration = [0, -1, 0] }\n[peer.a]\nid = 1\nowns = [\"A\"]\n[peer.b]\nid = 2\nowns = [\"B\"]\n"
      "[event.e1]\nat_s = 0.853\nkind = \"leave\"\npeer = \"b\"\n[event.e2]\nat_s = 1.353\nkind = \"join\"\npeer = "
      "\"b\"\n");
  expect_all_inside(ran, world);
}

TEST(MotionCase, WhatAHeavyBallPressesIntoACornerStaysIn) {
  const std::string world = room(0.2) + bodies({{"I", "2 0 -2", "3.4 13.6 -33.6", kInverse,
                                                 "Box { size 0.216 0.108 0.162 }", "rotation -0.134 1 0.165 4.446"},
                                                {"H", "-2 2 -2", "24.9 -19.4 32.1", impulse(100, 1, 0), ball("0.36")},
                                                {"L", "-2 -2 0", "24.1 -16.5 -33.7", impulse(5, 0, 0), ball("0.4")}},
                                               kWalls, 0);
  const Ran ran =
      run(world,
          "duration_s = 14\nsample_hz = 20\n[decisions]\npolicy = \"server\"\nserver = \"c\"\n[network]\n"
          "latency_ms = 5\njitter_ms = 10\nduplication = 0.1\nreordering = 0.1\n[peer.a]\nid = 1\nowns = [\"H\"]\n"
          "[peer.b]\nid = 2\nowns = [\"L\"]\n[peer.c]\nid = 3\nowns = [\"I\"]\n");
  expect_all_inside(ran, world);
}

// An L, 0.6 m wide: not convex.
const char* const kCornerPiece =
    "IndexedFaceSet { solid FALSE convex FALSE coord Coordinate { point [0 0 0, .6 0 0, .6 .2 0, .2 .2 0, .2 .6 0, 0 "
    ".6 0, "
    "0 0 .3, .6 0 .3, .6 .2 .3, .2 .2 .3, .2 .6 .3, 0 .6 .3] } coordIndex [5 4 3 2 1 0 -1, 6 7 8 9 10 11 -1, 0 1 7 6 "
    "-1, "
    "1 2 8 7 -1, 2 3 9 8 -1, 3 4 10 9 -1, 4 5 11 10 -1, 5 0 6 11 -1] }";

TEST(MotionCase, FiveBodiesOfThreePeersStayIn) {
  const std::string world =
      room(0.2) +
      bodies({{"O2", "2 -2 -2", "7.5 -9.8 8.7", impulse(100, 0, 0.3), "Cone { bottomRadius 0.31 height 0.63 }"},
              {"O3", "-2 0 -2", "5.4 10 6.2", impulse(1, 0.9, 0.3), kCornerPiece, "scale 0.82 0.88 1.16"},
              {"O5", "2 0 -2", "-2.7 -39.3 37.3", impulse(5, 0.5, 0), "Box { size 0.63 0.31 0.47 }"},
              {"O6", "-2 2 -2", "-9.3 6.3 -8.4", kInverse, kCornerPiece, "rotation -0.49 1 0.29 4.26"},
              {"O7", "0 2 -2", "-14.2 13.4 -1.5", impulse(100, 0.5, 2), ball("0.1")}},
             kWalls);
  const Ran ran =
      run(world,
          "duration_s = 14\nsample_hz = 20\n[network]\nlatency_ms = 50\n[peer.a]\nid = 1\nowns = [\"O5\", \"O6\", "
          "\"O7\"]\ntick_hz = 33\n[peer.b]\nid = 2\nowns = [\"O2\"]\n[peer.c]\nid = 3\nowns = [\"O3\"]\n"
          "tick_hz = 33\n");
  expect_all_inside(ran, world);
}

TEST(MotionCase, AnInverseBodyAmongOthersAtALongLatencyGainsNothing) {
  const std::string world =
      room(1.0) +
      bodies({{"O0", "-1.5 -1.5 -1.5", "-8.5 -6.9 -4.5", impulse(1, 1, 0), "Cylinder { radius 0.36 height 0.36 }"},
              {"O2", "-1.5 1.5 -1.5", "21.1 -6.5 -38.3", kInverse, "Cone { bottomRadius 0.17 height 0.33 }",
               "rotation -0.84 1 0.54 4.46"},
              {"O3", "1.5 1.5 -1.5", "0.18 0.48 0.15", impulse(100, 1, 2), ball("0.124")},
              {"O4", "-1.5 -1.5 1.5", "5.6 9.4 -2.4", impulse(100, 1, 0), "Cylinder { radius 0.39 height 0.39 }",
               "rotation 0.33 1 0.59 1.74"}},
             kWalls);
  const Ran ran =
      run(world,
          "duration_s = 6\nsample_hz = 20\n[decisions]\npolicy = \"id\"\n[network]\nlatency_ms = 800\nloss = 0.05\n"
          "duplication = 0.1\n[peer.a]\nid = 1\nowns = [\"O3\"]\n[peer.b]\nid = 2\n[peer.c]\nid = 3\nowns = "
          "[\"O4\"]\n[peer.d]\nid = 4\nowns = [\"O0\"]\n[peer.e]\nid = 5\nowns = [\"O2\"]\n");
  expect_all_inside(ran, world);
}

// Peers that saw a pair meet at one instant, with other normals.
TEST(MotionCase, APairOfOneInstantIsDecidedOnce) {
  const std::string falls = "acceleration = [0, -9.81, 0]", slow = "acceleration = [0, -1, 0]";
  const std::string world =
      room(1.0) +
      bodies({{"O1", "0 -2 -2", "-7.1 6.6 -7.8", impulse(1, 0, 0.3), "Cylinder { radius 0.27 height 0.27 }",
               "scale 0.64 1.04 0.52"},
              {"O2", "2 -2 -2", "27.6 -12 -35.7", kZero, "Cylinder { radius 0.23 height 0.23 }"},
              {"O4", "0 0 -2", "-1.2 -1.3 1.2", impulse(1, 0, 0), kCornerPiece, "rotation 0.54 1 -0.29 1.49"},
              {"O6", "-2 2 -2", "-2.2 1.8 -2.2", impulse(100, 1, 0), "Cone { bottomRadius 0.18 height 0.36 }"},
              {"O7", "0 2 -2", "6.8 -2.2 8.1", impulse(1, 0, 2), "Cylinder { radius 0.27 height 0.27 }"}},
             kWalls);
  std::string motion;
  for (const char* const name : {"O1", "O2", "O4", "O6"})
    motion += std::string("[motion.") + name + "]\nphysics = { " + slow + " }\n";
  const Ran ran = run(world,
                      "duration_s = 7\nsample_hz = 20\n[decisions]\npolicy = \"velocity\"\n[network]\n"
                      "latency_ms = 500\njitter_ms = 10\n" +
                          motion + "[motion.O7]\nphysics = { " + falls +
                          " }\n"
                          "[peer.a]\nid = 1\n[peer.b]\nid = 2\nowns = [\"O2\"]\n[peer.c]\nid = 3\nowns = [\"O7\"]\n"
                          "[peer.d]\nid = 4\nowns = [\"O1\", \"O4\", \"O6\"]\nclock_offset_s = -0.5\n");
  expect_all_inside(ran, world);
}

}  // namespace peerd::sim::motion_cases_test
