#include "peerd/net/snapshot/places.hpp"

#include <gtest/gtest.h>

namespace peerd::snapshot::places_test {

using boost::asio::ip::make_address;

const auto kHere = make_address("192.0.2.1"), kThere = make_address("192.0.2.2");

// A connection that comes and proves itself at once.
std::optional<std::uint64_t> add_proven(Places& places, std::uint64_t number, const boost::asio::ip::address& from) {
  EXPECT_FALSE(places.add(number, from));
  return places.note_proven(number);
}

TEST(Places, TheOldestOfTheUnprovenMakesRoom) {
  Places places(3, 2);
  EXPECT_FALSE(add_proven(places, 1, kHere));
  for (std::uint64_t number = 2; number <= 3; ++number) EXPECT_FALSE(places.add(number, kHere));
  EXPECT_EQ(places.add(4, kThere), 2u);
  EXPECT_EQ(places.add(5, kThere), 3u);
  EXPECT_EQ(places.size(), 3u);
  EXPECT_TRUE(places.is_proven(1));
}

TEST(Places, WhereAllAreProvenTheNewOneGoes) {
  Places places(2, 2);
  EXPECT_FALSE(add_proven(places, 1, kHere));
  EXPECT_FALSE(add_proven(places, 2, kThere));
  EXPECT_EQ(add_proven(places, 3, kHere), 3u);
  EXPECT_FALSE(places.is_proven(3));
  places.remove(1);
  EXPECT_FALSE(add_proven(places, 4, kHere)) << "there is room again";
}

TEST(Places, TheBusiestAddressMakesRoomForAnother) {
  Places places(4, 2);
  for (std::uint64_t number = 1; number <= 4; ++number) EXPECT_FALSE(add_proven(places, number, kHere));
  EXPECT_EQ(add_proven(places, 5, kThere), 1u);
  EXPECT_EQ(add_proven(places, 6, kThere), 6u) << "three and one: the two would take a place from each other by turns";
}

TEST(Places, WhoProvesNothingTakesNoPlaceOfOneThatHas) {
  Places places(4, 3);
  for (std::uint64_t number = 1; number <= 4; ++number) EXPECT_FALSE(add_proven(places, number, kHere));
  for (std::uint64_t number = 5; number <= 7; ++number) EXPECT_FALSE(places.add(number, kThere));
  for (std::uint64_t number = 8; number <= 100; ++number) EXPECT_EQ(places.add(number, kThere), number - 3);
  for (std::uint64_t number = 1; number <= 4; ++number) EXPECT_TRUE(places.is_proven(number));
}

TEST(Places, WhoeverIsProvenLeavesAllPlacesOfStrangersFree) {
  Places places(3, 2);
  for (std::uint64_t number = 1; number <= 3; ++number) EXPECT_FALSE(add_proven(places, number, kHere));
  EXPECT_FALSE(places.add(4, kThere));
  EXPECT_FALSE(places.add(5, kThere));
  EXPECT_EQ(places.size(), 5u);
  EXPECT_EQ(places.add(6, kThere), 4u);
}

TEST(Places, ProofCountsOnce) {
  Places places(2, 2);
  EXPECT_FALSE(add_proven(places, 1, kHere));
  EXPECT_FALSE(places.note_proven(1));
  EXPECT_FALSE(places.note_proven(9)) << "it is gone";
  EXPECT_FALSE(add_proven(places, 2, kHere));
  EXPECT_EQ(places.size(), 2u);
}

TEST(Places, AnIPv6NetworkIsOneAddress) {
  Places places(3, 2);
  EXPECT_FALSE(add_proven(places, 1, make_address("2001:db8:0:1::1")));
  EXPECT_FALSE(add_proven(places, 2, make_address("2001:db8:0:1::2")));
  EXPECT_FALSE(add_proven(places, 3, make_address("2001:db8:0:1:ffff::3")));
  EXPECT_EQ(add_proven(places, 4, make_address("2001:db8:0:1::4")), 4u) << "of the same network";
  EXPECT_EQ(add_proven(places, 5, make_address("2001:db8:0:2::1")), 1u) << "of another one";
}

}  // namespace peerd::snapshot::places_test
