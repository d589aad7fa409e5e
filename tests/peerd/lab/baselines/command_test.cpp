#include "peerd/lab/baselines/command.hpp"

#include <gtest/gtest.h>

#include <array>

namespace peerd::baselines::command_test {

using replication::BitReader;
using replication::BitWriter;

Command written_and_read(const Command& command) {
  std::array<std::byte, 4096> bytes{};
  BitWriter out(bytes);
  put(out, command);
  BitReader in{std::span(bytes).first(out.finish())};
  Command read;
  EXPECT_TRUE(take(in, command.drives.size(), read));
  return read;
}

TEST(CommandOfAPlayer, ComesBackAsItWasWritten) {
  Command command;
  command.drives = {{}, {{1, -2, 3}, {}}, {{}, {-(1 << 30), 1 << 30, 0}}, {{700, 0, -9000}, {5, 6, -7}}};
  command.keys = {{4115, 0}, {-1, 256}};
  const Command read = written_and_read(command);
  EXPECT_EQ(read.drives, command.drives);
  EXPECT_EQ(read.keys, command.keys);
}

TEST(CommandOfAPlayer, OneThatStandsTakesAByteAnObject) {
  std::array<std::byte, 64> bytes{};
  BitWriter out(bytes);
  put(out, Command{std::vector<Drive>(3), {}});
  EXPECT_EQ(out.finish(), 4u) << "three objects and the number of keys";
}

TEST(CommandOfAPlayer, UnknownBitsAndTooManyKeysAreRefused) {
  std::array<std::byte, 8> bytes{};
  BitWriter unknown(bytes);
  unknown.put(4, 8);
  Command read;
  BitReader in{std::span(bytes).first(unknown.finish())};
  EXPECT_FALSE(take(in, 1, read));
  BitWriter keys(bytes);
  replication::put_varint(keys, 65);
  BitReader many{std::span(bytes).first(keys.finish())};
  EXPECT_FALSE(take(many, 0, read));
}

// The source goes by where its objects are at each tick, so that rounding does not add up.
TEST(CommandSourceOfAPlayer, KeepsAnObjectOnItsMotion) {
  const motion::MotionFormula formula{.x = "3 * sin(t)", .z = "2 * t", .angle = "0.7 * t"};
  config::Motions motions;
  motions.emplace(ObjectId{}, motion::MotionSource(*motion::FormulaMotion::make(formula, "a test", 20.0)));
  CommandSource source(motions, {{0.5, {65, 0}}});
  std::vector<Pose> at = source.begin();
  constexpr double kTick_s = 1.0 / 35.0;
  std::size_t keys = 0;
  for (int tick = 0; tick < 500; ++tick) {
    const Command command = source.sample(tick * kTick_s, kTick_s, at);
    at[0] = advance(driven(at[0], command.drives[0]), kTick_s).pose();
    keys += command.keys.size();
    const Pose wanted = motions.begin()->second.pose((tick + 1) * kTick_s);
    ASSERT_LT((at[0].position - wanted.position).norm(), 0.003) << "the acceleration of a tick, at most 3 m/s^2";
    ASSERT_LT(at[0].orientation.angularDistance(wanted.orientation), 1e-3);
  }
  EXPECT_EQ(keys, 1u);
}

}  // namespace peerd::baselines::command_test
