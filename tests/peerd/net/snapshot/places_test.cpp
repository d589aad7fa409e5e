#include "peerd/net/snapshot/places.hpp"

#include <gtest/gtest.h>

namespace peerd::snapshot::places_test {

using boost::asio::ip::make_address;

const auto kHere = make_address("192.0.2.1"), kThere = make_address("192.0.2.2");

TEST(Places, TheOldestOfTheUnprovenMakesRoom) {
  Places places(3);
  for (std::uint64_t number = 1; number <= 3; ++number) EXPECT_FALSE(places.add(number, kHere));
  places.note_proven(1);
  EXPECT_EQ(places.add(4, kThere), 2u);
  EXPECT_EQ(places.add(5, kThere), 3u);
  EXPECT_EQ(places.size(), 3u);
  EXPECT_TRUE(places.is_proven(1));
}

TEST(Places, WhereAllAreProvenTheNewOneGoes) {
  Places places(2);
  EXPECT_FALSE(places.add(1, kHere));
  EXPECT_FALSE(places.add(2, kThere));
  places.note_proven(1);
  places.note_proven(2);
  EXPECT_EQ(places.add(3, kHere), 3u);
  EXPECT_FALSE(places.is_proven(3));
  places.remove(1);
  EXPECT_FALSE(places.add(4, kHere)) << "there is room again";
}

TEST(Places, TheBusiestAddressMakesRoomForAnother) {
  Places places(4);
  for (std::uint64_t number = 1; number <= 4; ++number) {
    EXPECT_FALSE(places.add(number, kHere));
    places.note_proven(number);
  }
  EXPECT_EQ(places.add(5, kThere), 1u);
  places.note_proven(5);
  EXPECT_EQ(places.add(6, kThere), 6u) << "three and one: the two would take a place from each other by turns";
}

TEST(Places, WhoProvesNothingTakesOnePlaceOfABusyAddressAtMost) {
  Places places(4);
  for (std::uint64_t number = 1; number <= 4; ++number) {
    EXPECT_FALSE(places.add(number, kHere));
    places.note_proven(number);
  }
  EXPECT_EQ(places.add(5, kThere), 1u);
  for (std::uint64_t number = 6; number <= 100; ++number) EXPECT_EQ(places.add(number, kThere), number - 1);
}

}  // namespace peerd::snapshot::places_test
