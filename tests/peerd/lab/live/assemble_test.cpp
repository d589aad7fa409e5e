#include "peerd/lab/live/assemble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::assemble_test {

using testing::HasSubstr;

constexpr PeerId kA{1}, kB{2};
constexpr ObjectId kCar{0}, kCube{1};
// The session's clock is at this when the scenario starts; the true clock's start is elsewhere.
constexpr SimTime kStart{std::chrono::seconds(5000)};
constexpr HostTime kTrueStart{std::chrono::seconds(900)};

Duration seconds(double s) { return from_seconds(s); }

// Peers a, which drives CAR by a formula, and b, which lets CUBE move by itself. Logs are made by hand.
class AssembleTest : public testing::Test {
 protected:
  AssembleTest() {
    shared = *share_world(
        folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { }\nDEF CUBE Transform { }\nDEF WALL Shape { }\n"));
    run.duration_s = 10;
    run.params = {{"replication.order", 2}};
    config::PeerSettings a, b;
    a.name = "a", a.id = 1, a.owns = {"CAR"}, std::get<motion::MotionFormula>(a.motion["CAR"].kind).x = "t^2";
    b.name = "b", b.id = 2, b.owns = {"CUBE"};
    run.peers = {a, b};
    for (const auto& [peer, name] : {std::pair{kA, "a"}, std::pair{kB, "b"}}) {
      logs.push_back({.peer = peer, .name = name, .start = kStart});
    }
  }
  // A row of a peer's log; its session clock is `ahead_s` ahead of the founder's.
  void believe(PeerId peer, double true_s, ObjectId object, PeerId owner, const Vec3& at, double ahead_s = 0,
               const Vec3& v = Vec3::Zero()) {
    const KinematicState s{.position = at, .velocity = v};
    logs[peer.value - 1].object_samples.push_back(
        {kStart + seconds(true_s + ahead_s), kTrueStart + seconds(true_s), object, owner, s});
  }
  measure::RunRecord record() {
    auto made = assemble(run, *shared, logs);
    if (!made) {
      ADD_FAILURE() << made.error().text;
      return {};
    }
    return *std::move(made);
  }

  testing_support::ScratchFolder folder;
  std::unique_ptr<const SharedWorld> shared;
  config::RunSettings run;
  std::vector<PeerLog> logs;
};

TEST_F(AssembleTest, ADrivenObjectsTruthIsItsFormulaBetweenTheOwnersTicks) {
  for (const double t : {1.0, 2.0, 3.0}) believe(kA, t, kCar, kA, {t * t, 0, 0});
  believe(kB, 2.5, kCar, kA, {6, 0, 0});
  const auto r = record();
  ASSERT_EQ(r.ghost_samples.size(), 1u);
  EXPECT_EQ(r.ghost_samples[0].observer, kB);
  EXPECT_DOUBLE_EQ(r.ghost_samples[0].t_s, 2.5);
  EXPECT_NEAR(r.ghost_samples[0].truth.position.x(), 6.25, 1e-9) << "not the 6.5 between its samples";
  EXPECT_EQ(r.ghost_samples[0].ghost.position.x(), 6.0);
}

TEST_F(AssembleTest, AnotherObjectsTruthIsInterpolatedBetweenTheOwnersTicks) {
  believe(kB, 1.0, kCube, kB, {0, 0, 0});
  believe(kB, 2.0, kCube, kB, {0, 0, -8}, 0, {0, 0, -2});
  for (const double t : {1.0, 1.25, 2.0, 2.5}) believe(kA, t, kCube, kB, Vec3::Zero());
  const auto r = record();
  ASSERT_EQ(r.ghost_samples.size(), 4u);
  EXPECT_NEAR(r.ghost_samples[0].truth.position.z(), 0.0, 1e-9);
  EXPECT_NEAR(r.ghost_samples[1].truth.position.z(), -2.0, 1e-9);
  EXPECT_NEAR(r.ghost_samples[2].truth.position.z(), -8.0, 1e-9) << "exactly at a tick";
  EXPECT_NEAR(r.ghost_samples[3].truth.position.z(), -9.0, 1e-9) << "after the last, as that one moved";
}

TEST_F(AssembleTest, WhatRestsIsWhereItIsToTheLastBit) {
  const Vec3 at(0.1, -1.0 / 3.0, 1e-3 / 7.0);
  for (const double t : {1.0, 2.0}) believe(kB, t, kCube, kB, at);
  for (int i = 0; i < 100; ++i) believe(kA, 1.0 + 0.01 * i, kCube, kB, at);
  for (const auto& belief : record().ghost_samples) EXPECT_EQ(belief.truth.position, at);
}

TEST_F(AssembleTest, OrientationIsInterpolatedToo) {
  believe(kB, 1.0, kCube, kB, {0, 0, 0});
  believe(kB, 2.0, kCube, kB, {0, 0, 0});
  logs[1].object_samples[1].state.orientation = Quat(Eigen::AngleAxisd(0.8, Vec3::UnitY()));
  believe(kA, 1.25, kCube, kB, Vec3::Zero());
  const auto r = record();
  EXPECT_NEAR(angle_between(r.ghost_samples[0].truth.orientation, Quat::Identity()), 0.2, 1e-9);
}

// b's session clock runs 0.4 s ahead of a's: what it believes of t is what it believes when a's clock says t - 0.4. The
// rows are laid side by side in true time, so the error shows.
TEST_F(AssembleTest, AnErrorOfTheSessionClockIsNotHidden) {
  for (const double t : {1.0, 2.0, 3.0}) believe(kA, t, kCar, kA, {t * t, 0, 0});
  believe(kB, 2.0, kCar, kA, {2.4 * 2.4, 0, 0}, 0.4);  // a perfect belief of the time that its clock shows
  const auto r = record();
  ASSERT_EQ(r.ghost_samples.size(), 1u);
  EXPECT_NEAR(r.ghost_samples[0].t_s, 2.0, 1e-9) << "the owner's time at that instant";
  EXPECT_NEAR(r.ghost_samples[0].truth.position.x(), 4.0, 1e-9);
  EXPECT_NEAR(r.ghost_samples[0].ghost.position.x(), 5.76, 1e-9);
}

TEST_F(AssembleTest, WhatIsBeforeTheStartOrAfterTheEndIsLeftOut) {
  for (const double t : {-1.0, 5.0, 11.0}) believe(kA, t, kCar, kA, {t * t, 0, 0});
  for (const double t : {-0.01, 0.0, 10.0, 10.01}) believe(kB, t, kCar, kA, Vec3::Zero());
  for (const double t : {-0.01, 0.0, 10.0, 10.01}) {
    logs[0].updates.push_back({kStart + seconds(t), kCar, 30, 0.5, "error"});
    logs[0].datagrams.push_back({kStart + seconds(t), 60});
    logs[0].contacts.push_back({kStart + seconds(t), "owner", kCar, kCube, Vec3::UnitX(), kStart + seconds(t + 0.5)});
  }
  const auto r = record();
  EXPECT_EQ(r.ghost_samples.size(), 2u);
  ASSERT_EQ(r.updates.size(), 2u);
  EXPECT_DOUBLE_EQ(r.updates[1].t_s, 10.0);
  EXPECT_EQ(r.datagrams.size(), 2u);
  ASSERT_EQ(r.contacts.size(), 2u);
  EXPECT_DOUBLE_EQ(r.contacts[0].reported_at_s, 0.5);
}

TEST_F(AssembleTest, ContactsKeepTheirTypeAndTheirPolygonsHaveNames) {
  believe(kA, 5.0, kCar, kA, {25, 0, 0});
  const ShapePair pair{{kCar, 3}, {ObjectId{2}, 1}};
  logs[0].contacts.push_back({kStart + seconds(1), "owner", kCar, kCube, Vec3::UnitX(), kStart + seconds(1),
                              CollisionType::kAllPairs, TouchedPolygons{99, {pair}}});
  const auto r = record();
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].type, CollisionType::kAllPairs);
  EXPECT_EQ(r.contacts[0].polygons.count, 99u);
  EXPECT_EQ(r.contacts[0].polygons.pairs, std::vector{pair});
  EXPECT_EQ(r.scene_paths.at(pair.collidee.shape), "WALL");
}

