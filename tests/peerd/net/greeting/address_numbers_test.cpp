#include "peerd/net/greeting/address_numbers.hpp"

#include <gtest/gtest.h>

#include <set>

namespace peerd::net::address_numbers_test {

asio::ip::udp::endpoint address(std::uint16_t port) { return {asio::ip::make_address("192.0.2.1"), port}; }

TEST(AddressNumbers, ANumberIsOfOneAddressAndOfTwoPeriods) {
  AddressNumbers numbers({1, 2}, std::chrono::seconds(30));
  numbers.advance(HostTime{std::chrono::seconds(3'000)});
  const auto number = numbers.number_for(address(1));
  EXPECT_NE(number, 0u);
  EXPECT_EQ(number >> kAddressNumberBits, 0u);
  EXPECT_TRUE(numbers.is_number_for(address(1), number));
  EXPECT_FALSE(numbers.is_number_for(address(2), number));
  numbers.advance(HostTime{std::chrono::seconds(3'030)});
  EXPECT_NE(numbers.number_for(address(1)), number);
  EXPECT_TRUE(numbers.is_number_for(address(1), number));
  numbers.advance(HostTime{std::chrono::seconds(3'060)});
  EXPECT_FALSE(numbers.is_number_for(address(1), number));
}

TEST(AddressNumbers, AddressesAndKeysHaveNumbersOfTheirOwn) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t key = 0; key < 10; ++key) {
    const AddressNumbers numbers({key, 7});
    for (std::uint16_t port = 1; port < 100; ++port) seen.insert(numbers.number_for(address(port)));
    seen.insert(numbers.number_for({asio::ip::make_address("2001:db8::1"), 1}));
  }
  EXPECT_EQ(seen.size(), 1'000u);
  EXPECT_NE(AddressNumbers({1, 1}).instance(), AddressNumbers({2, 1}).instance());
}

}  // namespace peerd::net::address_numbers_test
