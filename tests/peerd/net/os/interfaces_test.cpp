#include "peerd/net/os/interfaces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/must.hpp"

namespace peerd::net::interfaces_test {

using testing::HasSubstr;

Interface lo() {
  return {.name = "lo", .index = 1, .up = true, .running = true, .loopback = true, .has_ipv4 = true, .has_ipv6 = true};
}

Interface card(const char* name, unsigned index) {
  return {
      .name = name, .index = index, .up = true, .running = true, .multicast = true, .has_ipv4 = true, .has_ipv6 = true};
}

Interface changed(Interface interface, auto change) {
  change(interface);
  return interface;
}

struct Good {
  const char* name;
  std::vector<Interface> here;
  std::string wanted;
  IpFamily family;
  std::string chosen;
};
class Choice : public testing::TestWithParam<Good> {};
TEST_P(Choice, Is) {
  const Good& c = GetParam();
  const auto chosen = must(choose_interface(c.here, c.wanted, c.family));
  EXPECT_EQ(chosen.interface.name, c.chosen);
  EXPECT_THAT(chosen.why, HasSubstr(c.chosen));
}
INSTANTIATE_TEST_SUITE_P(
    Table, Choice,
    testing::Values(Good{"ByName", {lo(), card("eth0", 2), card("eth1", 3)}, "eth1", IpFamily::kV4, "eth1"},
                    Good{"LoByName", {lo(), card("eth0", 2)}, "lo", IpFamily::kV4, "lo"},
                    Good{"ByNameThoughUnplugged",
                         {lo(), changed(card("eth0", 2), [](Interface& i) { i.running = false; })},
                         "eth0",
                         IpFamily::kV4,
                         "eth0"},
                    Good{"TheOnlyOne", {lo(), card("eth0", 2)}, "", IpFamily::kV4, "eth0"},
                    Good{"TheOnlyOneV6", {lo(), card("eth0", 2)}, "", IpFamily::kV6, "eth0"},
                    Good{"TheOnlyOneThatRuns",
                         {lo(), card("eth0", 2), changed(card("docker0", 3), [](Interface& i) { i.running = false; })},
                         "",
                         IpFamily::kV4,
                         "eth0"},
                    Good{"TheOnlyOneWithAnAddress",
                         {lo(), changed(card("eth0", 2), [](Interface& i) { i.has_ipv4 = false; }), card("eth1", 3)},
                         "",
                         IpFamily::kV4,
                         "eth1"},
                    Good{"SeveralMeansLo", {lo(), card("eth0", 2), card("eth1", 3)}, "", IpFamily::kV4, "lo"},
                    Good{"NoneMeansLo", {lo()}, "", IpFamily::kV4, "lo"}),
    [](const auto& c) { return std::string(c.param.name); });

struct Bad {
  const char* name;
  std::vector<Interface> here;
  std::string wanted;
  IpFamily family;
  NetError::Kind kind;
  std::string sentence;
};
class Refusal : public testing::TestWithParam<Bad> {};
TEST_P(Refusal, SaysWhatToDo) {
  const Bad& c = GetParam();
  const auto chosen = choose_interface(c.here, c.wanted, c.family);
  ASSERT_FALSE(chosen) << chosen->interface.name;
  EXPECT_EQ(chosen.error().kind, c.kind);
  EXPECT_EQ(chosen.error().sentence, c.sentence);
}
INSTANTIATE_TEST_SUITE_P(
    Table, Refusal,
    testing::Values(
        Bad{"NoSuchName",
            {lo(), card("eth0", 2)},
            "eth9",
            IpFamily::kV4,
            NetError::Kind::kNoSuchInterface,
            "no interface named \"eth9\" here; the ones that can multicast over IPv4 are: lo, eth0"},
        Bad{"NothingHere",
            {},
            "eth9",
            IpFamily::kV6,
            NetError::Kind::kNoSuchInterface,
            "no interface named \"eth9\" here; none here can multicast over IPv6"},
        Bad{"Down",
            {lo(), changed(card("eth0", 2), [](Interface& i) { i.up = false; })},
            "eth0",
            IpFamily::kV4,
            NetError::Kind::kNoMulticast,
            "interface \"eth0\" is down: bring it up (ip link set eth0 up) or name another; the ones that can "
            "multicast over IPv4 are: lo"},
        Bad{"PointToPoint",
            {lo(), changed(card("tun0", 2), [](Interface& i) { i.multicast = false; })},
            "tun0",
            IpFamily::kV4,
            NetError::Kind::kNoMulticast,
            "interface \"tun0\" does not do multicast: name another; the ones that can multicast over IPv4 are: lo"},
        Bad{"NoAddress",
            {lo(), changed(card("eth0", 2), [](Interface& i) { i.has_ipv6 = false; }), card("eth1", 3)},
            "eth0",
            IpFamily::kV6,
            NetError::Kind::kNoMulticast,
            "interface \"eth0\" has no IPv6 address: give it one or name another; the ones that can multicast over "
            "IPv6 are: eth1"},
        Bad{"NoneV6",
            {lo()},
            "",
            IpFamily::kV6,
            NetError::Kind::kNoMulticast,
            "no interface here can multicast over IPv6; bring one up with an address, or use an IPv4 group such as "
            "239.192.0.0, which works over lo too"},
        Bad{"SeveralV6",
            {lo(), card("eth0", 2), card("eth1", 3)},
            "",
            IpFamily::kV6,
            NetError::Kind::kNoMulticast,
            "several interfaces can multicast (eth0, eth1); name the one to use"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(ListInterfaces, FindsLo) {
  const auto here = must(list_interfaces());
  const auto found = std::ranges::find(here, "lo", &Interface::name);
  ASSERT_NE(found, here.end());
  EXPECT_TRUE(found->loopback);
  EXPECT_EQ(found->index, 1u);
  EXPECT_TRUE(std::ranges::is_sorted(here, {}, &Interface::index));
}

}  // namespace peerd::net::interfaces_test
