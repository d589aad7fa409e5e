#include "peerd/net/relay/neighbours.hpp"

#include <gtest/gtest.h>

#include <set>

namespace peerd::relay::neighbours_test {

namespace asio = boost::asio;

asio::ip::udp::endpoint address(std::uint32_t n, bool v4 = true) {
  if (v4) return {asio::ip::address_v4(0x0A00'0000 + n / 7), static_cast<std::uint16_t>(1000 + n % 7)};
  asio::ip::address_v6::bytes_type bytes{0x20, 0x01, 0x0d, 0xb8};
  bytes[15] = static_cast<unsigned char>(n);
  return {asio::ip::address_v6(bytes), 47480};
}

TEST(Neighbours, AreFoundByAddressAndByLink) {
  Neighbours neighbours(1024);
  for (std::uint32_t n = 0; n < 100; ++n) {
    EXPECT_EQ(neighbours.find(address(n)), nullptr);
    Neighbour& added = neighbours.add(address(n));
    EXPECT_EQ(added.link, 1024 + n);
    EXPECT_EQ(&neighbours.of(added.link), &added);
  }
  Neighbour& v6 = neighbours.add(address(5, false));
  EXPECT_EQ(neighbours.find(address(5, false)), &v6);
  EXPECT_EQ(neighbours.find(address(5))->at, address(5));
  EXPECT_EQ(neighbours.count(), 101u);
}

TEST(Neighbours, ALinkIsUsedAgainWhenItsNeighbourHasGone) {
  Neighbours neighbours(10);
  (void)neighbours.add(address(0));
  const LinkId freed = neighbours.add(address(1)).link;
  (void)neighbours.add(address(2));
  neighbours.remove(*neighbours.find(address(1)));
  EXPECT_EQ(neighbours.find(address(1)), nullptr);
  EXPECT_EQ(neighbours.add(address(3)).link, freed);
  std::set<LinkId> links;
  neighbours.visit([&](Neighbour& each) {
    links.insert(each.link);
    if (each.at == address(0)) neighbours.remove(each);
  });
  EXPECT_EQ(links.size(), 3u);
  EXPECT_EQ(neighbours.count(), 2u);
}

}  // namespace peerd::relay::neighbours_test
