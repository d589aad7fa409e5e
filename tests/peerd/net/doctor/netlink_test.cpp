#include "peerd/net/doctor/netlink.hpp"

#include <gtest/gtest.h>
#include <linux/rtnetlink.h>

#include <string>
#include <vector>

#include "tests/must.hpp"

namespace peerd::doctor::netlink_test {

std::vector<std::string> texts_of(const std::vector<unsigned char>& bytes) {
  std::vector<std::string> texts;
  for_each_attribute(std::as_bytes(std::span(bytes)),
                     [&](const Attribute& a) { texts.push_back(std::to_string(a.type) + std::string(a.text())); });
  return texts;
}

TEST(Netlink, AttributesAreReadUpToACutOne) {
  const std::vector<unsigned char> two{7, 0, 3, 0, 'l', 'o', 0, 0, 6, 0, 4, 0x80, 'a', 'b', 0, 0};
  EXPECT_EQ(texts_of(two), (std::vector<std::string>{"3lo", "4ab"})) << "padding and flags are left out";
  for (std::size_t size = 0; size < 14; ++size) {
    EXPECT_LE(texts_of({two.begin(), two.begin() + static_cast<std::ptrdiff_t>(size)}).size(), 1u) << size;
  }
  EXPECT_TRUE(texts_of({3, 0, 3, 0}).empty()) << "shorter than its own header";
  EXPECT_TRUE(texts_of({0, 0, 3, 0}).empty());
}

TEST(Netlink, AShortNumberIsZero) {
  const std::vector<std::byte> bytes(2, std::byte{1});
  EXPECT_EQ((Attribute{1, bytes}.number<std::uint32_t>()), 0u);
  EXPECT_EQ((Attribute{1, bytes}.number<std::uint16_t>()), 0x0101u);
}

TEST(Netlink, TheKernelAnswersOrSaysWhyNot) {
  const ifinfomsg all{};
  int links = 0;
  const auto body = std::as_bytes(std::span(&all, 1));
  EXPECT_TRUE(dump(NETLINK_ROUTE, RTM_GETLINK, body, [&](std::uint16_t type, std::span<const std::byte> message) {
    links += type == RTM_NEWLINK && message.size() >= sizeof all;
  }));
  EXPECT_GE(links, 1) << "lo";
  EXPECT_EQ(error_of(dump(NETLINK_ROUTE, RTM_MAX + 2, body, [](std::uint16_t, std::span<const std::byte>) {})),
            EOPNOTSUPP);
}

}  // namespace peerd::doctor::netlink_test
