#include "peerd/lab/baselines/game_message.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/must.hpp"

namespace peerd::baselines::game_message_test {

using replication::BitReader;
using replication::BitWriter;

constexpr SimTime kStart{std::chrono::seconds(3)};
constexpr std::array<std::size_t, 2> kDriven{0, 1};

ClientMessage example() {
  return {.player = 1,
          .first_tick = 4000,
          .commands = {{{{{1, 2, 3}, {}}}, {}}, {{{{}, {4, 5, 6}}}, {{70, 1}}}},
          .last_event = 9,
          .seen = kStart + std::chrono::milliseconds(1234),
          .blocks = {0, 77, 300}};
}

TEST(ClientMessage, ComesBackAsItWasWritten) {
  std::array<std::byte, 1024> bytes{};
  const std::size_t size = write(example(), kStart, bytes);
  const auto read = must(read_client_message(std::span(bytes).first(size), kStart, kDriven, 3));
  EXPECT_EQ(read.player, 1u);
  EXPECT_EQ(read.first_tick, 4000u);
  ASSERT_EQ(read.commands.size(), 2u);
  EXPECT_EQ(read.commands[1].drives, example().commands[1].drives);
  EXPECT_EQ(read.commands[1].keys, example().commands[1].keys);
  EXPECT_EQ(read.last_event, 9u);
  EXPECT_EQ(read.seen, example().seen);
  EXPECT_EQ(read.blocks, example().blocks);
}

TEST(ClientMessage, ThatIsCutOffIsRefused) {
  std::array<std::byte, 1024> bytes{};
  const std::size_t size = write(example(), kStart, bytes);
  for (std::size_t i = 0; i < size; ++i) {
    EXPECT_FALSE(read_client_message(std::span(bytes).first(i), kStart, kDriven, 3)) << i << " bytes";
  }
}

TEST(ClientMessage, OfAPlayerThatIsNotThereIsRefused) {
  std::array<std::byte, 1024> bytes{};
  const std::size_t size = write(example(), kStart, bytes);
  EXPECT_FALSE(read_client_message(std::span(bytes).first(size), kStart, std::span(kDriven).first(1), 3));
}

TEST(GameEvent, ComesBackWithItsNormalToASixteenthBit) {
  GameEvent event;
  event.shared = true;
  event.contact.at = kStart + std::chrono::nanoseconds(987654321);
  event.contact.collider = ObjectId::unpacked(12);
  event.contact.collidee = ObjectId::unpacked(700);
  event.contact.normal = Vec3(0.6, -0.8, 0.0);
  event.contact.type = CollisionType::kAllPairs;
  std::array<std::byte, 64> bytes{};
  BitWriter out(bytes);
  put(out, kStart, event);
  BitReader in{std::span(bytes).first(out.finish())};
  GameEvent read;
  ASSERT_TRUE(take(in, kStart, read));
  EXPECT_TRUE(read.shared);
  EXPECT_EQ(read.contact.at, event.contact.at);
  EXPECT_EQ(read.contact.collider, event.contact.collider);
  EXPECT_EQ(read.contact.collidee, event.contact.collidee);
  EXPECT_EQ(read.contact.type, event.contact.type);
  EXPECT_LT((read.contact.normal - event.contact.normal).norm(), 1e-4);
}

TEST(SnapshotHead, ABaseBehindTheSnapshotIsRefused) {
  std::array<std::byte, 64> bytes{};
  BitWriter out(bytes);
  put(out, SnapshotHead{500, 498, 0, 30, 28});
  SnapshotHead read;
  BitReader in{std::span(bytes).first(out.finish())};
  ASSERT_TRUE(take(in, read));
  EXPECT_EQ(read.tick, 500u);
  EXPECT_EQ(read.commands, 498u);
  EXPECT_EQ(read.base, 28u);
  BitWriter wrong(bytes);
  for (const std::uint64_t value : {500u, 498u, 0u, 30u, 31u}) replication::put_varint(wrong, value);
  BitReader again{std::span(bytes).first(wrong.finish())};
  EXPECT_FALSE(take(again, read));
}

}  // namespace peerd::baselines::game_message_test
