#include "peerd/lab/baselines/snapshot.hpp"

#include <gtest/gtest.h>

#include <array>

namespace peerd::baselines::snapshot_test {

using replication::BitReader;
using replication::BitWriter;

KinematicState moving(double x_m, double speed_m_s, double angle_rad) {
  return {.orientation = Quat(Eigen::AngleAxisd(angle_rad, Vec3::UnitY())),
          .position = Vec3(x_m, -1.0, 2e4),
          .velocity = Vec3(speed_m_s, 0.0, 0.5)};
}

TEST(SnapshotOfAServer, HasAStateToItsSteps) {
  const KinematicState state = moving(12.3456, -7.89, 1.1);
  const KinematicState read = state_of(snapshot_of(state));
  EXPECT_LE((read.position - state.position).cwiseAbs().maxCoeff(), kPositionStep_m / 2);
  EXPECT_LE((read.velocity - state.velocity).cwiseAbs().maxCoeff(), kVelocityStep_m_s / 2);
  EXPECT_LT(read.orientation.angularDistance(state.orientation), 1e-3);
}

TEST(SnapshotOfAServer, ChangesLeadFromItsBaseToIt) {
  const Block base{snapshot_of(moving(0, 0, 0)), snapshot_of(moving(1, 2, 0.1)), snapshot_of(moving(5, 0, 0))};
  const Block now{base[0], snapshot_of(moving(1.5, 2, 0.2)), snapshot_of(moving(-500, 90, 3))};
  std::array<std::byte, 1024> bytes{};
  BitWriter out(bytes);
  EXPECT_EQ(put_changes(out, base, now), (std::vector<std::uint32_t>{1, 2}));
  const std::size_t size = out.finish();
  Block read = base;
  BitReader in{std::span(bytes).first(size)};
  ASSERT_TRUE(take_changes(in, read));
  EXPECT_EQ(read, now);
  EXPECT_LT(size, 40u);
}

TEST(SnapshotOfAServer, WhatHasNotChangedTakesAByte) {
  const Block block(kBlockObjects, snapshot_of(moving(1, 2, 3)));
  std::array<std::byte, 64> bytes{};
  BitWriter out(bytes);
  EXPECT_TRUE(put_changes(out, block, block).empty());
  EXPECT_EQ(out.finish(), 1u);
}

TEST(SnapshotOfAServer, AnObjectBeyondItsBlockIsRefused) {
  const Block block(2, snapshot_of(moving(1, 2, 3)));
  std::array<std::byte, 64> bytes{};
  BitWriter out(bytes);
  replication::put_varint(out, 1);
  out.put(2, 8);
  out.put(0, 8);
  Block read = block;
  BitReader in{std::span(bytes).first(out.finish())};
  EXPECT_FALSE(take_changes(in, read));
}

}  // namespace peerd::baselines::snapshot_test
