#include "replication/wire/decision_bits.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "tests/replication/peer/messages.hpp"

namespace peerd::replication::decision_bits_test {

using namespace test;

std::vector<std::byte> bytes_of(const DecisionRecord& d) {
  std::array<std::byte, kDecisionMax_bytes> bytes;
  return {bytes.begin(), bytes.begin() + static_cast<long>(encode_decision(d, bytes))};
}

std::optional<DecisionRecord> back(std::span<const std::byte> bytes, SimTime near) {
  auto decision = decode_decision(bytes, near);
  return bytes.empty() ? decision : std::nullopt;
}

bool same(const DecisionRecord& d, const DecisionRecord& e) {
  Message m, n;
  m.decisions = {d};
  n.decisions = {e};
  return same_bits(m, n);
}

DecisionRecord touch() {
  DecisionRecord d{ObjectId{3},
                   ObjectId{700},
                   sim(100s),
                   Vec3::UnitX(),
                   moving({1, 2, 3}, {4, 0, 0}),
                   moving({5, 0, 0}),
                   {},
                   {},
                   DecisionRule::kVelocity,
                   {}};
  d.collider_after = d.collider_before;
  d.collidee_after = moving({5, 0, 0}, {4, 0, 0});
  return d;
}

TEST(DecisionBits, ComeBackAsTheyWere) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(seed);
    const DecisionRecord d = MessageMaker(seed).decision();
    const auto again = back(bytes_of(d), d.contact - 300s);
    ASSERT_TRUE(again);
    EXPECT_TRUE(same(d, *again));
  }
}

// The outcome is exact to the last bit, signs of zero included: a decider applies its own outcome, which has not
// travelled through this format.
TEST(DecisionBits, KeepSignsOfZero) {
  DecisionRecord d = touch();
  d.collider_before.velocity = {-0.0, 1.0, 0.0};
  d.collidee_before.orientation = Quat(1.0, -0.0, 0.0, 0.0);
  d.collidee_after.orientation = Quat::Identity();
  const auto again = back(bytes_of(d), d.contact);
  ASSERT_TRUE(again);
  EXPECT_TRUE(same(d, *again));
  EXPECT_TRUE(std::signbit(again->collider_before.velocity.x()));
  EXPECT_TRUE(std::signbit(again->collidee_before.orientation.x()));
  EXPECT_FALSE(std::signbit(again->collidee_after.orientation.x()));
}

// A velocity along one axis takes 64 bits and 5 that say so; a velocity that stays takes none of them.
TEST(DecisionBits, UnchangedValuesAreNotEncoded) {
  DecisionRecord stays = touch();
  stays.collidee_after = stays.collidee_before;
  const std::size_t more = bytes_of(touch()).size() - bytes_of(stays).size();
  EXPECT_GE(more, 69u / 8);
  EXPECT_LE(more, 69u / 8 + 1);
}

// A decision that two rest takes a bit, and one more for each of the two whose acceleration before is its free one.
TEST(DecisionBits, WhatDrivesTwoThatRestTravels) {
  DecisionRecord rests = touch();
  rests.rests = true;
  EXPECT_LE(bytes_of(rests).size(), bytes_of(touch()).size() + 1);
  rests.collider_free = Vec3(0, -9.81, 0);
  rests.collidee_free = Vec3(-0.0, 0, 0);
  const auto again = back(bytes_of(rests), rests.contact);
  ASSERT_TRUE(again);
  EXPECT_TRUE(same(rests, *again));
  EXPECT_TRUE(std::signbit(again->collidee_free->x()));
  rests.collidee_free.reset();
  const auto without = back(bytes_of(rests), rests.contact);
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->collidee_free.has_value());
}

TEST(DecisionBits, AnythingCutShortOrChangedIsRefusedOrAnotherDecision) {
  const DecisionRecord d = touch();
  const auto bytes = bytes_of(d);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(back(std::span(bytes).first(size), d.contact)) << size;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    auto flipped = bytes;
    flipped[bit / 8] ^= std::byte{1} << bit % 8;
    const auto again = back(flipped, d.contact);
    EXPECT_TRUE(!again || bytes_of(*again) == flipped) << "one form for each, bit " << bit;
  }
}

TEST(DecisionBits, OnlyWhatCanBeIsTaken) {
  const auto refused = [](auto change) {
    DecisionRecord d = touch();
    change(d);
    return !back(bytes_of(d), sim(100s));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(refused([](DecisionRecord&) {}));
  EXPECT_FALSE(refused([](DecisionRecord& d) { d.rule = DecisionRule::kServer; })) << "the last one";
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.normal = {1.001, 0, 0}; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.normal = Vec3::Zero(); }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.normal.x() = kNan; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collider_before.position.x() = kInf; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collider_before.position.x() = kNan; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collidee_before.velocity.x() = kNan; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collider_after.velocity.x() = kInf; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collidee_after.velocity.x() = kInf; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collidee_after.velocity.x() = 1e13; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collidee_after.orientation = Quat(1, 1, 0, 0); }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.collider_after.angular_velocity_body = {0, 2e4, 0}; }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.rule = static_cast<DecisionRule>(0); }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.rule = static_cast<DecisionRule>(6); }));
  EXPECT_TRUE(refused([](DecisionRecord& d) { d.known = SimTime::max(); }));
  const auto driven_by = [&](double acceleration_m_s2) {
    return refused([&](DecisionRecord& d) {
      d.rests = true;
      d.collidee_free = Vec3(acceleration_m_s2, 0, 0);
    });
  };
  EXPECT_FALSE(driven_by(1e12));
  EXPECT_TRUE(driven_by(1e13));
  EXPECT_TRUE(driven_by(kNan));
}

}  // namespace peerd::replication::decision_bits_test
