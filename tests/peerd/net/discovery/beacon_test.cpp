#include "peerd/net/discovery/beacon.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/must.hpp"

namespace peerd::discovery::beacon_test {

Beacon some() {
  return {.protocol = 9,
          .session = 0x0123456789abcdef,
          .peer = PeerId{4'000'000'000},
          .incarnation = 77,
          .snapshot_port = 50'000,
          .world = "town",
          .name = "ann"};
}

TEST(Beacon, IsReadAsItWasWritten) { EXPECT_EQ(must(decode(encode(some()))), some()); }

TEST(Beacon, IsNoLongerThanTheQuestion) {
  Beacon beacon = some();
  beacon.world = std::string(500, 'w');
  beacon.name = std::string(500, 'n');
  const auto bytes = encode(beacon);
  EXPECT_LE(bytes.size(), question().size());
  EXPECT_EQ(must(decode(bytes)).world, std::string(kNameMax_bytes, 'w'));
}

TEST(Beacon, ANameIsCutBetweenCharacters) {
  Beacon beacon = some();
  beacon.world = std::string(kNameMax_bytes - 1, 'w') + "\xc3\xa4";  // an umlaut of two bytes
  EXPECT_EQ(must(decode(encode(beacon))).world, std::string(kNameMax_bytes - 1, 'w'));
}

TEST(Beacon, ATerminalIsNotSteeredByAName) {
  Beacon beacon = some();
  beacon.name =
      "a\x1b[2J\n\xc2\x9b"
      "5m";
  EXPECT_EQ(must(decode(encode(beacon))).name, "a?[2J??5m");
}

TEST(Beacon, AnythingElseIsNone) {
  const auto bytes = encode(some());
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(decode(std::span(bytes).first(size)));
  auto longer = bytes;
  longer.push_back({});
  EXPECT_FALSE(decode(longer));
  EXPECT_FALSE(decode(question()));
  Beacon nobody = some();
  nobody.peer = kNobody;
  EXPECT_FALSE(decode(encode(nobody)));
  std::mt19937_64 random(1);
  for (int i = 0; i < 100'000; ++i) {
    auto changed = bytes;
    changed[random() % changed.size()] = static_cast<std::byte>(random());
    if (const auto read = decode(changed)) {
      EXPECT_LE(read->world.size(), kNameMax_bytes);
    }
  }
}

TEST(Question, IsOne) {
  EXPECT_TRUE(is_question(question()));
  auto shorter = question();
  shorter.pop_back();
  EXPECT_FALSE(is_question(shorter));
  EXPECT_FALSE(is_question(encode(some())));
}

}  // namespace peerd::discovery::beacon_test