TEST_F(AssembleTest, IsSortedAsTheReportWantsItAndSumsTheCounters) {
  for (const double t : {1.0, 2.0}) {
    believe(kA, t, kCar, kA, {t * t, 0, 0});
    believe(kA, t, kCube, kB, Vec3::Zero());
    believe(kB, t, kCube, kB, Vec3::Zero());
    believe(kB, t, kCar, kA, Vec3::Zero());
  }
  logs[1].updates = {{kStart + seconds(1), kCube, 30, 0.5, "time"}};
  logs[0].updates = {{kStart + seconds(2), kCar, 30, 0.5, "error"}};
  logs[0].counters = {{"ticks", 3}};
  logs[1].counters = {{"ticks", 4}, {"dropped_x", 1}};
  const auto r = record();
  ASSERT_EQ(r.ghost_samples.size(), 4u);
  EXPECT_TRUE(std::ranges::is_sorted(r.ghost_samples, {},
                                     [](const auto& b) { return std::tuple(b.observer, b.object, b.t_s); }));
  EXPECT_EQ(r.updates.front().sender, kB);
  EXPECT_EQ(r.counters.at("ticks"), 7u);
  EXPECT_EQ(r.counters.at("dropped_x"), 1u);
  EXPECT_EQ(r.objects.size(), 2u);
  EXPECT_EQ(r.objects[1].path, "CUBE");
  EXPECT_EQ(r.objects[1].owner, kB);
  EXPECT_TRUE(r.worlds_equal);
  logs[0].other_worlds = 1;
  EXPECT_FALSE(record().worlds_equal);
}

TEST_F(AssembleTest, APeerThatNeverMetTheOthersIsNamed) {
  logs[1].start.reset();
  EXPECT_THAT(error_of(assemble(run, *shared, logs)), IsError(3, HasSubstr("peer b never met all the others")));
}

TEST_F(AssembleTest, ALifeThatEndedBeforeItMetTheOthersWasNotThere) {
  logs[1].start.reset();
  logs[1].ended_at = HostTime{Duration{1'000'000'000}};
  logs.push_back(logs[1]);
  logs.back().ended_at.reset();
  const auto there = only(record().peers[1].there_s);
  EXPECT_GT(there.first, there.second) << "an interval that no time is in";
}

// A ghost of an object whose owner left no row is no sample: there is nothing to compare it with.
TEST_F(AssembleTest, WithoutTheOwnersRowsThereIsNoSample) {
  believe(kA, 1.0, kCube, kB, Vec3::Zero());
  EXPECT_TRUE(record().ghost_samples.empty());
}

}  // namespace peerd::assemble_test
