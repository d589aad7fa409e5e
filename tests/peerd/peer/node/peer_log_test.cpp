#include "peerd/peer/node/peer_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::peer_log_test {

using testing::HasSubstr;
using testing_support::ScratchFolder;

PeerLog full_log() {
  PeerLog log{.peer = PeerId{7}, .name = "alice", .start = SimTime{Duration{1'700'000'000'123'456'789}}};
  const KinematicState s{.orientation = Quat(0.5, -0.5, 0.5, -0.5),
                         .position = {0.1, -1e300, std::numeric_limits<double>::denorm_min()},
                         .velocity = {1.0 / 3.0, -0.0, 2.0},
                         .acceleration = {1, 2, 3},
                         .angular_velocity_body = {4, 5, 6}};
  log.object_samples = {{SimTime{Duration{-5}}, HostTime{Duration{5}}, ObjectId{3}, PeerId{7}, s}, {}};
  log.updates = {{SimTime{Duration{11}}, ObjectId{3}, 31, 0.01, "error"}};
  log.datagrams = {{SimTime{Duration{12}}, 98}};
  log.contacts = {{SimTime{Duration{13}}, "predicted", ObjectId{3}, ObjectId{4}, Vec3(-1, 0, 0.25),
                   SimTime{Duration{14}}, CollisionType::kBox},
                  {SimTime{Duration{15}}, "owner", ObjectId{3}, ObjectId{4}, Vec3(0, 0, 1), SimTime{Duration{16}},
                   CollisionType::kAllPairs,
                   TouchedPolygons{99, {{{ObjectId{5}, 1}, {ObjectId{6}, 0}}, {{ObjectId{5}, 2}, {ObjectId{6}, 7}}}}}};
  log.bound = PeerLog::Bound{Duration{20}, Duration{30}, Duration{7}};
  log.groups_joined = 2;
  log.other_worlds = 1;
  log.counters = {{"ticks", 900}, {"dropped_own", std::numeric_limits<std::uint64_t>::max()}};
  return log;
}

void expect_same(const PeerLog& a, const PeerLog& b) {
  EXPECT_EQ(a.peer, b.peer);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.groups_joined, b.groups_joined);
  ASSERT_EQ(a.bound.has_value(), b.bound.has_value());
  if (a.bound) {
    EXPECT_TRUE(a.bound->least == b.bound->least && a.bound->most == b.bound->most &&
                a.bound->latest_by == b.bound->latest_by);
  }
  EXPECT_EQ(a.other_worlds, b.other_worlds);
  EXPECT_EQ(a.counters, b.counters);
  ASSERT_EQ(a.object_samples.size(), b.object_samples.size());
  for (std::size_t i = 0; i < a.object_samples.size(); ++i) {
    const auto &x = a.object_samples[i], &y = b.object_samples[i];
    EXPECT_TRUE(x.at == y.at && x.true_at == y.true_at && x.object == y.object && x.owner == y.owner);
    EXPECT_EQ(x.state.position, y.state.position);
    EXPECT_EQ(x.state.velocity, y.state.velocity);
    EXPECT_EQ(x.state.acceleration, y.state.acceleration);
    EXPECT_EQ(x.state.orientation.coeffs(), y.state.orientation.coeffs());
    EXPECT_EQ(x.state.angular_velocity_body, y.state.angular_velocity_body);
  }
  ASSERT_EQ(a.updates.size(), b.updates.size());
  for (std::size_t i = 0; i < a.updates.size(); ++i) {
    const auto &x = a.updates[i], &y = b.updates[i];
    EXPECT_TRUE(x.at == y.at && x.object == y.object && x.bytes == y.bytes && x.threshold_m == y.threshold_m &&
                x.reason == y.reason);
  }
  ASSERT_EQ(a.datagrams.size(), b.datagrams.size());
  for (std::size_t i = 0; i < a.datagrams.size(); ++i) {
    EXPECT_TRUE(a.datagrams[i].at == b.datagrams[i].at && a.datagrams[i].bytes == b.datagrams[i].bytes);
  }
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const auto &x = a.contacts[i], &y = b.contacts[i];
    EXPECT_TRUE(x.at == y.at && x.kind == y.kind && x.collider == y.collider && x.collidee == y.collidee &&
                x.normal == y.normal && x.known_at == y.known_at && x.type == y.type &&
                x.polygons.count == y.polygons.count && x.polygons.pairs == y.polygons.pairs);
  }
}

TEST(PeerLog, ComesBackBitForBit) {
  const ScratchFolder folder;
  std::vector<PeerLog> logs{full_log()};
  for (const char* any_word : {"a", "-", "größe", "12", "a\"b"}) {
    logs.push_back({.peer = PeerId{1}, .name = any_word});
  }
  for (const PeerLog& log : logs) {
    ASSERT_TRUE(save(log, folder / "a.rows"));
    const auto read = must(load_peer_log(folder / "a.rows"));
    expect_same(log, read);
  }
}

TEST(PeerLog, WhatIsNoRowIsNamedByItsLine) {
  const ScratchFolder folder;
  for (const char* row :
       {"X 1 2", "D 1", "D 1 two", "D 1 99999999999", "D 1.5 3", "U 1 2 3", "B 1 2 3 4 5", "P", "N ticks -1"}) {
    const auto read = load_peer_log(folder.write("bad.rows", "P 1 a 1 0\n\n" + std::string(row) + "\n"));
    ASSERT_FALSE(read) << row;
    EXPECT_THAT(read.error().text, HasSubstr("bad.rows:3:1: error: not a row of a peer's log"));
    EXPECT_EQ(read.error().exit_code, 3);
  }
}

TEST(PeerLog, SaysWhichFileCannotBeHad) {
  const ScratchFolder folder;
  EXPECT_THAT(load_peer_log(folder / "none").error().text, HasSubstr("none"));
  EXPECT_THAT(error_of(save(full_log(), folder / "no" / "such" / "folder")), IsError(3, HasSubstr("can't be written")));
}

}  // namespace peerd::peer_log_test
